// SPDX-License-Identifier: Apache-2.0
/// Numbers of datagrams, sent and received: which arrived, which are lost, how long the path takes. Integers. Internal to the library.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>

#include <tactus/base/result.h>
#include <tactus/session/datagram.h>

namespace tactus {

// ==== windowed minimum ====

/// The least of the samples of a time: of the newest tenth of the window, not all over, and the nine before.
class WindowedMinimum {
 public:
  /// in   window  [us]
  explicit WindowedMinimum(std::uint64_t window) noexcept : part_(window / kParts) {}

  /// True if the sample is the least now.   pre  `now` [us] never decreases
  bool add(std::int64_t sample, std::uint64_t now) noexcept {
    newest_ = now / part_ + 1;
    Part& part = parts_[newest_ % kParts];
    if (part.number != newest_) part = {sample, newest_};
    part.least = std::min(part.least, sample);
    return *value() == sample;
  }
  /// Nothing: there is no sample.
  std::optional<std::int64_t> value() const noexcept {
    std::optional<std::int64_t> out;
    for (const Part& part : parts_)
      if (part.number > 0 && part.number + kParts > newest_) out = std::min(out.value_or(part.least), part.least);
    return out;
  }

 private:
  static constexpr std::size_t kParts = 10;
  struct Part {
    std::int64_t least = 0;
    std::uint64_t number = 0;  // of this length of time since 0, + 1; 0: empty
  };
  std::uint64_t part_, newest_ = 0;
  std::array<Part, kParts> parts_{};
};

// ==== sent numbers ====
// The numbered datagrams that an end has sent: which arrived, which are lost, and how long the path takes. spec/70-session.md sections 4
// and 7.

class SentNumbers {
 public:
  static constexpr std::uint64_t kRemembered = 1024;
  static constexpr std::uint64_t kMostAhead = 4096;  ///< numbers above the highest acknowledged: 14 bits stay unambiguous

  /// Number of the next datagram; nothing while too many wait for an acknowledgement.
  std::optional<std::uint64_t> next() const noexcept;
  std::uint64_t newest() const noexcept { return next_ - 1; }  ///< number given; 0: none
  void send(std::uint64_t now) noexcept;                       ///< the datagram of number next() goes

  /// Look at an acknowledgement.
  /// in   arrived(number), lost(number)  called once for each number, arrived for those reported as lost, too, if they come later
  /// err  invalid R-SES-6: it names a number that was never sent; nothing changes
  template <class Arrived, class Lost>
  Result<void> acknowledge(const Acknowledgement& ack, std::uint64_t now, Arrived&& arrived, Lost&& lost) noexcept {
    TACTUS_TRY(const std::uint64_t newest, extend(ack));
    measure(newest, ack.held, now);
    if (mark(newest)) arrived(newest);
    for (std::uint64_t i = 0; i < 64 && newest > i + 1; ++i)
      if (!(ack.missing >> i & 1u) && mark(newest - 1 - i)) arrived(newest - 1 - i);
    const std::uint64_t first = next_ > kRemembered ? next_ - kRemembered : 1;
    for (std::uint64_t number = std::max(first, first_open_); number < newest; ++number)
      if (is_lost(number, newest, now)) lost(number);
    while (first_open_ < newest && !is_open(first_open_)) ++first_open_;
    return {};
  }

  /// When the oldest went whose fate is not known [us]; nothing: there is none.
  std::optional<std::uint64_t> oldest() const noexcept;
  /// What went until then and was not acknowledged is lost.   in  lost(number)
  template <class Lost>
  void expire(std::uint64_t until, Lost&& lost) noexcept {
    for (; first_open_ < next_; ++first_open_) {
      if (!is_open(first_open_)) continue;
      if (slots_[first_open_ % kRemembered].time > until) return;
      slots_[first_open_ % kRemembered].fate = Fate::lost;
      lost(first_open_);
    }
  }

  /// What is that far below the highest acknowledged, and went until then, is lost, sooner than acknowledge() reports it.
  template <class Lost>
  void lose(std::uint64_t back, std::uint64_t until, Lost&& lost) noexcept {
    const std::uint64_t first = next_ > kRemembered ? next_ - kRemembered : 1;
    for (std::uint64_t number = std::max(first, first_open_); number + back < highest_; ++number) {
      if (!is_open(number) || slots_[number % kRemembered].time > until) continue;
      slots_[number % kRemembered].fate = Fate::lost;
      count(true);
      lost(number);
    }
  }

