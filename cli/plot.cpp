// SPDX-License-Identifier: Apache-2.0
#include "cli/plot.h"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <ostream>
#include <system_error>

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

/// Exit status of `gnuplot -c SCRIPT KIND` run in `directory`; errno when it could not be started.
tl::expected<int, int> run_gnuplot(const std::string& directory, std::string script, std::string kind) {
  std::string program = "gnuplot", option = "-c";
  std::array<char*, 5> arguments{program.data(), option.data(), script.data(), kind.data(), nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, directory.c_str());
  pid_t child = 0;
  const int failed = posix_spawnp(&child, program.c_str(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) return tl::unexpected(failed);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

}  // namespace

tl::expected<Drawn, Failure> draw(const Plot& plot, const std::string& directory, OutputFile::Existing existing) {
  auto file = OutputFile::create(directory + "/" + plot.name + ".gp", existing);
  if (!file) return tl::unexpected(file.error());
  const auto out = file->open();
  if (!out) return tl::unexpected(out.error());
  **out << script_of(plot);
  if (const auto kept = file->keep(); !kept) return tl::unexpected(kept.error());
  for (const char* kind : {"svg", "png"}) {
    const auto status = run_gnuplot(directory, plot.name + ".gp", kind);
    if (!status && status.error() == ENOENT) return Drawn::no;
    if (!status)
      return refuse("gnuplot cannot be started: " + std::generic_category().message(status.error()), "Check the installation.");
    if (*status != 0)
      return refuse(fmt::format("{}: gnuplot ended with status {}", file->path(), *status),
                    fmt::format("Run it by hand: cd {} && gnuplot -c {}.gp {}", directory, plot.name, kind));
  }
  return Drawn::yes;
}

}  // namespace tactus::cli
