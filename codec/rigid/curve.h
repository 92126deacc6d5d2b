// SPDX-License-Identifier: Apache-2.0
/// How a rigid object passes from one path to the next: curves between states, and error smoothing. Integers.
#pragma once

#include <array>
#include <cstdint>

#include <tactus/rigid/rigid_predictor.h>
#include <tactus/rigid/rigid_state.h>
#include <tactus/scene/scene.h>

namespace tactus {

// ==== curve ====
// Curves that begin at one moving pose and end at another: an offset is added to dead reckoning and fades. spec/60-client.md section 2.
// Integers only.

/// Difference of two poses, or what a difference of velocities makes of it in a while.
struct PoseOffset {
  std::array<std::int32_t, 3> position{};  ///< grid units
  std::array<std::int32_t, 3> rotation{};  ///< half the angle times the axis, 2^32 to the full circle
  friend bool operator==(const PoseOffset&, const PoseOffset&) = default;
};

/// Weights of two offsets, x 2^-30: of `error` in position and in rotation, of `change` in both.
struct CurveWeights {
  std::int64_t position = 0, rotation = 0, change = 0;
};

/// A cubic of the fraction u of the path: from 0 to 1 and level at both ends; its companion is 0 at both and meets the end with slope 1.
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

// ==== error smoothing ====
// The path on which an object of a smoothed scene is shown: dead reckoning from its newest update, and what was left to go when that
// update came, which shrinks to nothing within 2^smoothing_exp ticks. spec/60-client.md section 8; for one straight line this is thesis eq. 3.6.
// A function of updates alone, so that every client shows the same and the sender can keep its bounds on it. Integers only.

/// The part of an offset that an update lets stay.
PoseOffset part_kept(const PoseOffset& whole, std::uint8_t retained) noexcept;
/// What is left to go at the tick of an update: from its pose to the one that was shown, the part of it that the update lets stay.
/// time about 0.2 us
PoseOffset kept_offset(const RigidPose& shown, const RigidState& update) noexcept;

/// `pose` of dead reckoning from `update`, with what is left of the offset at `tick`.   pre  tick >= update.tick.   time about 100 ns
RigidPose smoothed(const RigidPose& pose, const RigidState& update, const PoseOffset& offset, std::int64_t tick) noexcept;

inline bool is_smoothing(const RigidState& update, std::int64_t tick) noexcept {
  return update.smoothing_exp > 0 && tick - update.tick < std::int64_t{1} << update.smoothing_exp;
}

/// The path of one object over its updates.
struct SmoothedPath {
  std::uint32_t object = 0;
  RigidState state;     ///< the newest update
  PoseOffset offset{};  ///< what was left to go at its tick

  /// pre  tick >= state.tick
  RigidPose pose(const RigidPredictor& predictor, std::int64_t tick) const noexcept {
    return smoothed(predictor.shown(object, state, tick), state, offset, tick);
  }
  /// Go on with an update.   time O(1), about 0.6 us where it is smoothed
  void follow(const RigidPredictor& predictor, const RigidState& update) noexcept;
};

}  // namespace tactus
