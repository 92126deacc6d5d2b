// SPDX-License-Identifier: Apache-2.0
/// What a client sees and feels beside the truth, over time, and the packets that it took.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include <tactus/base/geometry.h>
#include "cli/figure/time_figure.h"
#include "cli/report/report.h"

namespace tactus::cli {

class ErrorFigure {
 public:
  explicit ErrorFigure(const TraceInfo& info);

  /// in   shown  one pose per object
  void add(const TraceFrame& truth, std::span<const Pose> shown);
  /// A new shape of a mesh.   in  shown  V x 3 [m], or on the grid of 2^-position_exp m
  void add_shape(const TraceFrame& truth, std::size_t mesh, std::span<const float> shown);
  void add_shape(const TraceFrame& truth, std::size_t mesh, std::span<const std::array<std::int32_t, 3>> shown,
                 unsigned position_exp);
  /// in   line  that the figure counts it in: "haptic"
  void add_packet(std::int64_t tick, const std::string& line, std::size_t bytes);

  /// With the bounds that the report was judged by.
  std::vector<Panel> panels(const Report& report) const;

 private:
  double time_of(std::int64_t tick) const { return static_cast<double>(tick) / info_.tick_rate; }
  void add_force_panels(const Report& report, std::vector<Panel>& out) const;
  void add_forces(const TraceFrame& truth, std::span<const Pose> shown, double time);

  TraceInfo info_;
  std::vector<std::size_t> moving_;  // objects
  TimeLine position_, rotation_, force_, force_error_;
  bool touches_ = false;
  std::vector<TimeLine> meshes_;
  std::map<std::string, RateLine> packets_;
  RateLine bytes_;
  double end_ = 0;
};

}  // namespace tactus::cli
