// SPDX-License-Identifier: Apache-2.0
/// The visual bound of a pose, in integers: when is what a client shows seen to be wrong. Internal to the library.
#pragma once

#include <cstdint>

#include <tactus/base/result.h>
#include <tactus/rigid/rigid_state.h>

namespace tactus {

/// In grid units, shrunk so that the bound also holds for the unrounded truth.
struct PoseThresholds {
  std::int64_t distance_squared = 0;
  std::int64_t half_angle_squared = 0;  ///< (sin(angle / 2))^2 x 2^-60 of a quaternion of length 1
  unsigned level = 0;                   ///< coarsest grid level whose rounding stays well within
};

/// Of a distance [m] and an angle [rad].   err  invalid_argument R-API-4 one of them is finer than the grid, or too large
Result<PoseThresholds> pose_thresholds(double distance, double angle, const GridExponents& grid) noexcept;

/// Of `factor` times both, as far as there are such thresholds.   pre  pose_thresholds(distance, angle) gives some; factor >= 1
PoseThresholds scaled(double distance, double angle, double factor, const GridExponents& grid) noexcept;

/// A fraction of what is permitted; the grid level stays.
PoseThresholds scaled(PoseThresholds t, double fraction) noexcept;

/// time 10 ns, no allocation
bool within(const PoseThresholds& t, const RigidPose& shown, const RigidState& truth) noexcept;

}  // namespace tactus
