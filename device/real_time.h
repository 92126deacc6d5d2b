// SPDX-License-Identifier: Apache-2.0
/// The host's time: clock, real-time scheduling, and a histogram of how late ticks are.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <tactus/device/device.h>

namespace tactus::device {

// ==== histogram ====

/// Durations in bins of 1 us up to 10 ms, and how many were longer. add() is O(1) and allocates nothing.
class Histogram {
 public:
  void add(Time duration) noexcept {
    const auto bin = static_cast<std::size_t>(std::clamp<Time>(duration / kBin, 0, kBins));
    ++(bin < kBins ? bins_[bin] : longer_);
    ++count_;
    longest_ = (std::max)(longest_, duration);
  }
  std::uint64_t count() const noexcept { return count_; }
  std::uint64_t longer() const noexcept { return longer_; }  ///< than 10 ms
  Time longest() const noexcept { return longest_; }
  /// [ns] Upper end of the bin that holds this fraction of the durations; the longest if that is beyond the bins; 0 without any.
  Time quantile(double fraction) const noexcept {
    const auto wanted = static_cast<std::uint64_t>(fraction * static_cast<double>(count_));
    std::uint64_t seen = 0;
    for (std::size_t bin = 0; bin < kBins; ++bin)
      if ((seen += bins_[bin]) > wanted) return (std::min)(longest_, kBin * static_cast<Time>(bin + 1));
    return longest_;
  }

 private:
  static constexpr Time kBin = 1000;
  static constexpr std::size_t kBins = 10'000;
  std::vector<std::uint64_t> bins_ = std::vector<std::uint64_t>(kBins);
  std::uint64_t count_ = 0, longer_ = 0;
  Time longest_ = 0;
};

// ==== clock ====

/// What a servo loop waits on. Tests have their own.
class Clock {
 public:
  virtual Time now() noexcept = 0;
  virtual void sleep_until(Time time) noexcept = 0;

  virtual ~Clock() = default;
  Clock() = default;
  Clock(const Clock&) = delete;
  Clock& operator=(const Clock&) = delete;
};

/// CLOCK_MONOTONIC: a step of the wall clock does not reach it.
Clock& monotonic_clock() noexcept;

// ==== real time ====
// What the operating system can do so that a thread wakes in time.

/// Asked for, and granted or not.
struct Privilege {
  std::string name;  ///< "real-time priority"
  bool granted = false;
  std::string remedy;  ///< what grants it; empty if it was granted
};

/// For the calling thread and as long as this lives: real-time scheduling (SCHED_FIFO), memory that is never swapped out, and a
/// processor that does not sleep deeply. What is not granted is left as it is.
class RealTime {
 public:
  RealTime();
  ~RealTime();
  RealTime(const RealTime&) = delete;
  RealTime& operator=(const RealTime&) = delete;

  const std::vector<Privilege>& privileges() const noexcept { return privileges_; }
  /// "real-time priority, memory locked, no deep sleep", or "none".
  std::string granted() const;

 private:
  std::vector<Privilege> privileges_;
  int latency_ = -1;               // descriptor of the request, while it is open
  int policy_ = 0, priority_ = 0;  // before
};

}  // namespace tactus::device
