// SPDX-License-Identifier: Apache-2.0
/// The numbered datagrams that an end has sent: which arrived, which are lost, and how long the way takes. spec/70-session.md sections 4
/// and 7. Internal to the library.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>

#include <tactus/base/result.h>
#include <tactus/session/datagram.h>
#include <tactus/session/windowed_minimum.h>

namespace tactus {

class SentNumbers {
 public:
  static constexpr std::uint64_t kRemembered = 1024;
  static constexpr std::uint64_t kMostAhead = 4096;  ///< numbers above the highest acknowledged: 14 bits stay unambiguous

  /// Number of the next datagram; nothing while too many wait for an acknowledgement.
  std::optional<std::uint64_t> next() const noexcept;
  std::uint64_t newest() const noexcept { return next_ - 1; }  ///< number given; 0: none
  void send(std::uint64_t now) noexcept;                       ///< the datagram of number next() goes

  /// Look at an acknowledgement.
  /// in   arrived(number), lost(number)  called once for each number, arrived for those said to be lost, too, if they come later
  /// err  invalid R-SES-6: it names a number that was never sent; nothing changes
  template <class Arrived, class Lost>
  Result<void> acknowledge(const Acknowledgement& said, std::uint64_t now, Arrived&& arrived, Lost&& lost) noexcept {
    TACTUS_TRY(const std::uint64_t newest, extend(said));
    measure(newest, said.held, now);
    if (mark(newest)) arrived(newest);
    for (std::uint64_t i = 0; i < 64 && newest > i + 1; ++i)
      if (!(said.missing >> i & 1u) && mark(newest - 1 - i)) arrived(newest - 1 - i);
    const std::uint64_t first = next_ > kRemembered ? next_ - kRemembered : 1;
    for (std::uint64_t number = std::max(first, first_open_); number < newest; ++number)
      if (is_lost(number, newest, now)) lost(number);
    while (first_open_ < newest && !is_open(first_open_)) ++first_open_;
    return {};
  }

  const std::optional<RoundTrip>& round_trip() const noexcept { return round_trip_; }
  /// Round trip of the last acknowledgement that measured one [us].
  std::optional<std::int64_t> sample() const noexcept { return sample_; }
  /// Share of the newest 256 numbers whose fate is known, of 128 if these are fewer, x 2^-16.
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
  Result<std::uint64_t> extend(const Acknowledgement& said) const noexcept;
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

}  // namespace tactus
