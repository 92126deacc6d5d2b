// SPDX-License-Identifier: Apache-2.0
/// Which packets of a part a receiver may decode, by number, tick and clock. spec/25-packet.md sections 4 and 5. Internal to the library.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

namespace tactus {

/// Ticks without an accepted packet after which a receiver with a clock forgets its states: before 16-bit numbers can come round.
constexpr std::int64_t forget_ticks(std::uint32_t tick_rate) noexcept {
  return std::max<std::int64_t>(1 << 14, 16 * std::int64_t{tick_rate});
}

/// Sequence numbers counted on without wrapping: `number` modulo 2^16 is what the packet says.
class PacketOrder {
 public:
  explicit PacketOrder(std::uint32_t tick_rate) noexcept : forget_(forget_ticks(tick_rate)) {}

  /// A packet arrives at a tick of the receiver's clock.
  void arrive(std::optional<std::int64_t> now) noexcept {
    now_ = now;
    if (now_ && arrival_ && *now_ - *arrival_ > forget_) forget();
  }
  /// One of the newest numbers: a repeated packet, or one that others overtook (R-PKT-5).
  bool is_late(std::uint16_t sequence) const noexcept { return begun_ && static_cast<std::uint16_t>(newest_ - sequence) < kLate; }
  std::uint64_t number_of(std::uint16_t sequence) const noexcept {
    return newest_ + 1 + static_cast<std::uint16_t>(sequence - newest_ - 1);
  }
  /// Neither late nor ahead as far as one sender's packets can be: another's, or the receiver was away for long (R-PKT-7).
  bool is_foreign(std::uint64_t number) const noexcept { return begun_ && number - newest_ > kAhead; }
  /// From now on only a key packet is accepted, whatever its number and tick.
  void forget() noexcept { begun_ = false; }
  /// Whether the state after a packet is one to build on.
  bool holds(std::uint64_t number) const noexcept { return begun_ && number >= first_; }
  /// Ticks of one sender do not fall; a key packet of an earlier tick begins anew.
  bool fits(bool key, std::int64_t tick) const noexcept { return key || tick >= tick_; }
  void accept(std::uint64_t number, bool key, std::int64_t tick) noexcept {
    if (key && (!begun_ || is_foreign(number) || tick < tick_)) first_ = number;
    newest_ = number;
    tick_ = tick;
    begun_ = true;
    arrival_ = now_;
  }

 private:
  static constexpr std::uint16_t kLate = 128;
  static constexpr std::uint64_t kAhead = 32767;

  std::int64_t forget_;
  std::optional<std::int64_t> now_, arrival_;   // of the packet at hand, of the newest accepted
  bool begun_ = false;                          // a packet was accepted, and it is not forgotten
  std::uint64_t newest_ = 1 << 16, first_ = 0;  // accepted; states before `first_` are forgotten
  std::int64_t tick_ = 0;                       // of the newest
};

}  // namespace tactus
