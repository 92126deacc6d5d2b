// SPDX-License-Identifier: Apache-2.0
#include "cli/laboratory/sweep_plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "cli/laboratory/plot.h"

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

/// gnuplot refuses an axis without a value that it can show, and a logarithmic one with a single value: the range to set for it, "[low:high]".
std::string range_of(bool is_log, std::size_t column, const std::vector<Series>& series) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Series& one : series)
    for (const auto& point : one.points) {
      if (!std::isfinite(point[column]) || (is_log && point[column] <= 0)) continue;
      low = std::min(low, point[column]);
      high = std::max(high, point[column]);
    }
  if (low < high) return "[*:*]";
  if (low > high) return "[1:10]";
  const double room = low == 0 ? 1 : 0.1 * std::abs(low);
  return fmt::format("[{:.6g}:{:.6g}]", low - room, low + room);
}

Plot figure(const SweepPlot& wanted, const std::vector<Series>& series) {
  const std::size_t panels = wanted.y.size();
  Plot plot{.name = wanted.name, .program = "sweep", .height = static_cast<int>(panels == 1 ? 560 : 80 + 300 * panels)};
  PlotData data{"data", {}};
  std::vector<std::string> names, ranges;
  for (const Series& one : series) {
    if (!names.empty()) data.rows.insert(data.rows.end(), 2, {});
    data.rows.insert(data.rows.end(), one.points.begin(), one.points.end());
    names.push_back(one.value);
  }
  for (std::size_t panel = 0; panel < panels; ++panel) ranges.push_back(range_of(wanted.log_y, panel + 1, series));
  plot.data.push_back(std::move(data));
  plot.set("heading", wanted.title);
  plot.set("series_label", wanted.series);
  plot.set("x_label", wanted.x_label);
  plot.set("x_range", range_of(wanted.log_x, 0, series));
  plot.set("log_x", wanted.log_x ? 1 : 0);
  plot.set("log_y", wanted.log_y ? 1 : 0);
  plot.set("panels", static_cast<double>(panels));
  plot.set("y_label", wanted.y_label);
  plot.set("y_range", ranges);
  plot.set("series", static_cast<double>(series.size()));
  plot.set("name", names);
  return plot;
}

}  // namespace

tl::expected<std::vector<std::string>, Failure> draw_plots(const SweepPlan& plan, const SweepResults& results) {
  const auto rows = results.rows(plan);
  std::vector<std::string> files;
  for (const SweepPlot& wanted : plan.plots) {
    TACTUS_TRY(const auto drawn,
               draw(figure(wanted, series_of(wanted, plan, rows)), results.folder(), OutputFile::Existing::replace));
    if (drawn == Drawn::yes) files.push_back(results.folder() + "/" + wanted.name + ".svg");
  }
  return files;
}

}  // namespace tactus::cli
