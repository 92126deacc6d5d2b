// SPDX-License-Identifier: Apache-2.0
/// How fast an end may send. Internal to the library.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include <tactus/session/numbers.h>
#include <tactus/session/session_options.h>

namespace tactus {

// ==== token bucket ====
// The rate at which an end sends. spec/70-session.md section 9.

/// Fills at `rate`, holds what 50 ms bring, and may be overdrawn by one datagram.
class TokenBucket {
 public:
  static constexpr std::int64_t kHolds = 50'000;  ///< [us]

  /// in   rate  [bit/s], at most 10^12; 0: no limit
  explicit TokenBucket(std::uint64_t rate) noexcept : rate_(static_cast<std::int64_t>(rate)), level_(rate_ * kHolds) {}

  bool is_open(std::uint64_t now) noexcept {
    fill(now);
    return rate_ == 0 || level_ > 0;
  }
  void take(std::int64_t bits, std::uint64_t now) noexcept {
    fill(now);
    level_ -= rate_ == 0 ? 0 : bits * 1'000'000;
  }

 private:
  /// Whoever asks: what passes between a session's phases counts, too.
  void fill(std::uint64_t now) noexcept {
    const std::int64_t whole = rate_ * kHolds, lacks = rate_ == 0 ? 0 : (whole - level_) / rate_ + 1;
    const auto passed = static_cast<std::int64_t>(std::min(now - filled_at_, static_cast<std::uint64_t>(lacks)));
    level_ = std::min(level_ + passed * rate_, whole);
    filled_at_ = now;
  }

  std::int64_t rate_, level_;  // [bit/s], [1e-6 bit]
  std::uint64_t filled_at_ = 0;
};

// ==== congestion ====
// How far the bounds widen while the way to a client does not carry what they ask for. spec/70-session.md section 9. Internal to the
// library.

/// Looks at half a second at a time: a step wider if one tick in ten was held back, or if even the fastest datagram waited in a queue that
/// does not get shorter; a step narrower after 2 s without either, and after twice as long each time that this was too early.
class Congestion {
 public:
  /// in   most  factor, 1 to 64
  explicit Congestion(double most) noexcept;

  void begin(std::uint64_t now) noexcept;  ///< anew; the counters of time go on
  void round_trip(const RoundTrip& trip, std::int64_t sample, std::uint64_t now) noexcept;
  /// The queue on the way is so long that nothing should go but a packet each 50 ms.
  bool is_jammed() const noexcept;
  /// A tick.   in   held  nothing was sent, as the rate was used up or the way is jammed      out  true: the factor is another one
  bool tick(bool held, std::uint64_t now) noexcept;

  double widening() const noexcept;  ///< factor of all bounds: 2^(steps / 2)
  const Widening& so_far() const noexcept { return so_far_; }

 private:
  enum class Period : std::uint8_t { congested, busy, calm, unknown };
  Period judge() noexcept;
  bool step(Period period) noexcept;

  unsigned most_steps_, steps_ = 0;
  std::uint64_t since_ = 0, looked_at_ = 0;                        // [us] of the period, of the last tick
  std::uint32_t ticks_ = 0, held_ = 0;                             // of the period
  std::int64_t least_ = std::numeric_limits<std::int64_t>::max();  // [us] round trip of the period
  std::int64_t queue_ = 0;                                         // [us] of the period before
  RoundTrip trip_;
  WindowedMinimum recent_{100'000};        // of round trips [us]
  std::uint32_t calm_ = 0, patience_ = 4;  // periods: so far, before a step narrower
  bool narrowed_ = false;                  // by the last step, and nothing speaks against it so far
  Widening so_far_;
};

}  // namespace tactus
