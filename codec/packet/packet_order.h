// SPDX-License-Identifier: Apache-2.0
/// Decides which packets a receiver may decode, by number, tick and clock. spec/25-packet.md sections 4 and 5. Internal to the
/// library.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

namespace tactus {

/// Ticks without an accepted packet after which a receiver with a clock drops its states, before 16-bit numbers can wrap.
constexpr std::int64_t forget_ticks(std::uint32_t tick_rate) noexcept {
  return std::max<std::int64_t>(1 << 14, 16 * std::int64_t{tick_rate});
}

/// Unwrapped sequence numbers: a packet carries `number` modulo 2^16.
class PacketOrder {
 public:
  explicit PacketOrder(std::uint32_t tick_rate) noexcept : forget_(forget_ticks(tick_rate)) {}

  /// A packet arrives at a tick of the receiver's clock.
  void arrive(std::optional<std::int64_t> now) noexcept {
    now_ = now;
    if (now_ && arrival_ && *now_ - *arrival_ > forget_) forget();
  }
  /// True for one of the newest numbers: a repeated packet, or one overtaken by others (R-PKT-5).
  bool is_late(std::uint16_t sequence) const noexcept { return begun_ && static_cast<std::uint16_t>(newest_ - sequence) < kLate; }
  std::uint64_t number_of(std::uint16_t sequence) const noexcept {
    return newest_ + 1 + static_cast<std::uint16_t>(sequence - newest_ - 1);
  }
  /// True for a number that one sender cannot reach: another sender, or a long outage at the receiver (R-PKT-7).
  bool is_foreign(std::uint64_t number) const noexcept { return begun_ && number - newest_ > kAhead; }
  /// Drop all states. The next packet must be a key packet; its number and tick are free.
  void forget() noexcept { begun_ = false; }
  /// Whether the state after a packet may serve as a baseline.
  bool holds(std::uint64_t number) const noexcept { return begun_ && number >= first_; }
  /// Ticks of one sender never decrease. A key packet with an earlier tick starts a new sequence.
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
  std::optional<std::int64_t> now_, arrival_;   // of the current packet, of the newest accepted
  bool begun_ = false;                          // a packet was accepted since the last forget()
  std::uint64_t newest_ = 1 << 16, first_ = 0;  // accepted; states before `first_` are forgotten
  std::int64_t tick_ = 0;                       // of the newest
};

}  // namespace tactus
