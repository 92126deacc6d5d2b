// SPDX-License-Identifier: Apache-2.0
/// Where a client's device is at each tick of the server, as both ends of a session know it: the packets of the device that were accepted,
/// and how its ticks follow those of the server. spec/65-signal.md section 4.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include <tactus/rigid/rigid_state.h>
#include <tactus/scene/scene.h>

namespace tactus {

/// One end's knowledge. A server adds what comes and says which ticks are past; a client adds what goes and settles it by acknowledgements.
/// Threads: one at a time. No allocation after it is made; about 300 kB.
class DevicePath {
 public:
  static constexpr std::size_t kPackets = 2048, kShifts = 64;  ///< kept; older ones are forgotten

  /// in   device  device_scene()
  explicit DevicePath(SharedScene device) : scene_(std::move(device)) {}

  /// A packet of the device brought a state, perhaps a reordered one.   in  number  of it, not added before
  /// out  ticks until it takes effect; 0 or less: it comes too late for that, and is left out.   time O(newer packets)
  std::int64_t add(std::uint64_t number, const RigidState& state) noexcept;
  /// Packets below `newest` that did not arrive take no effect; those above may have arrived.   in  arrived  bool(number)
  template <class Arrived>
  void settle(std::uint64_t newest, Arrived&& arrived) noexcept {
    for (std::size_t back = 1; back <= count_; ++back) {
      Packet& packet = packet_at(back);
      if (packet.number + kSettled < newest) return;
      const bool takes_effect = packet.number > newest || arrived(packet.number);
      if (takes_effect != packet.takes_effect) ++revision_;
      packet.takes_effect = takes_effect;
    }
  }
  /// From a tick of the server on the device's tick is the server's less `offset`, but never below one before. Nothing happens if a later
  /// tick was named already.   time O(1)
  void shift(std::int64_t from, std::int64_t offset) noexcept;
  void pass(std::int64_t tick) noexcept {
    passed_ = device_tick(tick).value_or(passed_);
  }  ///< up to here nothing is added any more

  /// Tick of the server from which on it may be known; nothing: no tick mapping was signalled yet.
  std::optional<std::int64_t> begins() const noexcept { return begins_; }

  /// The state that the device has at a tick of the server, and its own tick then.
  struct StateAt {
    const RigidState& state;
    std::int64_t tick = 0;
  };
  std::optional<StateAt> state_at(
      std::int64_t tick) const noexcept;  ///< nothing: not known, or no longer.   time O(packets after it)
  /// [position grid] where the device is.   time that of state_at() and RigidPredictor::pose(); of the last 256 ticks that are past, once
  std::optional<std::array<std::int32_t, 3>> at(std::int64_t tick) const noexcept;
  std::uint64_t revision() const noexcept { return revision_; }  ///< changes when the past does
  const SharedScene& scene() const noexcept { return scene_; }

 private:
  static constexpr std::uint64_t kSettled = 128;  // numbers below the newest: nothing more is reported of them
  struct Packet {
    std::uint64_t number = 0;
    bool takes_effect = true;
    RigidState state;
  };
  struct Shift {
    std::int64_t from = 0, offset = 0, least = 0;
  };
  /// What at() has found of a tick that is past.
  struct Known {
    std::int64_t tick = -1;
    std::uint64_t revision = 0;
    std::array<std::int32_t, 3> position{};
  };
  std::optional<std::int64_t> device_tick(std::int64_t tick) const noexcept;
  Packet& packet_at(std::size_t back) noexcept { return packets_[(next_ + kPackets - back) % kPackets]; }
  const Packet& packet_at(std::size_t back) const noexcept { return packets_[(next_ + kPackets - back) % kPackets]; }

  SharedScene scene_;
  std::array<Packet, kPackets> packets_{};  // a ring, by number
  std::array<Shift, kShifts> shifts_{};     // a ring
  mutable std::array<Known, 256> known_{};  // by tick
  std::size_t next_ = 0, count_ = 0, shift_count_ = 0;
  std::int64_t passed_ = -1;  // tick of the device
  std::optional<std::int64_t> begins_;
  std::uint64_t revision_ = 0;
};

}  // namespace tactus
