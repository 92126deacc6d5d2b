// SPDX-License-Identifier: Apache-2.0
/// The option --plot.
#pragma once

#include <string>
#include <vector>

#include "cli/figure/plot.h"
#include "cli/options/options_codec.h"

namespace tactus::cli {

/// What was typed is FILE.svg.
Check svg_file();
/// `--plot FILE.svg`
void add_plot_option(Command& command, std::string& path, const std::string& what);
/// err  FILE.svg is there and to be kept, or is one of the others; nothing where none was asked for
Outcome check_plot_option(const std::string& path, const CommonOptions& common, const std::vector<std::string>& others);

/// Draw a figure to its path, whatever its name; where gnuplot is missing a note says so.   err  as draw()
Outcome draw_at(const std::string& path, Plot plot, const CommonOptions& common);

}  // namespace tactus::cli
