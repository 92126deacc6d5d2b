// SPDX-License-Identifier: Apache-2.0
#include <tactus/signal/device_path.h>

#include <algorithm>

#include <tactus/rigid/rigid_predictor.h>

namespace tactus {

void DevicePath::add(std::uint64_t number, const RigidState& state) noexcept {
  packets_[packet_count_++ % kPackets] = {number, false, state};
}

void DevicePath::shift(std::int64_t from, std::int64_t offset) noexcept {
  const std::int64_t floor = device_tick(from - 1).value_or(0);
  shifts_[shift_count_++ % kShifts] = {from, offset, floor};
  ++revision_;
}

std::optional<std::int64_t> DevicePath::device_tick(std::int64_t tick) const noexcept {
  for (std::size_t back = 1; back <= std::min(shift_count_, kShifts); ++back) {
    const Shift& shift = shifts_[(shift_count_ - back) % kShifts];
    if (shift.from <= tick) return std::max(shift.floor, tick - shift.offset);
  }
  return std::nullopt;
}

std::optional<std::array<std::int32_t, 3>> DevicePath::at(std::int64_t tick) const noexcept {
  const auto device = device_tick(tick);
  if (!device) return std::nullopt;
  for (std::size_t back = 1; back <= std::min(packet_count_, kPackets); ++back) {
    const Packet& packet = packets_[(packet_count_ - back) % kPackets];
    if (packet.number != 0 && packet.state.tick <= *device)
      return RigidPredictor(scene_).pose(packet.state, *device).position;
  }
  return std::nullopt;
}

}  // namespace tactus