  const std::optional<RoundTrip>& round_trip() const noexcept { return round_trip_; }
  /// Round trip of the last acknowledgement that measured one [us].
  std::optional<std::int64_t> sample() const noexcept { return sample_; }
  /// Fraction of the newest 256 numbers whose fate is known, of 128 if these are fewer, x 2^-16.
  std::uint32_t loss() const noexcept;
  std::uint64_t highest_acknowledged() const noexcept { return highest_; }
  bool has_arrived(std::uint64_t number) const noexcept {
    const Slot& slot = slots_[number % kRemembered];
    return slot.number == number && slot.fate == Fate::arrived;
  }

 private:
  enum class Fate : std::uint8_t { open, arrived, lost };
  struct Slot {
    std::uint64_t number = 0;
    std::uint64_t time = 0;  // [us] when it was sent
    Fate fate = Fate::open;
  };
  Result<std::uint64_t> extend(const Acknowledgement& ack) const noexcept;
  void measure(std::uint64_t newest, std::uint16_t held, std::uint64_t now) noexcept;
  bool mark(std::uint64_t number) noexcept;  // arrived; false if that is known
  bool is_lost(std::uint64_t number, std::uint64_t newest, std::uint64_t now) noexcept;
  bool is_open(std::uint64_t number) const noexcept;
  Slot* find(std::uint64_t number) noexcept;
  void count(bool lost) noexcept;

  std::array<Slot, kRemembered> slots_{};
  std::uint64_t next_ = 1, highest_ = 0, first_open_ = 1;
  std::optional<std::int64_t> sample_;
  std::optional<RoundTrip> round_trip_;
  WindowedMinimum least_{10'000'000};
  std::array<std::uint64_t, 4> fates_{};  // a ring of 256 bits: lost
  std::size_t fate_next_ = 0, fate_count_ = 0;
};

// ==== received numbers ====
// The numbered datagrams that an end has received: which are new, and what to acknowledge. spec/70-session.md section 4. Internal to
// the library.

/// A set of the newest numbers. All below its reach are gone.
class NumberWindow {
 public:
  static constexpr std::uint64_t kReach = 1024;

  std::uint64_t newest() const noexcept { return newest_; }  ///< highest number added; 0: none
  bool is_too_old(std::uint64_t number) const noexcept { return number + kReach <= newest_; }
  bool has(std::uint64_t number) const noexcept;
  void add(std::uint64_t number) noexcept;  ///< pre  not too old, above 0.   time O(distance from newest()), at most kReach

 private:
  std::array<std::uint64_t, kReach / 64> bits_{};
  std::uint64_t newest_ = 0;
};

/// When a datagram is to be acknowledged.
enum class AckTiming : std::uint8_t {
  never,  ///< it holds nothing but acknowledgements and clocks
  soon,
  now,  ///< a keep-alive
};

class ReceivedNumbers {
 public:
  /// The number that 14 bits of it stand for: the one nearest to the newest.
  /// err  state R-SES-4: it was received before, or is too old
  Result<std::uint64_t> extend(std::uint16_t wire) const noexcept;
  std::uint64_t newest() const noexcept { return received_.newest(); }    ///< highest number received, 0: none
  void receive(std::uint64_t number) noexcept { received_.add(number); }  ///< pre  extend()

  /// [us] that an acknowledgement waits for a datagram to ride on: `all_is_well` if every number that the last one did not report has
  /// come, and none that it reported missing; else `usual`.
  struct AckDelay {
    std::uint64_t usual = 0, all_is_well = 0;
  };
  /// A received datagram, all of whose packets are decoded, is to be acknowledged.
  /// in   now  [us]
  void accept(std::uint64_t number, std::uint64_t now, AckTiming timing, const AckDelay& delay) noexcept;

  bool has_news() const noexcept { return due_.has_value(); }
  /// [us] when an acknowledgement should go even if nothing else does
  std::optional<std::uint64_t> due() const noexcept { return due_; }
  /// pre  something was accepted
  Acknowledgement acknowledge(std::uint64_t now) noexcept;
  bool can_acknowledge() const noexcept { return accepted_.newest() > 0; }

 private:
  static constexpr unsigned kUnreported = 32;  // of the 65 that an acknowledgement reports: so one of them may be lost

  NumberWindow received_, accepted_;
  unsigned unreported_ = 0;      // accepted since the last acknowledgement
  std::uint64_t newest_at_ = 0;  // [us] when accepted_.newest() came
  std::optional<std::uint64_t> due_,
      eliciting_at_;  // eliciting_at_: of the first ack-eliciting one since the last acknowledgement
  std::uint64_t reported_ = 0, above_reported_ = 0;  // newest of the last acknowledgement; how many above it were accepted
  bool changes_reported_ = false;                    // one below it was accepted since
};

}  // namespace tactus
