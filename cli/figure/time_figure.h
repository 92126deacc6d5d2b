// SPDX-License-Identifier: Apache-2.0
/// Figures of recordings over time: lines of which any length fits a picture; what moves; what a client shows beside the truth.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <tactus/base/geometry.h>
#include <tactus/trace/frame.h>
#include "cli/figure/figure.h"
#include "cli/report/report.h"

namespace tactus::cli {

/// A quantity over time, of which a figure shows the extremes: it keeps at most kMost pieces, however long the recording.
class TimeLine {
 public:
  static constexpr std::size_t kMost = 1500;

  /// pre  `time` is not before the last
  void add(double time, double value);
  bool is_empty() const noexcept { return pieces_.empty(); }
  /// Time and value; of a piece with several samples its least and its largest one, in the order in which they came.
  std::vector<Point> points() const;

 private:
  struct Sample {
    double time, value;
  };
  struct Piece {
    Sample low, high;
  };

  std::vector<Piece> pieces_;
  std::uint64_t per_piece_ = 1, in_last_ = 0;  // samples
};

/// Packets over time, as a rate.
class RateLine {
 public:
  void add(double time, double amount = 1) { events_.emplace_back(time, amount); }
  bool is_empty() const noexcept { return events_.empty(); }
  /// Steps of amount per second, in `width` s each.   pre  width > 0
  std::vector<Point> points(double width, double end) const;

 private:
  std::vector<std::pair<double, double>> events_;
};

/// [s] 1, 2 or 5 times a power of ten, so that some 60 of them fill the duration.
double width_of_rates(double duration);

/// What moves in a recording, and the forces on it, over time; and the packets that it took, if any.
class MotionFigure {
 public:
  explicit MotionFigure(const TraceInfo& info);

  void add(const TraceFrame& frame);
  void add_packet(std::int64_t tick, std::size_t bytes);
  std::vector<Panel> panels() const;

 private:
  struct ObjectLines {
    std::size_t object;
    std::array<TimeLine, 3> position{};
    TimeLine speed{};
    bool has_speed = false;  // what a client shows has none
  };
  struct UserLines {
    std::array<TimeLine, 3> device{};
    TimeLine rendered{}, server{};
    bool differ = false;  // rendered and server
  };

  double time_of(std::int64_t tick) const { return static_cast<double>(tick) / info_.tick_rate; }
  static void add(ObjectLines& lines, const RigidSample& sample, double time);
  static void add(UserLines& lines, const UserSample& user, double time);
  static std::vector<Panel::Line> force_lines(const UserLines& of, RecordedForces known);

  TraceInfo info_;
  std::vector<ObjectLines> objects_;
  std::vector<UserLines> users_;
  std::vector<TimeLine> meshes_;
  RateLine packets_, kilobits_;
  double end_ = 0;
};

/// What a client sees and feels beside the truth, over time, and the packets that it took.
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
