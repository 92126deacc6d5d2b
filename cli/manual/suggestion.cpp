// SPDX-License-Identifier: Apache-2.0
#include "cli/manual/suggestion.h"

#include <algorithm>
#include <numeric>

namespace tactus::cli {
namespace {

/// Slips between two words: the optimal string alignment distance.
std::size_t slips(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before_last, last(b.size() + 1), row(b.size() + 1);
  std::iota(last.begin(), last.end(), 0U);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0U : 1U)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
    before_last = last;
    last = row;
  }
  return last[b.size()];
}

}  // namespace

std::string did_you_mean(std::string_view typed, const std::vector<std::string>& names) {
  constexpr std::size_t kLongest = 64;  // no name of ours is longer, and the work grows with it
  const std::size_t letters = typed.size() - std::min(typed.find_first_not_of('-'), typed.size());
  if (letters < 2 || typed.size() > kLongest) return "";
  std::string_view best;
  std::size_t least = letters / 3 + (letters < 3 ? 1 : 0);
  for (const std::string& name : names) {
    if (name.size() < 3) continue;  // any letter is one slip from -p
    const std::size_t distance = name.starts_with(typed) ? 1 : slips(typed, name);
    if (distance > least || (distance == least && !best.empty())) continue;
    least = distance;
    best = name;
  }
  return best.empty() ? "" : "Did you mean " + std::string(best) + "? ";
}

}  // namespace tactus::cli
