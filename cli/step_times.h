// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace tactus::cli {

/// Wall-clock times of one step that is done again and again.
class StepTimes {
 public:
  using Clock = std::chrono::steady_clock;
  /// Run `work` and remember how long it took.
  template <class Work>
  auto measure(Work&& work) {
    const auto start = Clock::now();
    auto result = std::forward<Work>(work)();
    nanoseconds_.push_back(static_cast<std::uint32_t>(std::min<Clock::rep>((Clock::now() - start).count(), UINT32_MAX)));
    return result;
  }
  void add(double seconds) { nanoseconds_.push_back(static_cast<std::uint32_t>(std::min(1e9 * seconds, double{UINT32_MAX}))); }
  bool empty() const noexcept { return nanoseconds_.empty(); }
  std::size_t count() const noexcept { return nanoseconds_.size(); }
  double quantile(double share) const;  ///< [s]; 1: the longest
  double total() const noexcept;        ///< [s]

 private:
  std::vector<std::uint32_t> nanoseconds_;
};

}  // namespace tactus::cli
