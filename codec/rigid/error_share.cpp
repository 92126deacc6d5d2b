// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/error_share.h>

#include <algorithm>
#include <cmath>

namespace tactus {

ErrorShare::ErrorShare(std::uint32_t object, const Pose& truth, std::span<const Contact> contacts, const RigidTriggers& triggers,
                       double sinking) noexcept
    : per_metre_(1 / triggers.visual_position), per_radian_(1 / triggers.visual_rotation), sinking_(sinking) {
  if (triggers.haptic == HapticRule::off) return;
  for (const Contact& contact : contacts) {
    if (contact.kind == ContactKind::none || contact.object != object) continue;
    if (triggers.haptic == HapticRule::fixed) {
      per_metre_ = std::max(per_metre_, 1 / triggers.fixed_position);
      per_radian_ = std::max(per_radian_, 1 / triggers.fixed_rotation);
      return;
    }
    if (count_ == kMostContacts) return;
    const bool is_spring = contact.kind == ContactKind::spring;
    const double force = norm(contact_force(contact, truth)), budget = force_budget(triggers, force);
    const bool is_cone = triggers.haptic == HapticRule::cone;
    touches_[count_++] = {
        rotate(truth.rotation, contact.point),   is_spring ? Vec3{} : rotate(truth.rotation, contact.normal),
        is_cone ? 0 : force / contact.stiffness, contact.stiffness / budget,
        force_budget(triggers, 0) / budget,      is_cone && force >= triggers.force_floor ? 1 / triggers.cone_angle : 0};
  }
}

double ErrorShare::operator()(const Vec3& moved, const Vec3& turned, double later) const noexcept {
  double out = std::max(per_metre_ * norm(moved), per_radian_ * norm(turned));
  for (std::size_t i = 0; i < count_; ++i) {
    const Touch& touch = touches_[i];
    const Vec3 at_point = moved + cross(turned, touch.lever);
    const Vec3 felt = touch.normal == Vec3{}
                          ? at_point
                          : dot(at_point, touch.normal) * touch.normal + touch.depth * cross(turned, touch.normal);
    const double left = std::max(touch.least, 1 - sinking_ * later);
    out = std::max({out, touch.per_metre / left * norm(felt), touch.per_radian * norm(turned)});
  }
  return out;
}

}  // namespace tactus
