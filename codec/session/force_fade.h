// SPDX-License-Identifier: Apache-2.0
/// Old data pushes nobody. spec/70-session.md section 10. Internal to the library.
#pragma once

#include <algorithm>
#include <cstdint>

namespace tactus {

/// Share of a force that a client may render, by the age of its news: all of it up to `fresh`, none from `stale` on, straight between.
/// When news come again, or share() is called again after a pause, it returns over `kReturn`.
class ForceFade {
 public:
  struct Limits {
    std::uint64_t fresh = 0, stale = 0;  ///< [us]
  };
  static constexpr Limits kUsual{70'000, 100'000};
  static constexpr Limits kDriven{300'000, 400'000};  ///< of a client that works out what its device does
  static constexpr std::uint64_t kReturn = 500'000;   ///< [us]
  static constexpr std::int64_t kAll = 65536;

  void set_limits(const Limits& limits) noexcept { limits_ = limits; }

  /// The device feels nothing: a new contact need not rise slowly.
  void release(std::uint64_t now) noexcept {
    share_ = kAll;
    looked_at_ = now;
  }

  /// in   now >= heard  [us]; `now` never decreases.   out  x 2^-16
  std::int64_t share(std::uint64_t now, std::uint64_t heard) noexcept {
    const auto [fresh, stale] = limits_;
    const std::uint64_t age = std::clamp(now - heard, fresh, stale);
    const auto most = static_cast<std::int64_t>((stale - age) * static_cast<std::uint64_t>(kAll) / (stale - fresh));
    if (now - looked_at_ > stale) {  // nobody looked: what was felt meanwhile is not known
      share_ = 0;
      looked_at_ = now;
    }
    const std::uint64_t passed = now - looked_at_;
    const auto risen = share_ + static_cast<std::int64_t>(passed * static_cast<std::uint64_t>(kAll) / kReturn);
    if (risen > share_ || most < share_) looked_at_ = now;
    share_ = std::min(most, risen);
    return share_;
  }

 private:
  Limits limits_ = kUsual;
  std::int64_t share_ = 0;
  std::uint64_t looked_at_ = 0;
};

}  // namespace tactus
