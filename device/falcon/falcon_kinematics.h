// SPDX-License-Identifier: Apache-2.0
/// The Falcon's mechanism: three arms, each turned by a motor and joined to the handle by a parallelogram, so that the handle only shifts
/// (R. E. Stamper, "A Three Degree of Freedom Parallel Manipulator with Only Translational Degrees of Freedom", 1997). The lengths are
/// those that libnifalcon published.
///
/// Native frame: x to the user's right, y up, z towards the user, the origin in the plane of the motors. Arm i turns in a plane of its own,
/// spanned by u_i, which points outwards, and z; v_i is normal to it. The handle at p is at (U, V, W) from the arm's joint, and
///
///   (U - a cos t)^2 + (W - a sin t)^2 = (2 d + sqrt(b^2 - V^2))^2        a: arm, b: parallelogram, d: joints at its ends, t: the arm's angle
#pragma once

#include <array>
#include <cstdint>

#include <tactus/base/geometry.h>
#include <tactus/base/result.h>

namespace tactus::device::falcon {

using Triple = std::array<double, 3>;  ///< one per arm

inline constexpr double kMiddle = 0.115;      ///< [m] native z of the middle of the workspace
inline constexpr double kHalfWidth = 0.040;   ///< [m] the whole cube around the middle can be reached
inline constexpr double kNominalForce = 3.7;  ///< [N] in every direction, all over that cube, within kMotorLimit
inline constexpr double kPeakForce = 6.5;     ///< [N] in every direction, in the middle
inline constexpr int kMotorLimit = 4096;

/// A pose that the mechanism can take, away from singular ones.
struct Pose {
  Vec3 position;                   ///< [m] native
  Triple angles{};                 ///< [rad] from u_i towards z
  std::array<Vec3, 3> jacobian{};  ///< [rad/m] row i: how angle i changes with the position
};

/// Inverse kinematics.
/// err  invalid R-DEV-6 not finite, out of reach, or singular: an arm and its parallelogram in line, a parallelogram nearly across its
///      arm's plane, or a direction in which no arm turns
/// time about 0.2 us
Result<Pose> pose_at(const Vec3& position) noexcept;

/// Forward kinematics by Newton's method from the middle of the workspace, at most kMostSteps; arms closed to 1e-10 m.
/// err  as pose_at()
/// time about 0.8 us
Result<Pose> pose_with(const Triple& angles) noexcept;
inline constexpr int kMostSteps = 20;

/// Torques [N m] of the motors that exert a force [N] on the hand: virtual work, torque . d(angles) = force . d(position).
Triple torques(const Pose& pose, const Vec3& force) noexcept;

/// [rad] 320 slots, four counts each, per turn of a shaft of 14.25 mm that winds on a drum of 110 mm; 35 degrees at count 0.
double angle_of(double count) noexcept;
double count_of(double angle) noexcept;

/// Motor values for torques [N m], -10000 per N m. The largest is at most kMotorLimit: all are scaled alike, so that the force keeps its
/// direction.   pre  finite
std::array<std::int16_t, 3> motors_of(const Triple& torques) noexcept;
Triple torques_of(const std::array<std::int16_t, 3>& motors) noexcept;

/// Device frame (device.h): x_d = x, y_d = kMiddle - z, z_d = y.
constexpr Vec3 from_native(const Vec3& position) noexcept { return {position.x, kMiddle - position.z, position.y}; }
constexpr Vec3 to_native(const Vec3& position) noexcept { return {position.x, position.z, kMiddle - position.y}; }
constexpr Vec3 force_to_native(const Vec3& force) noexcept { return {force.x, force.z, -force.y}; }

}  // namespace tactus::device::falcon
