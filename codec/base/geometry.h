// SPDX-License-Identifier: Apache-2.0
/// Vectors, rotations and poses in SI units, and what a haptic device reports in them.
#pragma once

#include <bit>
#include <cstdint>

namespace tactus {

// ==== geometry ====
// Vectors, unit quaternions and poses in SI units, for the API side of the codec (never inside the prediction loop).
// Right-handed world frame, column vectors, Hamilton quaternions (w, x, y, z) that turn object axes into world axes.

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
double norm(const Vec3& a) noexcept;
/// From the bits: std::isfinite() is always true where a program is compiled with -ffast-math.
constexpr bool is_finite(double v) noexcept { return (~std::bit_cast<std::uint64_t>(v) & 0x7FF0'0000'0000'0000) != 0; }
constexpr bool is_finite(const Vec3& a) noexcept { return is_finite(a.x) && is_finite(a.y) && is_finite(a.z); }

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
constexpr bool is_finite(const Quat& q) noexcept { return is_finite(q.w) && is_finite(q.x) && is_finite(q.y) && is_finite(q.z); }
/// Angle in [0, pi] rad of the rotation that takes a to b.
double angle_between(const Quat& a, const Quat& b) noexcept;

struct Pose {
  Vec3 position;  ///< [m] origin of the object in the world frame
  Quat rotation;  ///< object to world
};

/// p_world = x + R p_object
constexpr Vec3 to_world(const Pose& pose, const Vec3& p) noexcept { return pose.position + rotate(pose.rotation, p); }
constexpr Vec3 to_object(const Pose& pose, const Vec3& p) noexcept { return rotate(conjugate(pose.rotation), p - pose.position); }

// ==== device sample ====
// One sample of a force-feedback device. Virtual hands, recordings and real devices deliver it. Quantities that a device does
// not sense keep their defaults.

/// symbol       shape  unit  frame
/// position     3      m     world: x_d
/// orientation  4      1     world: of the handle, unit length
/// velocity     3      m/s   world: as the device measures it
/// buttons             1     bit i is set while button i is down
/// time                ns    on the device's own clock, from any origin, not negative
struct DeviceSample {
  Vec3 position;
  Quat orientation{};
  Vec3 velocity{};
  std::uint32_t buttons = 0;
  std::int64_t time = 0;

  bool is_down(unsigned button) const noexcept { return (buttons >> button & 1u) != 0; }
};

/// Which quantities a device senses besides its position.
struct DeviceSenses {
  bool orientation = false;
  bool velocity = false;
  bool buttons = false;
  bool time = false;
  friend bool operator==(const DeviceSenses&, const DeviceSenses&) = default;
};

/// Finite, not before the clock's origin, and the orientation of unit length within what single precision and printed digits lose.
inline bool is_valid(const DeviceSample& sample) noexcept {
  const auto& [w, x, y, z] = sample.orientation;
  const double off_unit = w * w + x * x + y * y + z * z - 1;
  return is_finite(sample.position) && is_finite(sample.velocity) && off_unit >= -1e-3 && off_unit <= 1e-3 && sample.time >= 0;
}

}  // namespace tactus
