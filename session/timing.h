// SPDX-License-Identifier: Apache-2.0
/// What is shown and sent when: clocks of both ends, playout, the device's tick mapping, forces that fade. Integers. Internal to the library.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include <tactus/session/datagram.h>
#include <tactus/session/numbers.h>
#include <tactus/session/session_options.h>

namespace tactus {

// ==== clock offset ====

inline constexpr std::uint64_t kDelayWindow = 10'000'000;  ///< [us] in which the least delay of a direction is looked for
/// [us] What no delay gets shorter or longer by from one datagram to the next unless a clock was stopped: a machine slept, a program stood.
inline constexpr std::int64_t kClockStep = 30'000;

/// The other end's clock less our own [us], from the shortest delay there and the shortest delay back of the last 10 s: these count as equally
/// long. spec/70-session.md section 7. Internal to the library.
class ClockOffset {
 public:
  /// in   time  [us] of the other end, when it sent what came at `now` [us];  round_trip  [us], without what the other end waited
  void add(std::uint64_t time, std::int64_t round_trip, std::uint64_t now) noexcept {
    const auto back = static_cast<std::int64_t>(now) - static_cast<std::int64_t>(time), there = round_trip - back;
    const auto faster = [](const WindowedMinimum& least, std::int64_t sample) { return sample < *least.value() - kClockStep; };
    const bool as_before = there_.value() && round_trip <= *there_.value() + *back_.value() + kClockStep / 3;
    if (as_before && (faster(there_, there) || faster(back_, back))) back_ = there_ = WindowedMinimum(kDelayWindow);
    back_.add(back, now);
    there_.add(there, now);
  }
  std::optional<std::int64_t> value() const noexcept {
    const auto there = there_.value(), back = back_.value();
    if (!there) return std::nullopt;
    return (*there - *back) / 2;
  }

 private:
  WindowedMinimum there_{kDelayWindow}, back_{kDelayWindow};  // both contain the offset
};

// ==== loss bursts ====
// Datagrams that are lost one after the other, and how long they leave the client without a state. spec/70-session.md section 8.

class LossBursts {
 public:
  /// A datagram came.   in   tick  highest of its packets, if it has any   pre  `now` [us] never decreases
  void heard(std::uint64_t number, std::optional<std::int64_t> tick, std::uint64_t now) noexcept;
  /// Ticks from the state before to the state after two thirds of the bursts, at most; 0: most losses are single ones.
  /// in   longest  [ticks]; longer ones are outages, which no delay bridges      time O(1024)
  std::int64_t bridge(std::int64_t longest, std::uint64_t now) noexcept;
  /// Fraction of the newest 256 numbers that did not come, of 128 if fewer are known, x 2^-16.   time O(1024)
  std::uint32_t loss(std::uint64_t now) const noexcept;

 private:
  static constexpr std::size_t kRemembered = 1024;
  struct Datagram {
    std::uint64_t number = 0, at = 0;  // at [us]
    std::optional<std::int64_t> tick;
  };
  std::uint64_t newest_old(std::uint64_t now) const noexcept;

