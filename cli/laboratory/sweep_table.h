// SPDX-License-Identifier: Apache-2.0
/// What the figures of a sweep and its table.csv show: repetitions of a point together, with their spread.
#pragma once

#include <string>
#include <vector>

#include "cli/laboratory/sweep_plan.h"
#include "cli/laboratory/sweep_results.h"

namespace tactus::cli {

/// One combination of parameters and all of its repetitions. The columns are those of SweepPlan::all_columns().
struct SweepGroup {
  SweepResults::Row texts;                   ///< of the first repetition; those derived are empty
  std::vector<std::vector<double>> numbers;  ///< [column][repetition]: the number that the cell begins with, NaN without one
};

/// The least, the middle and the largest, of numbers that are finite.
struct Spread {
  double min, median, max;  ///< NaN: there is none
};
Spread spread_of(std::vector<double> numbers);

/// The groups in the plan's order, of those points that are there.
std::vector<SweepGroup> groups_of(const SweepPlan& plan, const SweepResults& results);

/// Write table.csv into the folder, where the plan has repetitions or derived columns: a row per group; of each measure and each derived
/// column its median, and its least and largest where there are repetitions.   out  files made
tl::expected<std::vector<std::string>, Failure> write_table(const SweepPlan& plan, const SweepResults& results);

}  // namespace tactus::cli
