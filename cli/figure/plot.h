// SPDX-License-Identifier: Apache-2.0
/// Figures, drawn by the program `gnuplot` where it is installed (Debian package gnuplot-nox) and the gnuplot programs in plots/, which
/// are part of this one. What varies reaches them as variables and data.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "cli/output.h"

namespace tactus::cli {

/// Becomes the data block $name. An empty row separates two lines, as a blank line does in gnuplot, two of them two sets.
struct PlotData {
  std::string name;
  std::vector<std::vector<double>> rows;
};

struct Plot {
  std::string name;               ///< of the file
  std::string program;            ///< plots/PROGRAM.gp
  int width = 900, height = 560;  ///< [pixels]
  std::vector<PlotData> data{};
  std::string settings{};  ///< made by set()
  std::string title{};     ///< the text of the variable "heading"

  /// Variables of the program; arrays, which gnuplot counts from 1, are none where they are empty.
  void set(const std::string& variable, double value);
  void set(const std::string& variable, const std::vector<double>& values);
  /// Any text: gnuplot takes it as it is, in single quotes, where it substitutes nothing, as shown() has it and with U+2019 for every
  /// apostrophe. To be drawn as it is it wants `noenhanced` behind it.
  void set(const std::string& variable, std::string_view text);
  void set(const std::string& variable, const std::vector<std::string>& texts);

  /// All that gnuplot is given.   pre  there is such a program
  std::string script() const;
};

enum class Drawn : bool { no, yes };

/// err  the file of draw() is there and to be kept, or is one of those that the command also uses
Outcome check_plot(const Plot& plot, const std::string& directory, OutputFile::Existing existing,
                   std::initializer_list<std::string> others = {});

/// Write DIR/NAME.svg, which gnuplot makes of its standard input on its standard output: it opens no file.
/// out  Drawn::no: there is no gnuplot
/// err  the file cannot be written, or is there and to be kept; gnuplot refuses the script (its words are in the failure) or takes over
///      a minute
tl::expected<Drawn, Failure> draw(const Plot& plot, const std::string& directory, OutputFile::Existing existing);

/// What to tell when draw() said no.
inline constexpr const char* kNoGnuplot = "gnuplot is not installed: there are no figures (apt-get install gnuplot-nox)";

}  // namespace tactus::cli
