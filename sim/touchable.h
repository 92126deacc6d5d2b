// SPDX-License-Identifier: Apache-2.0
/// Objects that probes can touch: rigid, one-dimensional and deformable behind one interface, at the server and at a client.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include <tactus/base/diagnostic.h>
#include <tactus/base/geometry.h>
#include <tactus/rigid/trigger.h>
#include <tactus/trace/frame.h>

namespace tactus::sim {

/// Contact and force of one probe.
struct Touch {
  Contact contact;                          ///< with a rigid or one-dimensional object; contact.device is always set
  std::optional<SurfaceContact> surface{};  ///< with a deformable object
  Vec3 proxy;                               ///< [m] x_p of `contact`, world frame; the probe itself when free
  Vec3 force;                               ///< [N] on the hand, world frame
};

/// The fraction of a force that a device renders whose largest force is `limit` [N].
inline double rendered_fraction(const Vec3& force, double limit) noexcept {
  const double magnitude = norm(force);
  return magnitude > limit ? limit / magnitude : 1;
}

/// What a client computed in a tick beside decoding and rendering.
struct ClientCosts {
  struct Cost {
    std::int64_t wall = 0, cpu = 0;  ///< [ns]
  };
  Cost shapes{};        ///< of deformable objects, elastic bodies that it steps itself included
  Cost poses{};         ///< of rigid objects, predicted, those that its device drives included
  Cost compensation{};  ///< of the delay
};

/// All objects of one kind at one end, with a proxy for the probe of every user.
class Touchable {
 public:
  /// Move a user's probe. It touches one object of a kind at a time: the first one met, until it lets go.
  /// in   held  an object of another kind holds the probe, which then touches no rigid or one-dimensional object here
  /// time O(objects); no allocation
  virtual Touch touch(std::size_t user, const DeviceSample& device, bool held) noexcept = 0;
  virtual ~Touchable() = default;
};

/// The objects at the server, which computes them.
class Simulated : public Touchable {
 public:
  /// Write their part of the frame: the state of this tick, before its forces act.   no allocation
  virtual void observe(TraceFrame& frame) noexcept = 0;
  /// Apply `fraction` of the reaction to the user's last force to the object touched.   no allocation
  virtual void push(std::size_t user, double fraction) noexcept = 0;
  /// Advance by one tick.
  /// err  the broken rule, with the tick as the step and the object as the element: its index in the frame's objects or meshes
  virtual tl::expected<void, Diagnostic> step() = 0;
};

}  // namespace tactus::sim
