// SPDX-License-Identifier: Apache-2.0
/// Motion between two poses, for recordings that hold poses only.
#pragma once

#include <cmath>

#include <tactus/base/geometry.h>
#include <tactus/trace/messages.h>

namespace tactus {

/// Mean velocity and angular velocity (world frame) from `from` to `to`, by the shorter turn.
/// in  seconds  > 0
inline Twist motion_between(const Pose& from, const Pose& to, double seconds) noexcept {
  Quat turn = to.rotation * conjugate(from.rotation);
  if (turn.w < 0) turn = {-turn.w, -turn.x, -turn.y, -turn.z};
  const Vec3 axis{turn.x, turn.y, turn.z};
  const double sine = norm(axis);
  const double angle_per_sine = sine > 0 ? 2.0 * std::atan2(sine, turn.w) / sine : 0.0;
  return {(1.0 / seconds) * (to.position - from.position), (angle_per_sine / seconds) * axis};
}

/// The turn by |turn| [rad] about its direction.
inline Quat rotation_of(const Vec3& turn) noexcept {
  const double angle = norm(turn), sine_per_angle = angle > 1e-9 ? std::sin(angle / 2) / angle : 0.5;
  return {std::cos(angle / 2), sine_per_angle * turn.x, sine_per_angle * turn.y, sine_per_angle * turn.z};
}

}  // namespace tactus
