// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/device_path.h>

#include <algorithm>
#include <limits>

#include <tactus/base/fixed.h>
#include <tactus/rigid/rigid_predictor.h>

namespace tactus {

std::int64_t DevicePath::add(std::uint64_t number, const RigidState& state) noexcept {
  const std::int64_t ahead = state.tick - passed_;
  if (ahead <= 0) return ahead;
  std::size_t newer = 0;
  while (newer < count_ && packet_at(newer + 1).number > number) ++newer;
  if (newer == kPackets) return 0;
  next_ = (next_ + 1) % kPackets;
  count_ = std::min(count_ + 1, kPackets);
  for (std::size_t back = 1; back <= newer; ++back) packet_at(back) = packet_at(back + 1);
  packet_at(newer + 1) = {number, true, state};
  return ahead;
}

void DevicePath::shift(std::int64_t from, std::int64_t offset) noexcept {
  if (shift_count_ > 0 && shifts_[(shift_count_ - 1) % kShifts].from >= from) return;
  const std::int64_t least = device_tick(from - 1).value_or(std::numeric_limits<std::int64_t>::min());
  shifts_[shift_count_++ % kShifts] = {from, offset, least};
  if (!begins_) begins_ = from;
  ++revision_;
}

std::optional<std::int64_t> DevicePath::device_tick(std::int64_t tick) const noexcept {
  for (std::size_t back = 1; back <= std::min(shift_count_, kShifts); ++back) {
    const Shift& shift = shifts_[(shift_count_ - back) % kShifts];
    if (shift.from <= tick) return std::max(shift.least, tick - shift.offset);
  }
  return std::nullopt;
}

std::optional<DevicePath::StateAt> DevicePath::state_at(std::int64_t tick) const noexcept {
  const auto device = device_tick(tick);
  if (!device) return std::nullopt;
  for (std::size_t back = 1; back <= count_; ++back) {
    const Packet& packet = packet_at(back);
    if (packet.takes_effect && packet.state.tick <= *device) return StateAt{packet.state, *device};
  }
  return std::nullopt;
}

std::optional<std::array<std::int32_t, 3>> DevicePath::at(std::int64_t tick) const noexcept {
  Known& known = known_[static_cast<std::size_t>(tick) % known_.size()];
  if (known.tick == tick && known.revision == revision_) return known.position;
  const auto found = state_at(tick);
  if (!found) return std::nullopt;
  const Vec3i out = RigidPredictor(*scene_).pose(found->state, found->tick).position;
  if (found->tick <= passed_) known = {tick, revision_, out};
  return out;
}

}  // namespace tactus
