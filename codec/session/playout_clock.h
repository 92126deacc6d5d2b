// SPDX-License-Identifier: Apache-2.0
/// Which tick of the other end to show now. spec/70-session.md section 8. Internal to the library.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include <tactus/session/loss_bursts.h>
#include <tactus/session/session_options.h>
#include <tactus/session/windowed_minimum.h>

namespace tactus {

class PlayoutClock {
 public:
  PlayoutClock(std::uint32_t tick_rate, const PlayoutOptions& options) noexcept : tick_rate_(tick_rate), options_(options) {}

  /// A datagram came.   in   tick  highest of its packets, if it has any   time O(1), but 25 us each 100 ms
  void heard(std::uint64_t number, std::optional<std::int64_t> tick, std::uint64_t now) noexcept;
  /// A packet of an older tick came as well.   time O(1)
  void late(std::int64_t tick, std::uint64_t now) noexcept;
  /// The tick to show; it never falls, nor below that of the first packet. -1: nothing was heard.
  std::int64_t shown(std::uint64_t now) noexcept;
  /// [us] since the fastest packet would have brought the tick shown last; nothing: none was shown.
  std::optional<std::int64_t> behind(std::uint64_t now) const noexcept;
  std::int64_t delay() const noexcept { return delay_; }  ///< [us] behind the fastest packet of the last 10 s

 private:
  static constexpr std::size_t kRemembered = 2048;      // leads
  static constexpr std::uint64_t kRecent = 60'000'000;  // [us]: clocks drift
  void add(std::int64_t lead, std::uint64_t now) noexcept;
  void adapt(std::uint64_t now) noexcept;
  std::int64_t time_of(std::int64_t tick) const noexcept;

  std::uint32_t tick_rate_;
  PlayoutOptions options_;
  WindowedMinimum base_{10'000'000};  // of the leads
  LossBursts bursts_;
  struct Lead {
    std::int64_t lead = 0;
    std::uint64_t at = 0;
  };
  std::array<Lead, kRemembered> leads_{};
  std::array<std::int64_t, kRemembered> sorted_{};
  std::size_t next_ = 0, count_ = 0;
  std::int64_t delay_ = 0;
  std::uint64_t adapted_at_ = 0;  // [us]; 0: never
  std::int64_t shown_ = -1;
};

}  // namespace tactus
