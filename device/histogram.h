// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <tactus/device/device.h>

namespace tactus::device {

/// Durations in bins of 1 us up to 10 ms, and how many were longer. add() is O(1) and allocates nothing.
class Histogram {
 public:
  void add(Time duration) noexcept {
    const auto bin = static_cast<std::size_t>(std::clamp<Time>(duration / kBin, 0, kBins));
    ++(bin < kBins ? bins_[bin] : longer_);
    ++count_;
    longest_ = std::max(longest_, duration);
  }
  std::uint64_t count() const noexcept { return count_; }
  std::uint64_t longer() const noexcept { return longer_; }  ///< than 10 ms
  Time longest() const noexcept { return longest_; }
  /// [ns] Upper end of the bin that holds this share of the durations; the longest if that is beyond the bins; 0 without any.
  Time quantile(double share) const noexcept {
    const auto wanted = static_cast<std::uint64_t>(share * static_cast<double>(count_));
    std::uint64_t seen = 0;
    for (std::size_t bin = 0; bin < kBins; ++bin)
      if ((seen += bins_[bin]) > wanted) return std::min(longest_, kBin * static_cast<Time>(bin + 1));
    return longest_;
  }

 private:
  static constexpr Time kBin = 1000;
  static constexpr std::size_t kBins = 10'000;
  std::vector<std::uint64_t> bins_ = std::vector<std::uint64_t>(kBins);
  std::uint64_t count_ = 0, longer_ = 0;
  Time longest_ = 0;
};

}  // namespace tactus::device
