// SPDX-License-Identifier: Apache-2.0
/// Where a client's device is at each tick of the server, as both ends of a session know it: the packets of the device that were accepted,
/// and how its ticks follow those of the server. spec/65-signal.md section 4.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include <tactus/rigid/rigid_state.h>
#include <tactus/scene/scene.h>

namespace tactus {

class DevicePath {
 public:
  static constexpr std::size_t kPackets = 512, kShifts = 64;  ///< kept; older ones are forgotten

  /// pre  the scene of a device, which outlives the path
  explicit DevicePath(const Scene& device) noexcept : scene_(device) {}

  /// A packet brought a state.   in  number  of its datagram.   pre  above those before
  void add(std::uint64_t number, const RigidState& state) noexcept;
  /// Only packets that `kept` names were accepted, as far as numbers are at most `newest`.   in  kept  bool(number)
  template <class Kept>
  void keep(std::uint64_t newest, Kept&& kept) noexcept {
    for (std::size_t i = 0; i < packets_.size(); ++i) {
      Packet& packet = packets_[i];
      if (packet.number == 0 || packet.number > newest || packet.is_known) continue;
      packet.is_known = true;
      if (kept(packet.number)) continue;
      packet.number = 0;
      ++revision_;
    }
  }
  /// From a tick of the server on the device's tick is the server's less `offset`, but never below one before.
  /// pre  `from` is not below those before
  void shift(std::int64_t from, std::int64_t offset) noexcept;

  /// [position grid] at a tick of the server; nothing: not known, or no longer.   time O(1) for the newest ticks
  std::optional<std::array<std::int32_t, 3>> at(std::int64_t tick) const noexcept;
  std::optional<std::int64_t> device_tick(std::int64_t tick) const noexcept;  ///< the device's tick at a tick of the server
  std::uint64_t revision() const noexcept { return revision_; }  ///< changes when the past does

 private:
  struct Packet {
    std::uint64_t number = 0;  // 0: none
    bool is_known = false;     // whether it was accepted
    RigidState state;
  };
  struct Shift {
    std::int64_t from = 0, offset = 0, floor = 0;
  };

  const Scene& scene_;
  std::array<Packet, kPackets> packets_{};  // a ring
  std::array<Shift, kShifts> shifts_{};     // a ring
  std::size_t packet_count_ = 0, shift_count_ = 0;
  std::uint64_t revision_ = 0;
};

}  // namespace tactus
