// SPDX-License-Identifier: Apache-2.0
/// Figures of commands.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "cli/figure/time_figure.h"

namespace tactus::cli {
namespace {

// ==== motion figure ====

using Names = std::vector<std::string>;

/// Names of the lines of a user's forces.
Names lines_of(RecordedForces known, const Vec3& rendered, const Vec3& server) {
  MotionFigure figure({.objects = {}, .users = {{.name = "hand", .forces = known}}, .source = {}, .scene = {}});
  TraceFrame frame{.objects = {}, .users = {{}}};
  frame.users[0].force = rendered;
  frame.users[0].server_force = server;
  figure.add(frame);
  Names out;
  for (const Panel& panel : figure.panels())
    if (panel.label == "force on hand [N]")
      for (const Panel::Line& line : panel.lines) out.push_back(line.name);
  return out;
}

TEST(MotionFigure, NamesAForceAfterWhoseItIs) {
  const Vec3 some{0, 0, 1}, none;
  EXPECT_EQ(lines_of(RecordedForces::both, some, some), Names{"force"});
  EXPECT_EQ(lines_of(RecordedForces::both, some, none), (Names{"rendered", "of the server"}));
  EXPECT_EQ(lines_of(RecordedForces::rendered, some, none), Names{"rendered"});
  EXPECT_EQ(lines_of(RecordedForces::server, some, some), Names{"of the server"});
}

// ==== time figure ====

TEST(TimeLine, KeepsEverySampleOfAShortRecording) {
  TimeLine line;
  for (int i = 0; i < 100; ++i) line.add(0.1 * i, i % 7);
  const auto points = line.points();
  ASSERT_EQ(points.size(), 100u);
  EXPECT_EQ(points[10], (Point{1.0, 3}));
}

TEST(TimeLine, KeepsTheExtremesOfALongOne) {
  constexpr int kSamples = 1000003;
  TimeLine line;
  for (int i = 0; i < kSamples; ++i) line.add(1e-3 * i, i == 123456 ? 50 : i == 987654 ? -70 : std::sin(1e-2 * i));
  const auto points = line.points();
  EXPECT_LE(points.size(), 2 * TimeLine::kMost);
  EXPECT_GE(points.size(), TimeLine::kMost / 2);
  EXPECT_TRUE(std::ranges::is_sorted(points, {}, [](const auto& point) { return point[0]; }));
  const auto has = [&](double time, double value) { return std::ranges::find(points, Point{time, value}) != points.end(); };
  EXPECT_TRUE(has(1e-3 * 123456, 50));
  EXPECT_TRUE(has(1e-3 * 987654, -70));
  EXPECT_LT(points.front()[0], 2.0);
  EXPECT_GT(points.back()[0], 1e-3 * kSamples - 2.0);
}

TEST(RateLine, CountsPerSecond) {
  RateLine line;
  for (const double time : {0.1, 0.2, 0.3, 1.7, 2.05}) line.add(time, 2);
  const auto points = line.points(0.5, 2.1);
  const std::vector<Point> wanted{{0, 12}, {0.5, 12}, {0.5, 0}, {1, 0}, {1, 0}, {1.5, 0}, {1.5, 4}, {2, 4}};
  EXPECT_EQ(points, wanted) << "the last 0.1 s are too short for a rate";
  EXPECT_EQ(line.points(1, 0).size(), 2u) << "a recording of one tick";
}

TEST(RateLine, TakesRoundWidths) {
  EXPECT_EQ(width_of_rates(60), 1);
  EXPECT_EQ(width_of_rates(61), 2);
  EXPECT_DOUBLE_EQ(width_of_rates(19.5), 0.5);
  EXPECT_DOUBLE_EQ(width_of_rates(3600 * 6), 500);
  EXPECT_GT(width_of_rates(0), 0);
}

}  // namespace
}  // namespace tactus::cli
