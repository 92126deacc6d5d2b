// SPDX-License-Identifier: Apache-2.0
/// Contacts, and when a rigid object is worth sending.
#pragma once

#include <cstdint>

#include <tactus/base/geometry.h>
#include <tactus/scene/scene_objects.h>

namespace tactus {

// ==== contact ====
// One user's contact with one rigid object, and the force it yields at any pose of that object.
// Thesis eq. 2.6 (spring coupling) and section 3.2.1 (only the normal component enters the update decision).

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

// ==== trigger ====
// When is an update worth sending? Heartbeat, visual and haptic dead reckoning (thesis 3.2.1, figure 3.1). Informative: an
// encoder's choice, never needed to decode.

/// Permitted force error at true force f: p F with F = max(|f|, force_floor) [N], p that of the rule at F.
double force_budget(const RigidTriggers& triggers, double force) noexcept;

/// Force error of `estimate` over the error that the haptic rule permits around `truth`: <= 1 inside, > 1 outside.
/// Returns 0 for `fixed` and `off`.    time O(1), no allocation.
double haptic_ratio(const RigidTriggers& triggers, const Vec3& truth, const Vec3& estimate) noexcept;

/// Weber fraction of force magnitude, measured in human subjects: 10 % from 2.5 N up, 14 % at 1 N, 17 % at 0.5 N, 22 % at 0.3 N
/// and below, linear between.   spec 20-scene 6; thesis table 2.1
double weber_fraction_at(double force) noexcept;

/// alpha_max = arcsin p: the largest angle between two forces inside an isotropic deadzone [rad]; half a circle from p = 1 on, where
/// no direction is excluded.   thesis eq. 3.3
double isotropic_angle(double weber_fraction) noexcept;

}  // namespace tactus
