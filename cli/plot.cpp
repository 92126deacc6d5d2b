// SPDX-License-Identifier: Apache-2.0
#include "cli/plot.h"

#include <fmt/format.h>

#include <cmath>
#include <ostream>

#include <tactus/base/shown.h>
#include "cli/child_process.h"

namespace tactus::cli {
namespace {

constexpr const char* kPreamble = R"(set encoding utf8
set datafile missing 'NaN'
set border 3 linecolor rgb '#444444'
set tics nomirror out textcolor rgb '#222222'
set grid linecolor rgb '#d9d9d9' linewidth 0.6 dashtype solid
set key textcolor rgb '#222222' spacing 1.15
)";

constexpr std::chrono::seconds kLongestRun{60};
constexpr std::size_t kLongestText = 255;  // of a figure, as of a plan
constexpr std::size_t kMostOfWords = 300;  // of gnuplot's own, in a message

std::string number(double value) { return std::isfinite(value) ? fmt::format("{:.6g}", value) : "NaN"; }

std::string script_file(const Plot& plot, const std::string& directory) { return directory + "/" + plot.name + ".gp"; }

std::string script_of(const Plot& plot) {
  std::string out = fmt::format(
      "# SPDX-License-Identifier: Apache-2.0\n"
      "# gnuplot -c {0}.gp svg | png    makes {0}.svg or .png; a third word `-`: to standard output\n"
      "if (ARG1 eq 'png') {{ set terminal pngcairo size {1},{2} font 'sans,11' }}\n"
      "else {{ set terminal svg size {1},{2} font 'sans,13' background 'white' }}\n"
      "if (ARG2 ne '-') {{ set output {3}.'.'.ARG1 }}\n{4}",
      shown(plot.name), plot.width, plot.height, gnuplot_text(plot.name), kPreamble);
  for (std::size_t i = 0; i < std::size(kPlotColours); ++i)
    out += fmt::format("set linetype {} linecolor rgb '{}' linewidth 2 pointtype 7 pointsize 0.7\n", i + 1, kPlotColours[i]);
  for (const PlotData& block : plot.data) {
    out += fmt::format("${} << EOD\n", block.name);
    for (const auto& row : block.rows) {
      for (std::size_t i = 0; i < row.size(); ++i) out += (i == 0 ? "" : " ") + number(row[i]);
      out += '\n';
    }
    out += "EOD\n";
  }
  return out + plot.script;
}

}  // namespace

std::string gnuplot_text(std::string_view text) {
  // Doubled, as gnuplot wants an apostrophe, it ends the string all the same where two stand together or one in front.
  constexpr const char* kApostrophe = "\u2019";
  std::string out = "'";
  for (const char c : shown(text, kLongestText)) {
    if (c == '\'') out += kApostrophe;
    else out += c;
  }
  return out + '\'';
}

Outcome check_plot(const Plot& plot, const std::string& directory, OutputFile::Existing existing) {
  return OutputFile::check_free(script_file(plot, directory), existing);
}

tl::expected<Drawn, Failure> draw(const Plot& plot, const std::string& directory, OutputFile::Existing existing) {
  const std::string stem = directory + "/" + plot.name, script = plot.name + ".gp";
  TACTUS_CHECK(write_file(script_file(plot, directory), script_of(plot), existing));
  for (const char* kind : {"svg", "png"}) {
    const auto done = run_child({"gnuplot", "-d", "-c", script, kind, "-"}, directory, kLongestRun);
    if (!done && done.error() == std::errc::no_such_file_or_directory) return Drawn::no;
    const std::string remedy =
        fmt::format("Run it by hand: cd {} && gnuplot -c {} {}", shown_path(directory), shown(script), kind);
    if (!done && done.error() == std::errc::timed_out)
      return refuse(fmt::format("{}.gp: gnuplot did not end within {} s", shown_path(stem), kLongestRun.count()), remedy);
    if (!done) return refuse("gnuplot cannot be started: " + done.error().message(), "Check the installation.");
    if (done->status != 0)
      return refuse(fmt::format("{}.gp: gnuplot ended with status {}: {}", shown_path(stem), done->status,
                                shown(done->error, kMostOfWords)),
                    remedy);
    TACTUS_CHECK(write_file(stem + "." + kind, done->out, OutputFile::Existing::replace));
  }
  return Drawn::yes;
}

}  // namespace tactus::cli
