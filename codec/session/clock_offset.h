// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace tactus {

/// The other end's clock less our own [us], from the exchange with the shortest round trip of the last 10 s: the way there counts as long
/// as the way back. spec/70-session.md section 7. Internal to the library.
class ClockOffset {
 public:
  /// in   time  [us] of the other end, when it sent what came at `now` [us];  round_trip  [us]
  void add(std::uint64_t time, std::int64_t round_trip, std::uint64_t now) noexcept {
    newest_ = now / kSecond + 1;
    Best& best = seconds_[newest_ % kSeconds];
    const auto offset = static_cast<std::int64_t>(time) + round_trip / 2 - static_cast<std::int64_t>(now);
    if (best.second != newest_ || round_trip < best.round_trip) best = {newest_, round_trip, offset};
  }
  std::optional<std::int64_t> value() const noexcept {
    const Best* found = nullptr;
    for (const Best& best : seconds_)
      if (best.second > 0 && best.second + kSeconds > newest_ && (found == nullptr || best.round_trip < found->round_trip))
        found = &best;
    return found == nullptr ? std::nullopt : std::optional(found->offset);
  }

 private:
  static constexpr std::uint64_t kSecond = 1'000'000;
  static constexpr std::size_t kSeconds = 10;
  struct Best {
    std::uint64_t second = 0;  // since 0, + 1; 0: empty
    std::int64_t round_trip = 0, offset = 0;
  };
  std::array<Best, kSeconds> seconds_{};
  std::uint64_t newest_ = 0;
};

}  // namespace tactus
