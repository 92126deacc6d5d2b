// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/easing.h>

#include <algorithm>
#include <array>

#include <tactus/base/fixed.h>

namespace tactus {

PoseOffset offset_of(const RigidPose& shown, const RigidState& update) noexcept {
  constexpr std::array kSixteenths{16, 15, 12, 8};
  const int kept = kSixteenths[update.keep];
  const Turn30 turn = turn_of(multiply(shown.rotation, conjugate(update.rotation)));
  PoseOffset out{{}, turn.axis, static_cast<std::uint32_t>(round_shift(std::int64_t{turn.half} * kept, 4))};
  for (std::size_t i = 0; i < 3; ++i)
    out.position[i] = saturate32(round_shift((std::int64_t{shown.position[i]} - update.position[i]) * kept, 4));
  return out;
}

RigidPose eased(const RigidPose& pose, const RigidState& update, const PoseOffset& offset, std::int64_t tick) noexcept {
  if (!is_easing(update, tick)) return pose;
  const std::int64_t left = (std::int64_t{1} << update.ease) - (tick - update.tick);
  RigidPose out = pose;
  for (std::size_t i = 0; i < 3; ++i)
    out.position[i] = saturate32(pose.position[i] + round_shift(offset.position[i] * left, update.ease));
  const auto half = static_cast<std::uint32_t>(round_shift(offset.half * left, update.ease));
  if (half != 0) out.rotation = renormalise(multiply(axis_turn(offset.axis, half), pose.rotation));
  return out;
}

void EasedPath::follow(const RigidPredictor& predictor, const RigidState& update) noexcept {
  if (update.ease > 0) offset = offset_of(pose(predictor, std::max(update.tick, state.tick)), update);
  state = update;
}

}  // namespace tactus
