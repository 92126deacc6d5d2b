// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "cli/figure/plot.h"
#include "lab/study/study.h"

namespace tactus::cli {

struct StabilityPlot {
  Plot plot;
  std::string caption;
};

/// Those for which the studies hold the data.
std::vector<StabilityPlot> stability_plots(std::span<const sim::study::Study> studies);

}  // namespace tactus::cli
