// SPDX-License-Identifier: Apache-2.0
/// The figures of `tactus bench precision` as a table, JSON, Markdown and plots.
#pragma once

#include <string>
#include <vector>

#include "cli/figure/plot.h"
#include "cli/laboratory/precision_results.h"

namespace tactus::cli {

struct TimeStudy {
  sim::study::PrecisionScene scene;
  sim::study::PrecisionPoint reference;
  std::vector<sim::study::PrecisionMethod> methods;
  std::vector<sim::study::PrecisionPoint> points;  ///< method by method, largest step first
};

struct SpaceStudy {
  std::string scene;
  std::vector<sim::study::SpacePoint> points;  ///< of one Poisson's ratio, coarsest first
  sim::study::SpaceErrors errors;
};

struct PrecisionReport {
  PrecisionResults::Context context;
  std::vector<TimeStudy> times;
  std::vector<SpaceStudy> spaces;
};

void print_precision_tables(const PrecisionReport& report);  ///< to standard output
std::string precision_json(const PrecisionReport& report);   ///< "tactus.precision/1"
std::string precision_markdown(const PrecisionReport& report);
std::vector<Plot> precision_plots(const PrecisionReport& report);

/// Points worth a mark: finished, with an error below the size of the solution.
bool is_usable(double error) noexcept;

}  // namespace tactus::cli
