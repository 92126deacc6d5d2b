// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/easing.h>

#include <algorithm>
#include <array>

#include <tactus/base/fixed.h>

namespace tactus {

PoseOffset part_kept(const PoseOffset& whole, std::uint8_t keep) noexcept {
  constexpr std::array kSixteenths{16, 15, 12, 8};
  const std::int64_t kept = kSixteenths[keep];
  PoseOffset out;
  for (std::size_t i = 0; i < 3; ++i) {
    out.position[i] = static_cast<std::int32_t>(round_shift(whole.position[i] * kept, 4));
    out.rotation[i] = static_cast<std::int32_t>(round_shift(whole.rotation[i] * kept, 4));
  }
  return out;
}

PoseOffset kept_offset(const RigidPose& shown, const RigidState& update) noexcept {
  return part_kept(offset_between({update.position, update.rotation}, shown), update.keep);
}

RigidPose eased(const RigidPose& pose, const RigidState& update, const PoseOffset& offset, std::int64_t tick) noexcept {
  if (!is_easing(update, tick)) return pose;
  const std::int64_t left = ((std::int64_t{1} << update.ease) - (tick - update.tick)) << (30 - update.ease);
  return displaced(pose, offset, {}, {left, left, 0});
}

void EasedPath::follow(const RigidPredictor& predictor, const RigidState& update) noexcept {
  if (update.ease > 0) offset = kept_offset(pose(predictor, std::max(update.tick, state.tick)), update);
  state = update;
}

}  // namespace tactus
