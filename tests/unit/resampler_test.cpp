// SPDX-License-Identifier: Apache-2.0
// A trace at another rate: io/trace/resampler.h.
#include <tactus/trace/resampler.h>

#include <cmath>
#include <numbers>

#include "tests/unit/trace_fixture.h"

namespace tactus {
namespace {

std::vector<TraceFrame> resampled(const Recording& recording, std::uint32_t rate, double gap = 1) {
  Resampler resampler(recording.info, rate, gap);
  std::vector<TraceFrame> out;
  TraceFrame frame;
  const auto take = [&] {
    while (resampler.next(frame)) out.push_back(frame);
  };
  for (const TraceFrame& in : recording.frames) {
    resampler.add(in);
    take();
  }
  resampler.end();
  take();
  return out;
}

/// A user at x = tick mm, turning by 10 deg each tick, with ticks at 100 Hz.
Recording moving(const std::vector<std::int64_t>& ticks) {
  Recording recording;
  recording.info = {.tick_rate = 100, .objects = {}, .users = {{"hand", {true, true, true, true}}}, .source = {}, .scene = {}};
  for (const std::int64_t tick : ticks) {
    const auto t = static_cast<double>(tick);
    const double half = t * std::numbers::pi / 36;
    UserSample user;
    user.device = {{0.001 * t, 0, 0},
                   {std::cos(half), 0, 0, std::sin(half)},
                   {0.1, 0, 0},
                   static_cast<std::uint32_t>(tick),
                   10'000'000 * tick};
    user.contact.device = user.device.position;
    user.force = {0, 0, t};
    recording.frames.push_back({.tick = tick, .objects = {}, .users = {user}});
  }
  return recording;
}

TEST(Resampler, TheSameRateChangesNothing) {
  const Recording recording = make_mesh_recording(20);
  const std::vector<TraceFrame> same = resampled(recording, 1000, 0.0005);
  ASSERT_EQ(same.size(), recording.frames.size());
  for (std::size_t i = 0; i < same.size(); ++i) {
    TraceFrame expected = recording.frames[i];
    for (DeformableSample& mesh : expected.meshes) mesh.updated = mesh.updated || i == 0;
    EXPECT_EQ(image(same[i]), image(expected)) << i;
  }
}

TEST(Resampler, BetweenSamplesALineAndAnArc) {
  const std::vector<TraceFrame> out = resampled(moving({0, 1, 2, 3}), 250);
  ASSERT_EQ(out.size(), 8u);  // 0 .. 28 ms
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double t = 0.4 * static_cast<double>(i), half = t * std::numbers::pi / 36;
    const UserSample& user = out[i].users[0];
    EXPECT_EQ(out[i].tick, static_cast<std::int64_t>(i));
    EXPECT_NEAR(user.device.position.x, 0.001 * t, 1e-15);
    EXPECT_EQ(user.contact.device, user.device.position);
    EXPECT_NEAR(user.device.orientation.w, std::cos(half), 1e-12);
    EXPECT_NEAR(user.device.orientation.z, std::sin(half), 1e-12);
    EXPECT_NEAR(user.force.z, t, 1e-12);
    EXPECT_EQ(user.device.buttons, static_cast<std::uint32_t>(t + 1e-9));
    EXPECT_NEAR(static_cast<double>(user.device.time), 1e7 * t, 1);
  }
}

TEST(Resampler, OppositeQuaternionsAreOneRotation) {
  Recording recording = moving({0, 1});
  Quat& q = recording.frames[1].users[0].device.orientation;
  q = {-q.w, -q.x, -q.y, -q.z};
  const std::vector<TraceFrame> out = resampled(recording, 200);
  ASSERT_EQ(out.size(), 3u);
  EXPECT_NEAR(out[1].users[0].device.orientation.z, std::sin(std::numbers::pi / 72), 1e-12);
}

TEST(Resampler, PausesStay) {
  const std::vector<TraceFrame> out = resampled(moving({0, 1, 2, 50, 51}), 200, 0.02);
  std::vector<std::int64_t> ticks;
  for (const TraceFrame& frame : out) ticks.push_back(frame.tick);
  EXPECT_EQ(ticks, (std::vector<std::int64_t>{0, 1, 2, 3, 4, 100, 101, 102}));
}

TEST(Resampler, TicksThatNeverMeet) {
  const std::vector<TraceFrame> out = resampled(moving({1, 2, 3}), 70);  // 10 to 30 ms; ticks at 14.3 and 28.6 ms
  ASSERT_EQ(out.size(), 2u);
  EXPECT_EQ(out[0].tick, 1);
  EXPECT_NEAR(out[0].users[0].device.position.x, 0.001 / 0.7, 1e-15);
}

TEST(Resampler, AShapeIsNewOnceAndItsPeriodInNewTicks) {
  Recording recording = make_mesh_recording(9);  // new at frames 1, 4, 7: ticks 1, 8, 14
  recording.info.meshes[0].period = 6;
  EXPECT_EQ(Resampler(recording.info, 500, 1).info().meshes[0].period, 3);
  std::vector<std::int64_t> is_new;
  for (const TraceFrame& frame : resampled(recording, 500))
    if (frame.meshes[0].updated) is_new.push_back(frame.tick);
  EXPECT_EQ(is_new, (std::vector<std::int64_t>{0, 1, 4, 7}));
}

TEST(Resampler, EveryReportComesOnce) {
  Recording recording = moving({0, 1, 2, 3, 4, 5, 6, 7, 20, 24});
  recording.info.users[0].report_descriptor.emplace();
  for (TraceFrame& frame : recording.frames) frame.users[0].reports = {{1}, {static_cast<std::uint8_t>(frame.tick)}};
  const std::vector<std::uint8_t> all{0, 1, 2, 3, 4, 5, 6, 7, 20, 24};
  for (const std::uint32_t rate : {25U, 100U, 250U, 1000U}) {
    std::vector<std::uint8_t> heard;
    for (const TraceFrame& frame : resampled(recording, rate, 0.05)) {
      const DeviceReports& reports = frame.users[0].reports;
      ASSERT_TRUE(is_valid(reports));
      heard.insert(heard.end(), reports.bytes.begin(), reports.bytes.end());
      for (const std::uint8_t of : reports.bytes)
        EXPECT_GE(frame.tick * 100, of * static_cast<std::int64_t>(rate)) << "not before it came";
    }
    EXPECT_EQ(heard, all) << rate;
  }
}

TEST(Resampler, NothingOfNothing) {
  EXPECT_TRUE(resampled(moving({}), 1000).empty());
  EXPECT_TRUE(resampled(moving({1}), 70).empty());
  EXPECT_EQ(resampled(moving({1}), 200).size(), 1u);
}

}  // namespace
}  // namespace tactus
