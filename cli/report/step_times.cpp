// SPDX-License-Identifier: Apache-2.0
#include "cli/report/step_times.h"

#include <algorithm>
#include <cmath>
#include <ctime>

namespace tactus::cli {
namespace {

std::int64_t cpu_now() noexcept {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return std::int64_t{1'000'000'000} * now.tv_sec + now.tv_nsec;
}

/// Reading the CPU clock is a system call, longer than the shortest steps that are measured.
std::int64_t cost_of_reading() noexcept {
  std::int64_t least = INT64_MAX;
  for (int i = 0; i < 100; ++i) {
    const std::int64_t before = cpu_now();
    least = std::min(least, cpu_now() - before);
  }
  return least;
}

}  // namespace

Stopwatch::Stopwatch() noexcept : cpu_(cpu_now()), wall_(Clock::now()) {}

Cost Stopwatch::elapsed() const noexcept {
  const auto wall = Clock::now();
  const std::int64_t cpu = cpu_now();
  static const std::int64_t reading = cost_of_reading();
  return {std::chrono::duration_cast<std::chrono::nanoseconds>(wall - wall_).count(),
          std::max<std::int64_t>(0, cpu - cpu_ - reading)};
}

void StepTimes::add(Cost cost) {
  wall_ns_.push_back(cost.wall_ns);
  cpu_ns_.push_back(cost.cpu_ns);
}

double StepTimes::quantile(TimeOf which, double share) const {
  std::vector<std::int64_t> sorted = times(which);
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
  const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(std::max<std::size_t>(rank, 1) - 1);
  std::nth_element(sorted.begin(), at, sorted.end());
  return 1e-9 * static_cast<double>(*at);
}

double StepTimes::total(TimeOf which) const noexcept {
  std::int64_t sum = 0;
  for (const std::int64_t t : times(which)) sum += t;
  return 1e-9 * static_cast<double>(sum);
}

}  // namespace tactus::cli
