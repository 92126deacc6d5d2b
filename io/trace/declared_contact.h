// SPDX-License-Identifier: Apache-2.0
/// A contact for a recorded force. A recording with forces, but without contacts, has no bound of force: how far a wrong pose changes
/// a force follows from the contact alone. Whoever knows what was touched, and how stiff it is, declares it.
///
/// Model: a spring of the declared stiffness between the device and the object (thesis eq. 2.6). At each tick the recorded force f [N] on
/// the user stretches it by f / k: the touched point is x_d + f / k, tied to the object's pose of that tick. So the force of the contact
/// at the true pose is the recorded one, and at another pose it is that which the spring would have there.
///   plane   only the component along f counts, as below a face whose normal is along f     k (p - x_d) . n
///   spring  the whole vector counts: a grip, a tool that is tied to the object              k (p - x_d)
#pragma once

#include <span>
#include <string>
#include <vector>

#include <tactus/base/result.h>
#include <tactus/trace/frame.h>

namespace tactus {

enum class ForcePoint : std::uint8_t { device, origin };  ///< where the force acts: at the device, or at the object's origin

struct DeclaredContact {
  std::string user, object;
  double stiffness = 0;  ///< [N/m] > 0
  ContactKind kind = ContactKind::surface;
  ForcePoint at = ForcePoint::device;
};

/// in   force  [N] on the user, world;  device  [m] world
/// out  none without a force, else contact_force() at `pose` is `force`
Contact contact_of_force(const Pose& pose, const Vec3& device, const Vec3& force, double stiffness, ContactKind kind,
                         std::uint32_t object) noexcept;

/// Gives the frames of a trace the declared contacts.
class ContactDeclarations {
 public:
  /// err  invalid_argument R-API-5 there is no such user or rigid object, or a user is declared twice; R-API-4 a stiffness is not above 0
  static Result<ContactDeclarations> create(const TraceInfo& info, std::span<const DeclaredContact> declared);

  /// Of users without a recorded contact. The force is the server's where it is known. ForcePoint::origin puts the device there.
  /// time O(declarations), no allocation
  void apply(TraceFrame& frame) const noexcept;

 private:
  struct Declared {
    std::uint32_t user, object;
    bool is_of_server;
    double stiffness;
    ContactKind kind;
    ForcePoint at;
  };
  std::vector<Declared> declared_;
};

}  // namespace tactus
