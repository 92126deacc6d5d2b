// SPDX-License-Identifier: Apache-2.0
#include "cli/laboratory/sweep_plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include <tactus/base/shown.h>
#include "cli/figure/plot.h"
#include "cli/laboratory/sweep_table.h"

namespace tactus::cli {
namespace {

std::size_t index_of(const std::vector<std::string>& columns, const std::string& name) {
  return static_cast<std::size_t>(std::find(columns.begin(), columns.end(), name) - columns.begin());
}

/// One data block for each value of the series, in the order in which they first appear.
struct Series {
  std::string value;
  std::vector<std::vector<double>> points;  ///< x, then median, min and max of each y
};

bool is_shown(const SweepPlot& wanted, const std::vector<std::string>& columns, const SweepGroup& group) {
  return std::ranges::all_of(wanted.where,
                             [&](const auto& rule) { return group.texts[index_of(columns, rule.first)] == rule.second; });
}

std::vector<Series> series_of(const SweepPlot& wanted, const SweepPlan& plan, const std::vector<SweepGroup>& groups) {
  const auto columns = plan.all_columns();
  const std::size_t x = index_of(columns, wanted.x), by = index_of(columns, wanted.series);
  std::vector<Series> out;
  for (const SweepGroup& group : groups) {
    if (!is_shown(wanted, columns, group)) continue;
    auto found = std::ranges::find(out, group.texts[by], &Series::value);
    if (found == out.end()) found = out.insert(out.end(), {group.texts[by], {}});
    std::vector<double>& point = found->points.emplace_back(std::vector<double>{spread_of(group.numbers[x]).median});
    for (const std::string& y : wanted.y) {
      const Spread spread = spread_of(group.numbers[index_of(columns, y)]);
      point.insert(point.end(), {spread.median, spread.min, spread.max});
    }
  }
  for (Series& series : out) std::sort(series.points.begin(), series.points.end());
  return out;
}

struct Ends {
  double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
};

/// Of what an axis can show of these columns; low > high: nothing.
Ends ends_of(bool is_log, std::size_t column, std::size_t columns, const std::vector<Series>& series) {
  Ends out;
  for (const Series& one : series)
    for (const auto& point : one.points)
      for (std::size_t i = column; i < column + columns; ++i) {
        if (!std::isfinite(point[i]) || (is_log && point[i] <= 0)) continue;
        out.low = std::min(out.low, point[i]);
        out.high = std::max(out.high, point[i]);
      }
  return out;
}

/// The range of an axis that shows these columns, and little else: "[low:high]". gnuplot refuses an axis without a value that it can
/// show, and widens a logarithmic one to whole decades.
std::string range_of(bool is_log, Ends ends) {
  const auto [low, high] = ends;
  if (low > high) return "[1:10]";
  if (low == high) {
    const double room = low == 0 ? 1 : 0.1 * std::abs(low);
    return fmt::format("[{:.6g}:{:.6g}]", low - room, low + room);
  }
  if (!is_log) return low >= 0 && low < high / 2 ? "[0:*]" : "[*:*]";
  const double room = std::pow(high / low, 0.05);
  return fmt::format("[{:.6g}:{:.6g}]", low / room, high * room);
}

/// 1: numbers at whole decades are enough, 2: they are not.
double scale_of(bool is_log, Ends ends) {
  constexpr double kFewDecades = 200;
  return !is_log ? 0 : ends.high / ends.low < kFewDecades ? 2 : 1;
}

Plot figure(const SweepPlot& wanted, const std::vector<Series>& series, bool has_spread) {
  const std::size_t panels = wanted.y.size();
  Plot plot{.name = wanted.name, .program = "sweep", .height = static_cast<int>(panels == 1 ? 560 : 80 + 300 * panels)};
  PlotData data{"data", {}};
  std::vector<std::string> names, ranges;
  for (const Series& one : series) {
    if (!names.empty()) data.rows.insert(data.rows.end(), 2, {});
    data.rows.insert(data.rows.end(), one.points.begin(), one.points.end());
    const auto named = wanted.names.find(one.value);
    names.push_back(named == wanted.names.end() ? one.value : named->second);
  }
  double log_y = wanted.log_y ? 2 : 0;
  for (std::size_t panel = 0; panel < panels; ++panel) {
    const Ends ends = ends_of(wanted.log_y, 3 * panel + 1, 3, series);
    ranges.push_back(range_of(wanted.log_y, ends));
    log_y = std::min(log_y, scale_of(wanted.log_y, ends));
  }
  const Ends x_ends = ends_of(wanted.log_x, 0, 1, series);
  plot.data.push_back(std::move(data));
  plot.set("heading", wanted.title);
  plot.set("series_label", series.size() == 1 ? "" : wanted.series_label);
  plot.set("x_label", wanted.x_label);
  plot.set("x_range", range_of(wanted.log_x, x_ends));
  plot.set("log_x", scale_of(wanted.log_x, x_ends));
  plot.set("log_y", log_y);
  plot.set("spread", has_spread ? 1 : 0);
  plot.set("marked", 1);
  plot.set("panels", static_cast<double>(panels));
  plot.set("y_label", wanted.y_label);
  plot.set("y_range", ranges);
  plot.set("series", static_cast<double>(series.size()));
  plot.set("name", names);
  return plot;
}

/// The hosts whose times a figure would show side by side.
std::set<std::string> hosts_of(const SweepPlot& wanted, const SweepPlan& plan, const std::vector<SweepGroup>& groups) {
  std::set<std::string> timed{kSecondsColumn}, hosts;
  for (const SweepMeasure& time : plan.times) timed.insert(time.column);
  for (const SweepDerived& derived : plan.derived)
    if (derived.from_times) timed.insert(derived.column);
  if (!timed.contains(wanted.x) && std::ranges::none_of(wanted.y, [&](const std::string& y) { return timed.contains(y); }))
    return hosts;
  const auto columns = plan.all_columns();
  for (const SweepGroup& group : groups)
    if (is_shown(wanted, columns, group)) hosts.insert(group.texts[index_of(columns, kHostColumn)]);
  return hosts;
}

}  // namespace

tl::expected<DrawnPlots, Failure> draw_plots(const SweepPlan& plan, const SweepResults& results) {
  const auto groups = groups_of(plan, results);
  DrawnPlots out;
  for (const SweepPlot& wanted : plan.plots) {
    if (const auto hosts = hosts_of(wanted, plan, groups); hosts.size() > 1) {
      out.notes.push_back(fmt::format("{}.svg: not drawn, because it would compare times of different machines: {}", wanted.name,
                                      shown(fmt::format("{}", fmt::join(hosts, ", ")))));
      continue;
    }
    TACTUS_TRY(const auto drawn, draw(figure(wanted, series_of(wanted, plan, groups), plan.repeats), results.folder(),
                                      OutputFile::Existing::replace));
    if (drawn == Drawn::yes) out.files.push_back(results.folder() + "/" + wanted.name + ".svg");
    else {
      out.notes.emplace_back(kNoGnuplot);
      return out;
    }
  }
  return out;
}

}  // namespace tactus::cli
