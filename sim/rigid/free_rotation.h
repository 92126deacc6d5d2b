// SPDX-License-Identifier: Apache-2.0
/// Rotation of a rigid body on which nothing acts. Internal to rigid_world.cpp.
///
/// Euler's equations with the implicit midpoint rule, and the attitude with the Cayley transform of the same midpoint velocity:
///   y_m = y + h/2 (y_m x w),  w = I^-1 y_m,  R' = R cay(h w)       y = R^T L: angular momentum in the object's frame
/// Each such step keeps the angular momentum L in the world and the energy up to rounding. Five of them, with Suzuki's weights, are of
/// fourth order. Only + - * / and sqrt: the same bits everywhere.
#pragma once

#include <tactus/base/geometry.h>

namespace tactus::sim {

/// A symmetric matrix.
struct Rows {
  Vec3 x, y, z;
  Vec3 operator*(const Vec3& v) const noexcept { return {dot(x, v), dot(y, v), dot(z, v)}; }
};

struct Inertia {
  Rows moments;  // [kg m^2] in the object's frame
  Rows inverse;
  bool is_spherical = false;  // all moments are equal: the body keeps its angular velocity
};

struct Turning {
  Quat rotation;
  Vec3 angular_velocity;  // [rad/s] world frame
};

/// Turn a body for some time.   pre  |w| seconds below 1e3
/// time O(1 + 10 |w| seconds), about 0.5 us for up to 0.1 rad; no allocation
Turning turn_freely(const Turning& now, const Inertia& inertia, double seconds) noexcept;

}  // namespace tactus::sim
