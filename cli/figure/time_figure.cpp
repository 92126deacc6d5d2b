// SPDX-License-Identifier: Apache-2.0
#include "cli/figure/time_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <tactus/base/shown.h>

namespace tactus::cli {
namespace {

/// From the lowest to the highest of what is drawn, with room above; a quantity that is never negative begins at 0.
std::string range_of(const TimePanel& panel) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  const auto reach = [&](double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  };
  for (const TimePanel::Line& line : panel.lines)
    for (const auto& point : line.points) reach(point.back());
  reach(panel.bound);
  if (!(low <= high)) return "[0:1]";
  if (low >= 0) low = 0;
  const double room = high > low ? 0.06 * (high - low) : 1;
  return fmt::format("[{:.6g}:{:.6g}]", low < 0 ? low - room : 0, high + room);
}

Plot figure(const std::string& heading, const std::vector<TimePanel>& panels) {
  Plot plot{.name = {}, .program = "time", .height = static_cast<int>(90 + 195 * panels.size())};
  PlotData data{"data", {}};
  std::vector<std::string> labels, ranges, names;
  std::vector<double> first, lines, bounds;
  double end = 0;
  for (const TimePanel& panel : panels) {
    labels.push_back(panel.label);
    ranges.push_back(range_of(panel));
    first.push_back(static_cast<double>(names.size()));
    lines.push_back(static_cast<double>(panel.lines.size()));
    bounds.push_back(panel.bound);
    for (const TimePanel::Line& line : panel.lines) {
      if (!names.empty()) data.rows.insert(data.rows.end(), 2, {});
      data.rows.insert(data.rows.end(), line.points.begin(), line.points.end());
      names.push_back(line.name);
      if (!line.points.empty()) end = std::max(end, line.points.back().front());
    }
  }
  plot.data.push_back(std::move(data));
  plot.set("heading", heading);
  plot.set("panels", static_cast<double>(panels.size()));
  plot.set("time_end", end > 0 ? end : 1);
  plot.set("y_label", labels);
  plot.set("y_range", ranges);
  plot.set("first", first);
  plot.set("lines", lines);
  plot.set("bound", bounds);
  plot.set("name", names);
  return plot;
}

}  // namespace

void TimeLine::add(double time, double value) {
  const Sample sample{time, value};
  if (in_last_ == per_piece_ || pieces_.empty()) {
    if (pieces_.size() == kMost) {
      for (std::size_t i = 0; i < kMost / 2; ++i) {
        const Piece &a = pieces_[2 * i], &b = pieces_[2 * i + 1];
        pieces_[i] = {a.low.value <= b.low.value ? a.low : b.low, a.high.value >= b.high.value ? a.high : b.high};
      }
      pieces_.resize(kMost / 2);
      per_piece_ *= 2;
    }
    pieces_.push_back({sample, sample});
    in_last_ = 0;
  }
  ++in_last_;
  Piece& last = pieces_.back();
  if (value < last.low.value) last.low = sample;
  if (value > last.high.value) last.high = sample;
}

std::vector<std::vector<double>> TimeLine::points() const {
  std::vector<std::vector<double>> out;
  for (const Piece& piece : pieces_) {
    const auto& [a, b] = piece.low.time <= piece.high.time ? std::pair(piece.low, piece.high) : std::pair(piece.high, piece.low);
    out.push_back({a.time, a.value});
    if (b.time > a.time) out.push_back({b.time, b.value});
  }
  return out;
}

std::vector<std::vector<double>> RateLine::points(double width, double end) const {
  std::vector<double> sums(static_cast<std::size_t>(end / width) + 1);
  for (const auto& [time, amount] : events_) sums[std::min(static_cast<std::size_t>(time / width), sums.size() - 1)] += amount;
  std::vector<std::vector<double>> out;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const double from = width * static_cast<double>(i), to = std::min(from + width, end);
    if (to - from < 0.5 * width && i > 0) break;  // too short for a rate
    out.push_back({from, sums[i] / (to - from)});
    out.push_back({to, sums[i] / (to - from)});
  }
  return out;
}

double width_of_rates(double duration) {
  const double wanted = std::max(duration, 1e-3) / 60, power = std::pow(10, std::floor(std::log10(wanted)));
  for (const double digit : {1.0, 2.0, 5.0})
    if (digit * power >= wanted * (1 - 1e-9)) return digit * power;
  return 10 * power;
}

Outcome draw_over_time(const std::string& path, const std::string& heading, const std::vector<TimePanel>& panels,
                       const CommonOptions& common) {
  if (path.empty()) return {};
  std::vector<TimePanel> drawn;
  for (const TimePanel& panel : panels)
    if (!panel.lines.empty()) drawn.push_back(panel);
  if (drawn.empty())
    return refuse(shown_path(path) + ": there is nothing to draw", "Give a recording with something that moves.");
  return draw_at(path, figure(heading, drawn), common);
}

}  // namespace tactus::cli
