// SPDX-License-Identifier: Apache-2.0
/// Vectors, unit quaternions and poses in SI units, for the API side of the codec (never inside the prediction loop).
/// Right-handed world frame, column vectors, Hamilton quaternions (w, x, y, z) that turn object axes into world axes.
#pragma once

#include <cmath>

namespace tactus {

struct Vec3 {
  double x = 0, y = 0, z = 0;
  friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
};

constexpr Vec3 operator+(const Vec3& a, const Vec3& b) noexcept { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
constexpr Vec3 operator-(const Vec3& a, const Vec3& b) noexcept { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
constexpr Vec3 operator-(const Vec3& a) noexcept { return {-a.x, -a.y, -a.z}; }
constexpr Vec3 operator*(double s, const Vec3& a) noexcept { return {s * a.x, s * a.y, s * a.z}; }
constexpr double dot(const Vec3& a, const Vec3& b) noexcept { return a.x * b.x + a.y * b.y + a.z * b.z; }
constexpr Vec3 cross(const Vec3& a, const Vec3& b) noexcept {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double norm(const Vec3& a) noexcept { return std::sqrt(dot(a, a)); }
inline bool is_finite(const Vec3& a) noexcept { return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z); }

struct Quat {
  double w = 1, x = 0, y = 0, z = 0;
  friend constexpr bool operator==(const Quat&, const Quat&) = default;
};

constexpr Quat conjugate(const Quat& q) noexcept { return {q.w, -q.x, -q.y, -q.z}; }
constexpr Quat operator*(const Quat& a, const Quat& b) noexcept {
  return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
          a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}
/// R(q) v for a unit quaternion.
constexpr Vec3 rotate(const Quat& q, const Vec3& v) noexcept {
  const Vec3 u{q.x, q.y, q.z};
  const Vec3 t = 2.0 * cross(u, v);
  return v + q.w * t + cross(u, t);
}
inline bool is_finite(const Quat& q) noexcept {
  return std::isfinite(q.w) && std::isfinite(q.x) && std::isfinite(q.y) && std::isfinite(q.z);
}
/// Angle in [0, pi] rad of the rotation that takes a to b.
inline double angle_between(const Quat& a, const Quat& b) noexcept {
  const Quat d = b * conjugate(a);
  return 2.0 * std::atan2(std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z), std::abs(d.w));
}

struct Pose {
  Vec3 position;  ///< [m] origin of the object in the world frame
  Quat rotation;  ///< object to world
};

/// p_world = x + R p_object
constexpr Vec3 to_world(const Pose& pose, const Vec3& p) noexcept { return pose.position + rotate(pose.rotation, p); }
constexpr Vec3 to_object(const Pose& pose, const Vec3& p) noexcept { return rotate(conjugate(pose.rotation), p - pose.position); }

}  // namespace tactus
