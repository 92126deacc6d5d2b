// SPDX-License-Identifier: Apache-2.0
/// How fast an end may send. Internal to the library.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>

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
  /// From now on.
  void set_rate(std::uint64_t rate, std::uint64_t now) noexcept {
    const auto next = static_cast<std::int64_t>(rate);
    if (next == rate_) return;
    fill(now);
    level_ = rate_ == 0 ? next * kHolds : std::min(level_, next * kHolds);
    rate_ = next;
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

// ==== line pacer ====
// How fast pieces of a declaration go: as fast as the line brings them, without a long queue on it. spec/70-session.md section 6.

class LinePacer {
 public:
  /// in   least_gap  [us] from piece to piece at the rate that the user states
  explicit LinePacer(std::uint64_t least_gap) noexcept : least_gap_(std::max(least_gap, kLeastGap)) {}
  static constexpr std::uint64_t kLeastGap = 80;  ///< [us]: 100 Mbit/s

  std::uint64_t window() const noexcept;                        ///< pieces that may be in flight
  std::uint64_t gap() const noexcept;                           ///< [us] from piece to piece
  void sent(std::uint64_t number, std::uint64_t now) noexcept;  ///< a piece, in a datagram of this number
  void arrived() noexcept { ++arrived_; }                       ///< one more of them, as is known from now on

  /// What an acknowledgement that measured a round trip reports of its `newest`.
  struct Feedback {
    std::uint64_t number = 0, newest_sent = 0;  ///< of this datagram, of the last that was sent
    std::int64_t sent = 0, arrived = 0;  ///< [us] both by the own clock: when it went, and came there, later by the delay back
  };
  void feedback(const Feedback& report, const RoundTrip& trip, std::uint64_t now) noexcept;
  void timed_out() noexcept { is_blind_ = true; }  ///< no feedback for too long

 private:
  static constexpr std::uint64_t kFirstMore = 8;
  struct Mark {
    std::uint64_t number = 0, count = 0;  // pieces that had arrived
    std::int64_t sent = 0, arrived = 0;
  };
  std::int64_t excess() const noexcept;
  bool has_queue() const noexcept { return excess() > 0; }
  std::uint64_t rate_gap() const noexcept;  // [us/16] at the rate that the line has
  void begin(const Mark& to, std::uint64_t now) noexcept;
  void measure(const Mark& to, std::uint64_t now) noexcept;

  std::uint64_t least_gap_;
  std::uint64_t arrived_ = 0;
  std::uint64_t first_number_ = 0, round_ends_ = 0;  // numbers
  std::int64_t first_sent_ = 0;
  std::optional<Mark> mark_;                // where the next measurement begins
  std::int64_t least_ = 0, variation_ = 0;  // [us] of round trips
  std::int64_t queue_ = 0;                  // [us] what the fastest now take more than the least
  std::uint64_t more_ = kFirstMore;         // 1/32 of the rate
  bool is_blind_ = false;
  WindowedMinimum recent_{40'000};   // of round trips [us]
  WindowedMinimum gaps_{1'000'000};  // [us/16] from arrival to arrival
};

// ==== line rate ====
// How fast datagrams may go to a client over a link whose rate nobody has stated: no limit until a queue shows what it carries.
// spec/70-session.md section 9.

class LineRate {
 public:
  void begin(std::uint64_t now) noexcept;  ///< anew
  /// in   number  of a datagram;  bytes  headers included
  void sent(std::uint64_t number, std::uint64_t bytes, std::uint64_t now) noexcept;
  /// in   sample  [us] a round trip, of the datagram with this number
  void round_trip(const RoundTrip& trip, std::int64_t sample, std::uint64_t number, std::uint64_t now) noexcept;
  void tick(bool held, std::uint64_t now) noexcept;      ///< in   held  as Congestion::tick()
  std::uint64_t rate() const noexcept { return rate_; }  ///< [bit/s]; 0: no limit
  /// The queue of the link is so long that nothing should go but a packet each 50 ms.
  bool is_jammed() const noexcept;

 private:
  static constexpr std::size_t kNumbers = 1024;
  struct Sent {
    std::uint32_t at = 0, bytes = 0, size = 0;  // [us], of all up to it, both modulo 2^32; its own
  };
  std::int64_t queue() const noexcept { return *recent_.value() - std::max(trip_.least, longer_); }
  bool is_longer(std::int64_t queue) noexcept;
  std::int64_t limit() const noexcept { return std::max(kQueue, 2 * variation_.value().value_or(0)); }
  void measure(std::uint64_t now) noexcept;
  void slow_down(std::uint64_t now) noexcept;
  void speed_up() noexcept;

  static constexpr std::int64_t kQueue = 50'000;  // [us] that the fastest datagram of 100 ms may wait
  std::uint64_t rate_ = 0, ceiling_ = 0;          // [bit/s]: now, at which there was a queue
  std::uint64_t since_ = 0;                       // [us] of the period; later: until a change shows
  std::int64_t queue_ = 0;                        // [us] at its begin
  std::int64_t first_queue_ = 0;                  // [us] of looks that found the same,
  int slowed_ = 0;                                // and how often the rate was lowered between them
  std::int64_t longer_ = 0;                       // [us] round trip of a link whose delay has become longer
  bool held_ = false, has_news_ = false;          // in it
  RoundTrip trip_;
  std::uint32_t bytes_ = 0;                // sent
  Sent newest_, mark_;                     // that has arrived: when; at the last measurement
  WindowedMinimum recent_{100'000};        // of round trips [us]
  WindowedMinimum carried_{1'000'000};     // [-bit/s]
  WindowedMinimum variation_{10'000'000};  // [us] of round trips
  std::array<Sent, kNumbers> numbers_{};
};

// ==== congestion ====
// How far the bounds are scaled while the rate to a client does not carry what they ask for. spec/70-session.md section 9. Internal to the
// library.

/// Looks at half a second at a time: a step wider if what was held back waited for long, or many shapes were left out; a step narrower after
/// half a second without either, and after twice as long each time that this was too early.
class Congestion {
 public:
  /// in   most  factor, 1 to 64
  explicit Congestion(double most) noexcept;

  void begin(std::uint64_t now) noexcept;  ///< anew; the counters of time go on
  void answered() noexcept { answered_ = true; }
  /// A tick.   in   held  nothing was sent, as the rate was used up or the link is jammed;  shapes  there are new ones
  ///           out  true: the factor is another one
  bool tick(bool held, bool shapes, std::uint64_t now) noexcept;

  bool waits() const noexcept { return waits_; }  ///< packets wait for their turn
  double bound_scale() const noexcept;            ///< factor of all bounds: 2^(steps / 2)
  const BoundScaling& so_far() const noexcept { return so_far_; }

 private:
  enum class Period : std::uint8_t { congested, busy, calm, unknown };
  Period judge() noexcept;
  bool step(Period period) noexcept;

  unsigned most_steps_, steps_ = 0;
  std::uint64_t since_ = 0, looked_at_ = 0;                                           // [us] of the period, of the last tick
  std::uint32_t ticks_ = 0, held_ = 0, waits_begun_ = 0, shapes_ = 0, left_out_ = 0;  // of the period
  bool was_held_ = false, answered_ = false, waits_ = false;
  std::uint32_t calm_ = 0, calm_needed_ = 1;  // periods: so far, before a step narrower
  bool narrowed_ = false;                     // by the last step, and nothing speaks against it so far
  BoundScaling so_far_;
};

}  // namespace tactus
