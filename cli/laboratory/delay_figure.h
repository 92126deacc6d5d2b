// SPDX-License-Identifier: Apache-2.0
/// What a figure of thesis chapter 4 is made of: numbers beside those of the thesis, a plot, a table.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/figure/plot.h"
#include "cli/laboratory/cmd_reproduce.h"

namespace tactus::cli {

/// A row of a figure's table: what comes out here, and the number of the thesis; or something for each setting.
struct FigureNumber {
  std::string name;
  const char* unit;
  std::vector<std::optional<double>> values;  ///< one per column
};

struct DelayFigure {
  const char* figure;
  std::string title;
  std::vector<const char*> columns{"here", "thesis"};
  std::vector<FigureNumber> quantities{};
  Plot plot{};
  std::string table{};  ///< CSV

  void compare(std::string name, const char* unit, double here, std::optional<double> thesis = {}) {
    quantities.push_back({std::move(name), unit, {here, thesis}});
  }
};

/// Print the numbers.
void tell(const ReproduceOptions& options, const DelayFigure& figure);
/// The same; write plot and table to the folder of the options.
Outcome finish(const ReproduceOptions& options, const DelayFigure& figure);

}  // namespace tactus::cli
