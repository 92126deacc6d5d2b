// SPDX-License-Identifier: Apache-2.0
/// Figures as numbers, and the option --plot that has them drawn by lab/plot.py.
#pragma once

#include <array>
#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "cli/options/options_codec.h"

namespace tactus::cli {

using Point = std::array<double, 2>;  ///< x, y

/// One of the panels of a figure, which stand one below the other and share the axis of x.
struct Panel {
  struct Line {
    std::string name;
    std::vector<Point> points;
  };

  std::string label;  ///< quantity and unit
  std::vector<Line> lines{};
  double bound = std::numeric_limits<double>::quiet_NaN();  ///< drawn as a level, if there is one
};

struct Figure {
  std::string heading;
  std::vector<Panel> panels;  ///< those without a line are left out
  std::string x_label = "time [s]";
  bool logarithmic_x = false;
};

/// In one line: schemas/figure.json
std::string text_of_figure(const Figure& figure);

/// `--plot FILE`: a figure (SVG, PNG, PDF) or its numbers (JSON)
void add_plot_option(Command& command, std::string& path, const std::string& what);
/// Before the work. Nothing is wrong where no figure was asked for.
/// err  FILE is there and to be kept, or is one of the others; Python, NumPy or matplotlib is missing
Outcome check_plot_option(const std::string& path, const CommonOptions& common, const std::vector<std::string>& others);

/// err  Python, NumPy or matplotlib is missing
Outcome check_can_draw();

/// Have a figure drawn, if a path was asked for.   err  it has no panel; that of lab/plot.py; FILE cannot be written
Outcome draw(const std::string& path, const Figure& figure, const CommonOptions& common);
/// The same of any figure that lab/plot.py knows.
Outcome draw(const std::string& path, const nlohmann::ordered_json& figure, OutputFile::Existing existing);

}  // namespace tactus::cli
