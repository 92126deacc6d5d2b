// SPDX-License-Identifier: Apache-2.0
#include "cli/plot.h"

#include <fmt/format.h>

#include <cmath>
#include <ostream>

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

std::string number(double value) { return std::isfinite(value) ? fmt::format("{:.6g}", value) : "NaN"; }

std::string script_file(const Plot& plot, const std::string& directory) { return directory + "/" + plot.name + ".gp"; }

std::string script_of(const Plot& plot) {
  std::string out = fmt::format(
      "# SPDX-License-Identifier: Apache-2.0\n"
      "# gnuplot -c {0}.gp svg | png\n"
      "if (ARG1 eq 'png') {{ set terminal pngcairo size {1},{2} font 'sans,11'; set output '{0}.png' }}\n"
      "else {{ set terminal svg size {1},{2} font 'sans,13' background 'white'; set output '{0}.svg' }}\n{3}",
      plot.name, plot.width, plot.height, kPreamble);
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

Outcome check_plot(const Plot& plot, const std::string& directory, OutputFile::Existing existing) {
  return OutputFile::check_free(script_file(plot, directory), existing);
}

tl::expected<Drawn, Failure> draw(const Plot& plot, const std::string& directory, OutputFile::Existing existing) {
  auto file = OutputFile::create(script_file(plot, directory), existing);
  if (!file) return tl::unexpected(file.error());
  const auto out = file->open();
  if (!out) return tl::unexpected(out.error());
  **out << script_of(plot);
  if (const auto kept = file->keep(); !kept) return tl::unexpected(kept.error());
  for (const char* kind : {"svg", "png"}) {
    const std::string script = plot.name + ".gp";
    const auto done = run_child({"gnuplot", "-c", script, kind}, directory);
    if (!done && done.error() == std::errc::no_such_file_or_directory) return Drawn::no;
    if (!done) return refuse("gnuplot cannot be started: " + done.error().message(), "Check the installation.");
    if (done->status != 0)
      return refuse(fmt::format("{}: gnuplot ended with status {}: {}", file->path(), done->status, done->error),
                    fmt::format("Run it by hand: cd {} && gnuplot -c {} {}", directory, script, kind));
  }
  return Drawn::yes;
}

}  // namespace tactus::cli
