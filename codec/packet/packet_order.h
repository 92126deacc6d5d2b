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

  /// True if the receiver's clock says that numbers may have wrapped since the newest packet: states kept are ambiguous.
  bool outlasts(std::optional<std::int64_t> now) const noexcept { return now && arrival_ && *now - *arrival_ > forget_; }
  /// in  keeps  the receiver keeps a state
  std::uint64_t number_of(std::uint16_t sequence, bool keeps) const noexcept {
    const auto behind = static_cast<std::uint16_t>(newest_ - sequence);
    if (keeps && behind < kBehind) return newest_ - behind;
    return newest_ + 1 + static_cast<std::uint16_t>(sequence - newest_ - 1);
  }
  /// The packets of a session come with their numbers, which count from any value above 0.
  /// in   number  of one that comes while no state is kept: none is overtaken yet, whatever was refused before
  void begin(std::uint64_t number) noexcept {
    numbered_ = true;
    newest_ = number - 1;
  }
  bool is_numbered() const noexcept { return numbered_; }
  /// True for a repeated packet, and for one that others sent after it came before.
  bool is_overtaken(std::uint64_t number) const noexcept { return number <= newest_; }
  /// True for a number that one sender cannot reach: another sender, or a long outage at the receiver (R-PKT-7).
  bool is_foreign(std::uint64_t number) const noexcept { return !numbered_ && number > newest_ + kAhead; }
  /// Ticks of one sender never decrease. A key packet with an earlier tick starts a new sequence.
  bool fits(std::uint64_t number, bool key, std::int64_t tick) const noexcept {
    return is_overtaken(number) ? tick <= tick_ : key || tick >= tick_;
  }
  /// True for a key packet after which no state before it may serve as a baseline.   pre  fits()
  bool restarts(std::uint64_t number, bool key, std::int64_t tick) const noexcept {
    return key && !is_overtaken(number) && (is_foreign(number) || tick < tick_);
  }
  void accept(std::uint64_t number, std::int64_t tick, std::optional<std::int64_t> now) noexcept {
    if (is_overtaken(number)) return;
    newest_ = number;
    tick_ = tick;
    arrival_ = now;
  }

 private:
  static constexpr std::uint16_t kBehind = 128;
  static constexpr std::uint64_t kAhead = 32767;

  std::int64_t forget_;
  std::optional<std::int64_t> arrival_;  // of the newest accepted
  std::uint64_t newest_ = 1 << 16;       // highest number accepted; numbers stay above 0
  std::int64_t tick_ = 0;                // of the newest
  bool numbered_ = false;                // by a session
};

}  // namespace tactus
