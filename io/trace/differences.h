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

}  // namespace tactus
