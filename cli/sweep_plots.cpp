// SPDX-License-Identifier: Apache-2.0
#include "cli/sweep_plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "cli/plot.h"

namespace tactus::cli {
namespace {

/// "0.05", "2.5%", "5mm,4deg": the number that a cell begins with.
double leading_number(const std::string& cell) {
  double value = 0;
  const auto end = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  return end.ec == std::errc() ? value : std::numeric_limits<double>::quiet_NaN();
}

std::size_t index_of(const std::vector<std::string>& columns, const std::string& name) {
  return static_cast<std::size_t>(std::find(columns.begin(), columns.end(), name) - columns.begin());
}

/// One data block for each value of the series, in the order in which they first appear.
struct Series {
  std::string value;
  std::vector<std::vector<double>> points;
};

std::vector<Series> series_of(const SweepPlot& wanted, const SweepPlan& plan, const std::vector<SweepResults::Row>& rows) {
  const auto columns = plan.columns();
  const std::size_t x = index_of(columns, wanted.x), by = index_of(columns, wanted.series);
  std::vector<Series> out;
  for (const SweepResults::Row& row : rows) {
    const bool shown = std::all_of(wanted.where.begin(), wanted.where.end(),
                                   [&](const auto& rule) { return row[index_of(columns, rule.first)] == rule.second; });
    if (!shown) continue;
    auto found = std::find_if(out.begin(), out.end(), [&](const Series& s) { return s.value == row[by]; });
    if (found == out.end()) found = out.insert(out.end(), {row[by], {}});
    std::vector<double>& point = found->points.emplace_back(std::vector<double>{leading_number(row[x])});
    for (const std::string& y : wanted.y) point.push_back(leading_number(row[index_of(columns, y)]));
  }
  for (Series& series : out) std::sort(series.points.begin(), series.points.end());
  return out;
}

/// gnuplot refuses an axis without a value that it can show, and a logarithmic one with a single value: the range to set for it.
std::string range_of(const char* axis, bool is_log, std::size_t column, const std::vector<Series>& series) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Series& one : series)
    for (const auto& point : one.points) {
      if (!std::isfinite(point[column]) || (is_log && point[column] <= 0)) continue;
      low = std::min(low, point[column]);
      high = std::max(high, point[column]);
    }
  if (low < high) return fmt::format("set {}range [*:*]\n", axis);
  if (low > high) return fmt::format("set {}range [1:10]\n", axis);
  const double room = low == 0 ? 1 : 0.1 * std::abs(low);
  return fmt::format("set {}range [{:.6g}:{:.6g}]\n", axis, low - room, low + room);
}

Plot figure(const SweepPlot& wanted, const std::vector<Series>& series) {
  const std::size_t panels = wanted.y.size();
  Plot plot{.name = wanted.name, .script = {}, .data = {}};
  plot.height = static_cast<int>(panels == 1 ? 560 : 80 + 300 * panels);
  for (std::size_t i = 0; i < series.size(); ++i) plot.data.push_back({"series" + std::to_string(i), series[i].points});
  if (wanted.log_x) plot.script += "set logscale x\nset format x '10^{%L}'\n";
  if (wanted.log_y) plot.script += "set logscale y\nset format y '10^{%L}'\n";
  plot.script += fmt::format("set key outside {} title {} noenhanced\n", panels == 1 ? "right top" : "center top horizontal",
                             gnuplot_text(wanted.series));
  plot.script += panels == 1 ? fmt::format("set title {} noenhanced\n", gnuplot_text(wanted.title))
                             : fmt::format("set lmargin 11\nset multiplot layout {},1 title {} noenhanced\n", panels,
                                           gnuplot_text(wanted.title));
  plot.script += range_of("x", wanted.log_x, 0, series);
  for (std::size_t panel = 0; panel < panels; ++panel) {
    plot.script += range_of("y", wanted.log_y, panel + 1, series);
    if (panel == 1) plot.script += "unset key\n";
    if (panel + 1 == panels) plot.script += fmt::format("set xlabel {} noenhanced\n", gnuplot_text(wanted.x_label));
    plot.script += fmt::format("set ylabel {} noenhanced\n", gnuplot_text(wanted.y_label[panel]));
    for (std::size_t i = 0; i < series.size(); ++i)
      plot.script += fmt::format("{}$series{} using 1:{} with linespoints linetype {} title {} noenhanced",
                                 i == 0 ? "plot " : ", \\\n     ", i, panel + 2, i + 1, gnuplot_text(series[i].value));
    plot.script += series.empty() ? "plot NaN notitle\n" : "\n";
  }
  if (panels > 1) plot.script += "unset multiplot\n";
  return plot;
}

}  // namespace

tl::expected<std::vector<std::string>, Failure> draw_plots(const SweepPlan& plan, const SweepResults& results) {
  const auto rows = results.rows(plan);
  std::vector<std::string> files;
  for (const SweepPlot& wanted : plan.plots) {
    TACTUS_TRY(const auto drawn,
               draw(figure(wanted, series_of(wanted, plan, rows)), results.folder(), OutputFile::Existing::replace));
    const std::string stem = results.folder() + "/" + wanted.name;
    files.push_back(stem + ".gp");
    if (drawn == Drawn::yes) files.insert(files.end(), {stem + ".svg", stem + ".png"});
  }
  return files;
}

}  // namespace tactus::cli
