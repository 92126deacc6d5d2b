// SPDX-License-Identifier: Apache-2.0
/// Curves that begin at one moving pose and end at another: an offset is added to dead reckoning and fades. spec/60-client.md section 3.
/// Integers only.
#pragma once

#include <array>
#include <cstdint>

#include <tactus/rigid/rigid_predictor.h>
#include <tactus/scene/scene.h>

namespace tactus {

/// Difference of two poses, or what a difference of velocities makes of it in a while.
struct PoseOffset {
  std::array<std::int32_t, 3> position{};  ///< grid units
  std::array<std::int32_t, 3> rotation{};  ///< half the angle times the axis, 2^32 to the full circle
};

/// Shares of two offsets, x 2^-30: of `error` in position and in rotation, of `change` in both.
struct CurveWeights {
  std::int64_t position = 0, rotation = 0, change = 0;
};

/// A cubic of the share u of the way: from 0 to 1 and level at both ends; its companion is 0 at both and meets the end with slope 1.
///   error = 3 u^2 - 2 u^3,  change = u^3 - u^2
struct Cubic {
  std::int64_t error, change;  ///< x 2^-30
};
Cubic cubic(std::int64_t u) noexcept;  ///< in  u  x 2^-30, 0..2^30

/// The offset that leads from one pose to the other, the short way round.   time about 0.3 us
PoseOffset offset_between(const RigidPose& from, const RigidPose& to) noexcept;

/// What the velocities `after` move and turn beyond those of `before` in `ticks`.   pre  ticks < 2^24
PoseOffset change_between(const Scene& scene, const RigidMotion& before, const RigidMotion& after, std::int64_t ticks) noexcept;

/// The pose, moved and turned by both offsets, weighted.   time about 50 ns
RigidPose displaced(const RigidPose& pose, const PoseOffset& error, const PoseOffset& change,
                    const CurveWeights& weights) noexcept;

}  // namespace tactus
