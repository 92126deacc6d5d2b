// SPDX-License-Identifier: Apache-2.0
#include "cli/figure/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include <tactus/base/shown.h>
#include "cli/figure/child_process.h"

namespace tactus::cli {
namespace {

struct Program {
  std::string_view name, text;
};
constexpr Program kPrograms[] = {
#include "plots.inc"
};

constexpr std::chrono::seconds kLongestRun{60};
constexpr std::size_t kLongestText = 255;  // of a figure, as of a plan
constexpr std::size_t kMostOfWords = 300;  // of gnuplot's own, in a message

std::string_view text_of_program(std::string_view name) {
  return std::find_if(std::begin(kPrograms), std::end(kPrograms), [&](const Program& p) { return p.name == name; })->text;
}

std::string in_gnuplot(double value) { return std::isfinite(value) ? fmt::format("{:.6g}", value) : "NaN"; }

std::string in_gnuplot(std::string_view text) {
  // gnuplot's escape '' fails for two adjacent apostrophes and for one at the start of the string.
  constexpr const char* kApostrophe = "\u2019";
  std::string out = "'";
  for (const char c : shown(text, kLongestText)) {
    if (c == '\'') out += kApostrophe;
    else out += c;
  }
  return out + '\'';
}

template <class Value>
std::string array(const std::string& name, const std::vector<Value>& values) {
  if (values.empty()) return {};
  std::string list;
  for (const Value& value : values) list += (list.empty() ? "" : ", ") + in_gnuplot(value);
  return fmt::format("array {}[{}] = [{}]\n", name, values.size(), list);
}

/// The figure with its heading as the title that readers of screens tell; gnuplot writes its own name.
std::string titled(std::string svg, const std::string& title) {
  constexpr std::string_view kOwn = "<title>Gnuplot</title>";
  const std::size_t at = svg.find(kOwn);
  if (at == std::string::npos) return svg;
  std::string text;
  for (const char c : title) {
    if (c == '&') text += "&amp;";
    else if (c == '<') text += "&lt;";
    else text += c;
  }
  return svg.replace(at, kOwn.size(), "<title>" + text + "</title>");
}

std::string file_of(const Plot& plot, const std::string& directory) { return directory + "/" + plot.name + ".svg"; }

}  // namespace

void Plot::set(const std::string& variable, double value) { settings += variable + " = " + in_gnuplot(value) + '\n'; }
void Plot::set(const std::string& variable, std::string_view text) {
  settings += variable + " = " + in_gnuplot(text) + '\n';
  if (variable == "heading") title = shown(text, kLongestText);
}
void Plot::set(const std::string& variable, const std::vector<double>& values) { settings += array(variable, values); }
void Plot::set(const std::string& variable, const std::vector<std::string>& texts) { settings += array(variable, texts); }

std::string Plot::script() const {
  std::string out = fmt::format("width = {}\nheight = {}\n{}", width, height, settings);
  for (const PlotData& block : data) {
    out += fmt::format("${} << EOD\n", block.name);
    for (const auto& row : block.rows) {
      for (std::size_t i = 0; i < row.size(); ++i) out += (i == 0 ? "" : " ") + in_gnuplot(row[i]);
      out += '\n';
    }
    out += "EOD\n";
  }
  return out.append(text_of_program("style")).append(text_of_program(program));
}

Outcome check_plot(const Plot& plot, const std::string& directory, OutputFile::Existing existing,
                   std::initializer_list<std::string> others) {
  return OutputFile::check_free(file_of(plot, directory), existing, others);
}

tl::expected<Drawn, Failure> draw(const Plot& plot, const std::string& directory, OutputFile::Existing existing) {
  TACTUS_CHECK(check_plot(plot, directory, existing));
  const std::string figure = shown_path(file_of(plot, directory)), remedy = "Check the installation of gnuplot.";
  auto done = run_child({"gnuplot", "-d", "/dev/stdin"}, plot.script(), kLongestRun);
  if (!done && done.error() == std::errc::no_such_file_or_directory) return Drawn::no;
  if (!done && done.error() == std::errc::timed_out)
    return refuse(fmt::format("{}: gnuplot did not end within {} s", figure, kLongestRun.count()), remedy);
  if (!done) return refuse("gnuplot cannot be started: " + done.error().message(), remedy);
  if (done->status != 0)
    return refuse(fmt::format("{}: gnuplot ended with status {}: {}", figure, done->status, shown(done->error, kMostOfWords)),
                  remedy);
  TACTUS_CHECK(write_file(file_of(plot, directory), titled(std::move(done->out), plot.title), existing));
  return Drawn::yes;
}

}  // namespace tactus::cli
