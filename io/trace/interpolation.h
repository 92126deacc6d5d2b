// SPDX-License-Identifier: Apache-2.0
/// Values between two samples: lines for vectors, the shorter arc for rotations. Exact at both samples. Internal to the library.
#pragma once

#include <algorithm>
#include <cmath>

#include <tactus/base/geometry.h>
#include <tactus/rigid/rigid_state.h>

namespace tactus {

/// in  fraction  0 at `a`, 1 at `b`
inline Vec3 mixed(const Vec3& a, const Vec3& b, double fraction) noexcept {
  return a == b || fraction == 0 ? a : a + fraction * (b - a);
}

/// The shorter arc, at constant speed.   pre  of unit length, or nearly
inline Quat mixed(const Quat& a, const Quat& b, double fraction) noexcept {
  if (a == b || fraction == 0) return a;
  double cosine = a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z;
  const double sign = cosine < 0 ? -1 : 1;
  cosine = std::min(sign * cosine, 1.0);
  const double angle = std::acos(cosine), sine = std::sin(angle);
  const bool is_short = sine < 1e-9;
  const double from = is_short ? 1 - fraction : std::sin((1 - fraction) * angle) / sine;
  const double to = sign * (is_short ? fraction : std::sin(fraction * angle) / sine);
  const Quat q{from * a.w + to * b.w, from * a.x + to * b.x, from * a.y + to * b.y, from * a.z + to * b.z};
  const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  return length > 0 ? Quat{q.w / length, q.x / length, q.y / length, q.z / length} : a;
}

inline Pose mixed(const Pose& a, const Pose& b, double fraction) noexcept {
  return {mixed(a.position, b.position, fraction), mixed(a.rotation, b.rotation, fraction)};
}

inline RigidSample mixed(const RigidSample& a, const RigidSample& b, double fraction) noexcept {
  return {mixed(a.pose, b.pose, fraction), mixed(a.velocity, b.velocity, fraction),
          mixed(a.angular_velocity, b.angular_velocity, fraction)};
}

}  // namespace tactus
