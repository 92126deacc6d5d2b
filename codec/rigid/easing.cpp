// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/easing.h>

#include <algorithm>
#include <array>

#include <tactus/base/fixed.h>

namespace tactus {

PoseOffset kept_offset(const RigidPose& shown, const RigidState& update) noexcept {
  constexpr std::array kSixteenths{16, 15, 12, 8};
  const std::int64_t kept = kSixteenths[update.keep];
  PoseOffset out = offset_between({update.position, update.rotation}, shown);
  for (std::size_t i = 0; i < 3; ++i) {
    out.position[i] = static_cast<std::int32_t>(round_shift(out.position[i] * kept, 4));
    out.rotation[i] = static_cast<std::int32_t>(round_shift(out.rotation[i] * kept, 4));
  }
  return out;
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
