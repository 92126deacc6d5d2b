// SPDX-License-Identifier: Apache-2.0
#include "cli/options/suggestion.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace tactus::cli {
namespace {

/// Letters to insert, remove, replace or swap with the next (optimal string alignment).
std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    before.swap(last);
    last.swap(row);
  }
  return last.back();
}

}  // namespace

std::string did_you_mean(std::string_view typed, std::span<const std::string> names) {
  constexpr std::size_t kLongest = 64;  // what is longer is no slip
  if (typed.size() > kLongest) return {};
  std::string nearest;
  std::size_t least = typed.size();
  for (const std::string& name : names) {
    const std::size_t steps = distance(typed, name);
    if (steps >= least || 3 * steps > std::max<std::size_t>(name.size(), 3)) continue;
    least = steps;
    nearest = name;
  }
  return nearest.empty() ? std::string() : ". Did you mean " + nearest + "?";
}

}  // namespace tactus::cli
