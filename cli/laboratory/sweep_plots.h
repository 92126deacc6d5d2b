// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/laboratory/sweep_plan.h"
#include "cli/laboratory/sweep_results.h"
#include "cli/report/messages.h"

namespace tactus::cli {

/// The plan's figures from the rows that are there, into the sweep's folder.   out  files made
tl::expected<std::vector<std::string>, Failure> draw_plots(const SweepPlan& plan, const SweepResults& results);

}  // namespace tactus::cli
