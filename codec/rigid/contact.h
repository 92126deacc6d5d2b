// SPDX-License-Identifier: Apache-2.0
/// One user's contact with one rigid object, and the force it yields at any pose of that object.
/// Thesis eq. 2.6 (spring coupling) and section 3.2.1 (only the normal component enters the update decision).
#pragma once

#include <cstdint>

#include <tactus/base/geometry.h>

namespace tactus {

enum class ContactKind : std::uint8_t {
  none = 0,
  surface = 1,  ///< probe below a face: force along the face's normal only
  spring = 2,   ///< probe tied to a point of the object (lifting, pulling): force along the spring, whole vector
};

/// symbol  shape  unit  frame
/// object  index       into the scene's objects
/// point   3      m     object frame: a point of the touched face, or the spring's anchor
/// normal  3      1     object frame, outward, unit length; unused by `spring`
/// device  3      m     world frame: position x_d of the virtual probe
/// stiffness      N/m   k_o, > 0
struct Contact {
  ContactKind kind = ContactKind::none;
  std::uint32_t object = 0;
  Vec3 point;
  Vec3 normal{0, 0, 1};
  Vec3 device;
  double stiffness = 0;
};

/// Force on the user's hand if the touched object had this pose.
///   surface: f = k * max(0, (p - x_d) . n) * n with p, n turned into the world;  spring: f = k * (p - x_d)    thesis eq. 2.6
/// out  [N], world frame.   time O(1), about 10 ns, no allocation.
inline Vec3 contact_force(const Contact& contact, const Pose& pose) noexcept {
  if (contact.kind == ContactKind::none) return {};
  const Vec3 gap = to_world(pose, contact.point) - contact.device;
  if (contact.kind == ContactKind::spring) return contact.stiffness * gap;
  const Vec3 normal = rotate(pose.rotation, contact.normal);
  const double depth = dot(gap, normal);
  return depth > 0 ? (contact.stiffness * depth) * normal : Vec3{};
}

}  // namespace tactus