  std::array<Datagram, kRemembered> datagrams_{};
  std::array<std::int64_t, kRemembered> spans_{};
  std::uint64_t newest_ = 0, first_ = 0;
};

// ==== playout clock ====
// Which tick of the other end to show now. spec/70-session.md section 8.

class PlayoutClock {
 public:
  /// in   reach  [us] that the tick shown is ahead of the news at most: older ones are worth nothing
  PlayoutClock(std::uint32_t tick_rate, const PlayoutOptions& options, std::int64_t reach = 100'000) noexcept
      : tick_rate_(tick_rate), options_(options), reach_(reach) {}

  /// A datagram came.   in   tick  highest of its packets, if it has any   time O(1), but 25 us each 100 ms
  void heard(std::uint64_t number, std::optional<std::int64_t> tick, std::uint64_t now) noexcept;
  /// With the datagram that was heard the other end signalled the time of its ticks [us].   time as heard()
  void clock_signalled(std::int64_t time, std::uint64_t now) noexcept;
  /// A copy of what was lost came: its tick is news, and says nothing about the delay.   time O(1)
  void repaired(std::int64_t tick) noexcept;
  /// A packet of this tick came at `at` [us] and could not be decoded until now.   time as heard()
  void held(std::int64_t tick, std::uint64_t at, std::uint64_t now) noexcept;
  /// What is lost goes again, over a link as measured. Nothing: it does not.
  void set_repair(const std::optional<RoundTrip>& round_trip) noexcept { repair_ = round_trip; }
  /// Since when packets wait for one that is missing [us]; nothing: none do. While they do, nothing is news but what is decoded.
  void waits(std::optional<std::uint64_t> since, std::uint64_t now) noexcept;
  /// A packet of an older tick came as well.   time O(1)
  void late(std::int64_t tick, std::uint64_t now) noexcept;
  /// A round trip was measured [us]: it distinguishes a longer delay from a clock that stood still.   time O(1)
  void measured(std::int64_t round_trip, std::uint64_t now) noexcept;
  /// Nobody asked this end for long: what comes now has waited here, and says nothing about the delay.   time O(1)
  void wake(std::uint64_t now) noexcept;
  /// The tick to show; it never falls unless the other end's ticks begin anew, nor below that of the first packet. -1: nothing was
  /// heard.
  std::int64_t shown(std::uint64_t now) noexcept;
  /// [us] by which the tick shown last is ahead of the newest one that was heard of; 0: it is not.
  std::int64_t ahead() const noexcept;
  /// [us] since the fastest packet would have brought the tick shown last; nothing: none was shown.
  std::optional<std::int64_t> behind(std::uint64_t now) const noexcept;
  std::int64_t delay() const noexcept { return delay_; }  ///< [us] behind the fastest packet of the last 10 s

 private:
  static constexpr std::size_t kRemembered = 2048;      // leads
  static constexpr std::uint64_t kRecent = 60'000'000;  // [us]: clocks drift
  /// What 100 ms brought, or more until they are enough: whether the other end's ticks, or our own clock, stood still.
  struct Period {
    std::uint64_t since = 0;  // [us]
    std::size_t leads = 0;
    std::int64_t least = 0, most = 0;  // of the leads
    std::optional<std::int64_t> trip;  // [us] the round trip most like those before
    std::int64_t base_before = 0;      // until then
    std::optional<std::int64_t> trip_before;
  };
  void learn(std::int64_t lead, std::uint64_t now) noexcept;
  void observe(std::int64_t time, std::int64_t lead) noexcept;
  std::int64_t repair_time() const noexcept;
  std::int64_t for_repair(std::uint64_t now) const noexcept;
  void add(std::int64_t lead, std::uint64_t now) noexcept;
  void adapt(std::uint64_t now) noexcept;
  bool is_settled(std::uint64_t now) noexcept;
  void begin_anew(std::uint64_t now) noexcept;
  std::int64_t time_of(std::int64_t tick) const noexcept;

  std::uint32_t tick_rate_;
  PlayoutOptions options_;
  std::int64_t reach_;                                        // [us]
  WindowedMinimum base_{kDelayWindow}, trips_{kDelayWindow};  // of the leads, of the round trips
  WindowedMinimum spread_{kDelayWindow};                      // of the periods: least less largest lead
  std::int64_t last_spread_ = 0;                              // of the last one, which may have leads from before a step
  Period period_;
  std::optional<std::int64_t> base_then_, trip_then_;  // at the begin of the last period
  LossBursts bursts_;
  struct Lead {
    std::int64_t lead = 0;
    std::uint64_t at = 0;
  };
  std::array<Lead, kRemembered> leads_{};
  std::array<std::int64_t, kRemembered> sorted_{};
  std::size_t next_ = 0, count_ = 0;
  std::int64_t delay_ = 0, late_ = 0;  // [us] behind `base_`
  std::int64_t least_ = 0;             // [us] the same of the fastest packet; clock parts may be faster
  std::uint64_t adapted_at_ = 0;       // [us]; 0: never
  std::uint64_t settled_at_ = 0;       // [us]: what comes before has waited here
  std::uint64_t newest_ = 0;           // number heard
  std::int64_t heard_at_ = 0;          // [us]
  std::int64_t news_ = std::numeric_limits<std::int64_t>::min() / 4;  // [us] time of the ticks up to which something was heard
  std::int64_t lead_ = 0;                                             // [us] of it
  std::int64_t signalled_ = 0;                                        // [us] newest time that a clock part signalled
  std::optional<RoundTrip> repair_;
  bool waits_ = false;
  bool follows_ = false;  // nothing is known to have stood still since
  std::int64_t shown_ = -1;
};

// ==== device tick mapping ====
// How the ticks of a client's device follow those of the server, so that its packets arrive before they act: a policy of the server.
// spec/65-signal.md section 4, informative part.

class DeviceTickMapping {
 public:
  explicit DeviceTickMapping(std::uint32_t tick_rate) noexcept
      : period_(2 * std::int64_t{tick_rate}), margin_((tick_rate + 499) / 500) {}

  /// A packet came.   in  device  its tick. Whether it is late is a matter of the mapping: it may be held, and a packet too late to act
  ///                             though the offset is large enough already
  void heard(std::int64_t device) noexcept {
    if (offset_) least_ = std::min(least_, device - (tick_ - *offset_));
  }

