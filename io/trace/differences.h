// SPDX-License-Identifier: Apache-2.0
/// Motion between two poses, for recordings that hold poses only, and poses between them.
#pragma once

#include <algorithm>
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

/// On the shorter arc from `a` to `b`, at constant speed.   pre  of unit length, or nearly
inline Quat on_arc(const Quat& a, const Quat& b, double share) noexcept {
  if (a == b || share == 0) return a;
  double cosine = a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z;
  const double sign = cosine < 0 ? -1 : 1;
  cosine = std::min(sign * cosine, 1.0);
  const double angle = std::acos(cosine), sine = std::sin(angle);
  const bool is_short = sine < 1e-9;
  const double from = is_short ? 1 - share : std::sin((1 - share) * angle) / sine;
  const double to = sign * (is_short ? share : std::sin(share * angle) / sine);
  const Quat q{from * a.w + to * b.w, from * a.x + to * b.x, from * a.y + to * b.y, from * a.z + to * b.z};
  const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  return length > 0 ? Quat{q.w / length, q.x / length, q.y / length, q.z / length} : a;
}

}  // namespace tactus
