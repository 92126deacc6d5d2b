// SPDX-License-Identifier: Apache-2.0
/// The rate at which an end sends. spec/70-session.md section 9. Internal to the library.
#pragma once

#include <algorithm>
#include <cstdint>

namespace tactus {

/// Fills at `rate`, holds what 50 ms bring, and may be overdrawn by one datagram.
class TokenBucket {
 public:
  static constexpr std::int64_t kHolds = 50'000;  ///< [us]

  /// in   rate  [bit/s], at most 10^12; 0: no limit
  explicit TokenBucket(std::uint64_t rate) noexcept : rate_(static_cast<std::int64_t>(rate)), level_(rate_ * kHolds) {}

  bool is_open(std::uint64_t now) noexcept {
    if (rate_ == 0) return true;
    const auto passed = static_cast<std::int64_t>(std::min<std::uint64_t>(now - filled_at_, kHolds));
    level_ = std::min(level_ + passed * rate_, rate_ * kHolds);
    filled_at_ = now;
    return level_ > 0;
  }
  void take(std::int64_t bits) noexcept { level_ -= rate_ == 0 ? 0 : bits * 1'000'000; }

 private:
  std::int64_t rate_, level_;  // [bit/s], [1e-6 bit]
  std::uint64_t filled_at_ = 0;
};

}  // namespace tactus