  /// What changes from this tick of the server on, if anything does.
  /// in   device  tick of the device that the fastest packets bring now
  std::optional<TickMappingPart> step(std::int64_t tick, std::int64_t device) noexcept {
    const std::int64_t before = offset_.value_or(std::numeric_limits<std::int64_t>::min());
    tick_ = tick;
    if (!offset_) offset_ = tick - device + margin_;
    else if (least_ <= 0) *offset_ += 1 - least_;
    else if (tick < until_) return std::nullopt;
    else if (least_ > margin_ && least_ != kNone) --*offset_;
    until_ = tick + period_;
    least_ = kNone;
    if (*offset_ == before) return std::nullopt;
    const TickMappingPart out{tick, *offset_};
    sent_[next_++ % sent_.size()] = {out, 0};
    waiting_ = std::min(waiting_ + 1, sent_.size());
    return out;
  }

  /// Whether there are changes that the client may not know.
  bool waits() const noexcept { return waiting_ > 0; }
  /// Send them in the datagram of this number.
  void send(DatagramWriter& writer, std::uint64_t number) noexcept {
    for (std::size_t back = waiting_; back > 0; --back) {
      Sent& sent = sent_[(next_ - back) % sent_.size()];
      if (!writer.add(sent.part)) return;
      if (sent.number == 0) sent.number = number;
    }
  }
  /// in   highest  number that the client has acknowledged
  void acknowledged(std::uint64_t highest) noexcept {
    while (waiting_ > 0) {
      const Sent& oldest = sent_[(next_ - waiting_) % sent_.size()];
      if (oldest.number == 0 || oldest.number > highest) return;
      --waiting_;
    }
  }

 private:
  static constexpr std::int64_t kNone = std::numeric_limits<std::int64_t>::max();
  struct Sent {
    TickMappingPart part;
    std::uint64_t number = 0;  // of the first datagram that carried it; every one since did, too
  };

  std::int64_t period_, margin_;  // [ticks]
  std::optional<std::int64_t> offset_;
  std::int64_t tick_ = 0;       // of the last step
  std::int64_t least_ = kNone;  // [ticks] until a packet takes effect that came since the last change; 0 or less: too late
  std::int64_t until_ = 0;      // before this tick the offset does not get smaller
  std::array<Sent, 8> sent_{};  // a ring
  std::size_t next_ = 0, waiting_ = 0;
};

// ==== force fade ====
// Old data pushes nobody. spec/70-session.md section 10.

/// Fraction of a force that a client may render, by the age of its news: all of it up to `fresh`, none from `stale` on, linear between.
/// When news come again, or fraction() is called again after a pause, it returns over `kReturn`.
class ForceFade {
 public:
  struct Limits {
    std::uint64_t fresh = 0, stale = 0;  ///< [us]
  };
  static constexpr Limits kUsual{70'000, 100'000};
  static constexpr Limits kDriven{300'000, 400'000};  ///< of a client that computes what its device does
  static constexpr Limits kOld{700'000, 1'000'000};   ///< of the state that is shown, as an answer to the own device
  static constexpr std::uint64_t kReturn = 500'000;   ///< [us]
  static constexpr std::int64_t kAll = 65536;

  void set_limits(const Limits& limits) noexcept { limits_ = limits; }

  /// The device feels nothing: a new contact need not rise slowly.
  void release(std::uint64_t now) noexcept {
    fraction_ = kAll;
    looked_at_ = now;
  }

  /// in   now >= heard  [us]; `now` never decreases;  old  [us] age of the state that is shown.   out  x 2^-16
  std::int64_t fraction(std::uint64_t now, std::uint64_t heard, std::uint64_t old = 0) noexcept {
    const std::int64_t most = std::min(left(now - heard, limits_), left(old, kOld));
    if (now - looked_at_ > limits_.stale) {  // nobody looked: what was rendered meanwhile is not known
      fraction_ = 0;
      looked_at_ = now;
    }
    const std::uint64_t passed = now - looked_at_;
    const auto risen = fraction_ + static_cast<std::int64_t>(passed * static_cast<std::uint64_t>(kAll) / kReturn);
    if (risen > fraction_ || most < fraction_) looked_at_ = now;
    fraction_ = std::min(most, risen);
    return fraction_;
  }

 private:
  static std::int64_t left(std::uint64_t age, const Limits& limits) noexcept {
    const std::uint64_t rest = limits.stale - std::clamp(age, limits.fresh, limits.stale);
    return static_cast<std::int64_t>(rest * static_cast<std::uint64_t>(kAll) / (limits.stale - limits.fresh));
  }

  Limits limits_ = kUsual;
  std::int64_t fraction_ = 0;
  std::uint64_t looked_at_ = 0;
};

}  // namespace tactus
