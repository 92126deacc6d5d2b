// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include <tactus/session/windowed_minimum.h>

namespace tactus {

/// The other end's clock less our own [us], from the fastest way there and the fastest way back of the last 10 s: these count as equally
/// long. spec/70-session.md section 7. Internal to the library.
class ClockOffset {
 public:
  /// in   time  [us] of the other end, when it sent what came at `now` [us];  round_trip  [us], without what the other end waited
  void add(std::uint64_t time, std::int64_t round_trip, std::uint64_t now) noexcept {
    const auto back = static_cast<std::int64_t>(now) - static_cast<std::int64_t>(time);
    back_.add(back, now);
    there_.add(round_trip - back, now);
  }
  std::optional<std::int64_t> value() const noexcept {
    const auto there = there_.value(), back = back_.value();
    if (!there) return std::nullopt;
    return (*there - *back) / 2;
  }

 private:
  static constexpr std::uint64_t kWindow = 10'000'000;
  WindowedMinimum there_{kWindow}, back_{kWindow};  // both contain the offset
};

}  // namespace tactus
