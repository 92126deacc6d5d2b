// SPDX-License-Identifier: Apache-2.0
/// The numbered datagrams that an end has received: which are new, and what to acknowledge. spec/70-session.md section 4. Internal to
/// the library.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include <tactus/base/result.h>
#include <tactus/session/datagram.h>

namespace tactus {

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
enum class Asks : std::uint8_t {
  never,  ///< it holds nothing but acknowledgements and clocks
  soon,
  now,  ///< a sign of life
};

class ReceivedNumbers {
 public:
  /// The number that 14 bits of it stand for: the one nearest to the newest.
  /// err  state R-SES-4: it was received before, or is too old
  Result<std::uint64_t> extend(std::uint16_t wire) const noexcept;
  std::uint64_t newest() const noexcept { return received_.newest(); }    ///< highest number received, 0: none
  void receive(std::uint64_t number) noexcept { received_.add(number); }  ///< pre  extend()

  /// [us] that an acknowledgement waits for a datagram to ride on: `all_is_well` if every number that the last one did not tell of has
  /// come, and none that it said was missing; else `usual`.
  struct Patience {
    std::uint64_t usual = 0, all_is_well = 0;
  };
  /// A received datagram, all of whose packets are decoded, is to be acknowledged.
  /// in   now  [us]
  void accept(std::uint64_t number, std::uint64_t now, Asks asks, const Patience& patience) noexcept;

  bool has_news() const noexcept { return due_.has_value(); }
  /// [us] when an acknowledgement should go even if nothing else does
  std::optional<std::uint64_t> due() const noexcept { return due_; }
  /// pre  something was accepted
  Acknowledgement acknowledge(std::uint64_t now) noexcept;
  bool can_acknowledge() const noexcept { return accepted_.newest() > 0; }

 private:
  static constexpr unsigned kUntold = 32;  // of the 65 that an acknowledgement tells of: so one of them may be lost

  NumberWindow received_, accepted_;
  unsigned untold_ = 0;                          // accepted since the last acknowledgement
  std::uint64_t newest_at_ = 0;                  // [us] when accepted_.newest() came
  std::optional<std::uint64_t> due_, asked_at_;  // asked_at_: by the first that asks since the last acknowledgement
  std::uint64_t told_ = 0, above_told_ = 0;      // newest of the last acknowledgement; how many above it were accepted
  bool changes_told_ = false;                    // one below it was accepted since
};

}  // namespace tactus
