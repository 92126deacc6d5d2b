// SPDX-License-Identifier: Apache-2.0
/// What moves in a recording, and the forces on it, over time; and the packets that it took, if any.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <tactus/trace/frame.h>
#include "cli/figure/time_figure.h"

namespace tactus::cli {

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
    TimeLine felt{}, server{};
    bool differ = false;  // felt and server
  };

  double time_of(std::int64_t tick) const { return static_cast<double>(tick) / info_.tick_rate; }
  static void add(ObjectLines& lines, const RigidSample& sample, double time);
  static void add(UserLines& lines, const UserSample& user, double time);
  static std::vector<Panel::Line> force_lines(const UserLines& of, KnownForces known);

  TraceInfo info_;
  std::vector<ObjectLines> objects_;
  std::vector<UserLines> users_;
  std::vector<TimeLine> meshes_;
  RateLine packets_, kilobits_;
  double end_ = 0;
};

}  // namespace tactus::cli
