// SPDX-License-Identifier: Apache-2.0
#include "cli/step_times.h"

#include <cmath>

namespace tactus::cli {

double StepTimes::quantile(double share) const {
  std::vector<std::uint32_t> sorted = nanoseconds_;
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
  const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(std::max<std::size_t>(rank, 1) - 1);
  std::nth_element(sorted.begin(), at, sorted.end());
  return 1e-9 * *at;
}

double StepTimes::total() const noexcept {
  std::uint64_t sum = 0;
  for (const std::uint32_t t : nanoseconds_) sum += t;
  return 1e-9 * static_cast<double>(sum);
}

}  // namespace tactus::cli
