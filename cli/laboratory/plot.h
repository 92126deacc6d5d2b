// SPDX-License-Identifier: Apache-2.0
/// Plots, drawn by the program `gnuplot` where it is installed (Debian package gnuplot-nox).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "cli/output.h"

namespace tactus::cli {

/// Becomes the data block $name of the script. An empty row separates two lines or blocks, as a blank line does in gnuplot.
struct PlotData {
  std::string name;
  std::vector<std::vector<double>> rows;
};

/// Any text as a string of a gnuplot script, which takes it as it is: in single quotes, where gnuplot substitutes nothing, as shown()
/// has it and with U+2019 for every apostrophe. To be drawn as it is it wants `noenhanced` behind it.
std::string gnuplot_text(std::string_view text);

struct Plot {
  std::string name;    ///< of the files
  std::string script;  ///< gnuplot commands; terminal, output, fonts and colours are set before
  std::vector<PlotData> data;
  int width = 900, height = 560;  ///< [pixels]
};

/// Colours of line types 1 to 7, told apart by everybody (Okabe and Ito): blue, vermilion, green, purple, orange, sky, black.
inline constexpr const char* kPlotColours[] = {"#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000"};

enum class Drawn : bool { no, yes };

/// err  the script of draw() is there and to be kept
Outcome check_plot(const Plot& plot, const std::string& directory, OutputFile::Existing existing);

/// Write DIR/NAME.gp, which holds script and data and can be run by itself, and DIR/NAME.svg and DIR/NAME.png, which gnuplot makes
/// of it on its standard output: no other program opens a file.
/// out  Drawn::no: there is no gnuplot; the script is there all the same
/// err  a file cannot be written; gnuplot refuses the script (its words are in the failure) or takes over a minute
tl::expected<Drawn, Failure> draw(const Plot& plot, const std::string& directory, OutputFile::Existing existing);

/// What to tell when draw() said no.
inline constexpr const char* kNoGnuplot = "gnuplot is not installed: plots are .gp files only (apt-get install gnuplot-nox)";

}  // namespace tactus::cli
