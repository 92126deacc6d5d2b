// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/laboratory/sweep_plan.h"
#include "cli/laboratory/sweep_results.h"
#include "cli/report/messages.h"

namespace tactus::cli {

struct DrawnPlots {
  std::vector<std::string> files, notes;  ///< notes: why there are not more
};

/// The plan's figures from the rows that are there, into the sweep's folder.
tl::expected<DrawnPlots, Failure> draw_plots(const SweepPlan& plan, const SweepResults& results);

}  // namespace tactus::cli
