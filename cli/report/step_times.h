// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace tactus::cli {

/// What a piece of work took. CPU time is that of all threads of the process: unlike wall-clock time it does not grow with what else
/// the machine has to do.
struct Cost {
  std::int64_t wall_ns = 0, cpu_ns = 0;
};

class Stopwatch {
 public:
  Stopwatch() noexcept;
  Cost elapsed() const noexcept;  ///< since construction, less what reading the CPU clock takes itself

 private:
  using Clock = std::chrono::steady_clock;
  std::int64_t cpu_;
  Clock::time_point wall_;
};

enum class TimeOf : std::uint8_t { wall, cpu };

/// Times of one step that is done again and again.
class StepTimes {
 public:
  /// Run `work` and remember how long it took.
  template <class Work>
  auto measure(Work&& work) {
    const Stopwatch watch;
    auto result = std::forward<Work>(work)();
    add(watch.elapsed());
    return result;
  }
  void add(Cost cost);
  bool empty() const noexcept { return wall_ns_.empty(); }
  std::size_t count() const noexcept { return wall_ns_.size(); }
  double quantile(TimeOf which, double share) const;  ///< [s]; 1: the longest.   pre  not empty
  double total(TimeOf which) const noexcept;          ///< [s]

 private:
  const std::vector<std::int64_t>& times(TimeOf which) const noexcept { return which == TimeOf::wall ? wall_ns_ : cpu_ns_; }

  std::vector<std::int64_t> wall_ns_, cpu_ns_;
};

}  // namespace tactus::cli
