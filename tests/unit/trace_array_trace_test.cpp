// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/array_trace.h>

#include <cmath>
#include <limits>

#include "tests/unit/trace_fixture.h"

namespace tactus {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::vector<TraceFrame> frames_of(const std::string& path) {
  auto reader = TraceReader::open(path);
  std::vector<TraceFrame> out;
  TraceFrame frame;
  while (reader && reader->next(frame).value_or(false)) out.push_back(frame);
  return out;
}

TEST(ArrayTrace, TakesRowsOnAGridAsTheyAre) {
  const std::vector<std::int64_t> time{5'000'000, 7'000'000, 9'000'000, 11'000'000};
  const std::vector<double> position{0, 0, 0, 0.1, 0, 0, 0.3, 0, 0, 0.3, 0, 1};
  const std::vector<double> rotation{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1};
  const TempFile file;
  ReadNotes notes;
  const auto ticks =
      write_arrays({.time = time, .objects = {{.name = "cup", .position = position, .rotation = rotation}}}, file.path(), notes);
  ASSERT_TRUE(ticks);
  EXPECT_EQ(ticks->count(), 4u);
  EXPECT_TRUE(notes.all().empty());
  const auto frames = frames_of(file.path());
  ASSERT_EQ(frames.size(), 4u);
  EXPECT_EQ(frames[3].tick, 3);
  EXPECT_EQ(frames[2].objects[0].pose.position.x, 0.3);
  EXPECT_EQ(frames[0].objects[0].pose.rotation.w, 1);
  EXPECT_NEAR(frames[1].objects[0].velocity.x, 50, 1e-9);  // 0.1 m in a tick of 500 Hz
  EXPECT_NEAR(frames[3].objects[0].angular_velocity.z, 3.14159265 * 500, 1e-4);
}

TEST(ArrayTrace, MissingSamplesAndTimesAreLeftOutAndCounted) {
  const std::vector<std::int64_t> time{0, 10'000'000, SampledArrays::kNoTime, 20'000'000, 30'000'000, 25'000'000};
  const std::vector<double> force{1, 0, 0, kNan, 0, 0, 9, 9, 9, 3, 0, 0, 4, 0, 0, 9, 9, 9};
  const TempFile file;
  ReadNotes notes;
  ASSERT_TRUE(write_arrays({.time = time, .users = {{.name = "hand", .force = force}}}, file.path(), notes));
  const auto frames = frames_of(file.path());
  ASSERT_EQ(frames.size(), 4u);
  EXPECT_NEAR(frames[1].users[0].force.x, 2, 1e-12);
  EXPECT_EQ(frames[3].users[0].force.x, 4);
  ASSERT_EQ(notes.all().size(), 3u);
  EXPECT_EQ(notes.all()[2].where, "hand.force");
}

/// 10 Hz of ticks and a gap of 0.25 s: a force is held for as long, a position for ever.
TEST(ArrayTrace, AForceIsHeldForAsLongAsTheGap) {
  std::vector<std::int64_t> time;
  std::vector<double> device, force;
  for (int i = 0; i < 12; ++i) {
    time.push_back(100'000'000 * i);
    const bool is_lost = i >= 3 && i < 9;
    device.insert(device.end(), {is_lost ? kNan : 0.1 * i, 0, 0});
    force.insert(force.end(), {is_lost || i == 11 ? kNan : 5.0, 0, 0});
  }
  const TempFile file;
  ReadNotes notes;
  const SampledArrays arrays{.time = time, .users = {{.name = "hand", .device = device, .force = force}}, .gap = 0.25};
  ASSERT_TRUE(write_arrays(arrays, file.path(), notes));
  const auto frames = frames_of(file.path());
  ASSERT_EQ(frames.size(), 12u);
  for (std::size_t i = 0; i < 12; ++i) {
    EXPECT_EQ(frames[i].users[0].force.x, i >= 5 && i < 9 ? 0 : 5) << i;
    EXPECT_EQ(frames[i].users[0].device.position.x, i >= 3 && i < 9 ? 0.2 : 0.1 * static_cast<double>(i)) << i;
  }
}

/// The rule of tables and ROS 2 recordings (missing.h).
TEST(ArrayTrace, ARotationIsOfUnitLengthOrMissing) {
  const std::vector<std::int64_t> time{0, 10'000'000, 20'000'000, 30'000'000};
  const std::vector<double> position(12, 0.0);
  for (const double length : {0.0, 0.5, 0.97, 0.99, 1.0, 1.01, 1.03, 2.0}) {
    const std::vector<double> rotation{1, 0, 0, 0, 1, 0, 0, 0, 0, length, 0, 0, 1, 0, 0, 0};  // half a turn, for a tick
    const TempFile file;
    ReadNotes notes;
    ASSERT_TRUE(write_arrays({.time = time, .objects = {{.name = "cup", .position = position, .rotation = rotation}}},
                             file.path(), notes));
    const auto frames = frames_of(file.path());
    ASSERT_EQ(frames.size(), 4u);
    const bool is_near = std::abs(length - 1) < 0.02;
    EXPECT_EQ(frames[2].objects[0].pose.rotation, is_near ? (Quat{0, 1, 0, 0}) : (Quat{1, 0, 0, 0})) << length;
    EXPECT_EQ(notes.all().size(), length == 1 ? 0u : 1u) << length;
    if (length != 1) {
      EXPECT_EQ(notes.all()[0].what.starts_with("missing"), !is_near) << length;
    }
  }
}

TEST(ArrayTrace, RefusesWithARule) {
  const TempFile file;
  const std::vector<std::int64_t> time{0, 1'000'000};
  const std::vector<double> short_one{0, 0, 0};
  const auto rule_of = [&](const SampledArrays& arrays) {
    ReadNotes notes;
    const auto written = write_arrays(arrays, file.path(), notes);
    return std::string(written ? "" : written.error().rule);
  };
  EXPECT_EQ(rule_of({.time = time}), "R-CSV-8");
  EXPECT_EQ(rule_of({.time = time, .objects = {{.name = "cup", .position = short_one}}}), "R-CSV-8");
  EXPECT_EQ(rule_of({.time = std::span(time).first(1), .objects = {{.name = "cup", .position = short_one}}}), "R-CSV-7");
  EXPECT_EQ(rule_of({.time = {}, .objects = {{.name = "cup", .position = short_one}}}), "R-CSV-5");
}

}  // namespace
}  // namespace tactus
