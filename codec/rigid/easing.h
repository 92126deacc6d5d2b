// SPDX-License-Identifier: Apache-2.0
/// The path on which an object of an eased scene is shown: dead reckoning from its newest update, and what was left to go when that
/// update came, which shrinks to nothing within 2^ease ticks. spec/60-client.md section 8; for one straight line this is thesis eq. 3.6.
/// A function of updates alone, so that every client shows the same and the sender can keep its bounds on it. Integers only.
#pragma once

#include <cstdint>

#include <tactus/rigid/curve.h>
#include <tactus/rigid/rigid_predictor.h>
#include <tactus/rigid/rigid_state.h>

namespace tactus {

/// The part of an offset that an update lets stay.
PoseOffset part_kept(const PoseOffset& whole, std::uint8_t keep) noexcept;
/// What is left to go at the tick of an update: from its pose to the one that was shown, the part of it that the update lets stay.
/// time about 0.2 us
PoseOffset kept_offset(const RigidPose& shown, const RigidState& update) noexcept;

/// `pose` of dead reckoning from `update`, with what is left of the offset at `tick`.   pre  tick >= update.tick.   time about 100 ns
RigidPose eased(const RigidPose& pose, const RigidState& update, const PoseOffset& offset, std::int64_t tick) noexcept;

inline bool is_easing(const RigidState& update, std::int64_t tick) noexcept {
  return update.ease > 0 && tick - update.tick < std::int64_t{1} << update.ease;
}

/// The path of one object over its updates.
struct EasedPath {
  std::uint32_t object = 0;
  RigidState state;     ///< the newest update
  PoseOffset offset{};  ///< what was left to go at its tick

  /// pre  tick >= state.tick
  RigidPose pose(const RigidPredictor& predictor, std::int64_t tick) const noexcept {
    return eased(predictor.shown(object, state, tick), state, offset, tick);
  }
  /// Go on with an update.   time O(1), about 0.6 us where it is eased
  void follow(const RigidPredictor& predictor, const RigidState& update) noexcept;
};

}  // namespace tactus
