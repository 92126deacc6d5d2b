// SPDX-License-Identifier: Apache-2.0
#include <tactus/device/recording.h>

#include <gtest/gtest.h>

#include <limits>

#include "tests/unit/trace_fixture.h"

namespace tactus::device {
namespace {

constexpr Time kBegin = 77 * kMillisecond;

/// A hand that moves 1 mm per tick along x from 5 mm on, with a button down at odd ticks.
class Replay : public ::testing::Test {
 protected:
  Replay() {
    TraceInfo info;
    info.users = {{.name = "left"}, {.name = "right", .senses = {.velocity = true, .buttons = true}}};
    auto writer = TraceWriter::create(file.path(), info).value();
    TraceFrame frame;
    frame.users.resize(2);
    for (frame.tick = 100; frame.tick < 200; ++frame.tick) {
      frame.users[1].device.position.x = 0.005 + 1e-3 * static_cast<double>(frame.tick - 100);
      frame.users[1].device.velocity.x = 1;
      frame.users[1].device.buttons = static_cast<std::uint32_t>(frame.tick % 2);
      EXPECT_TRUE(writer.write(frame));
    }
    EXPECT_TRUE(writer.finish());
  }
  std::unique_ptr<Device> open(const RecordingOptions& options) { return open_replay_device(file.path(), options).value(); }
  /// [ms] after the first call
  static double x(Device& device, double time) {
    return device.read(kBegin + static_cast<Time>(1e6 * time)).value().sample.position.x;
  }

  TempFile file;
};

TEST_F(Replay, GivesTheSamplesAtTheirRate) {
  const auto device = open({.user = "right"});
  EXPECT_EQ(device->capabilities().rate, 1000);
  EXPECT_EQ(device->capabilities().force_axes, 0U);
  EXPECT_EQ(device->capabilities().senses, (DeviceSenses{.velocity = true, .buttons = true}));
  EXPECT_NEAR(device->capabilities().high.x, 0.104, 1e-12);
  for (int i = 0; i < 100; ++i) {
    const auto reading = device->read(kBegin + i * kMillisecond);
    EXPECT_NEAR(reading->sample.position.x, 0.005 + 1e-3 * i, 1e-12);
    EXPECT_EQ(reading->sample.buttons, static_cast<std::uint32_t>(i % 2));
    EXPECT_EQ(reading->state, device::Reading::State::valid);
  }
  EXPECT_EQ(device->read(kBegin + 100 * kMillisecond)->state, device::Reading::State::ended);
}

TEST_F(Replay, SlowerIsInterpolated) {
  const auto device = open({.user = "right", .pace = 0.25});
  for (int i = 0; i < 390; ++i) EXPECT_NEAR(x(*device, i), 0.005 + 0.25e-3 * i, 1e-12);
}

TEST_F(Replay, FasterSkips) {
  const auto device = open({.user = "right", .pace = 10});
  EXPECT_NEAR(x(*device, 0), 0.005, 1e-12);
  EXPECT_NEAR(x(*device, 9), 0.095, 1e-12);
}

TEST_F(Replay, ALoopBeginsAgain) {
  const auto device = open({.user = "right", .loops = true});
  for (int i = 0; i < 1000; ++i) {
    ASSERT_NEAR(x(*device, i), 0.005 + 1e-3 * (i % 99), 1e-9) << i;
  }
}

TEST_F(Replay, ErrorsNameTheFile) {
  const auto nobody = open_replay_device(file.path(), {.user = "nobody"});
  EXPECT_STREQ(nobody.error().error.rule, "R-DEV-1");
  EXPECT_EQ(nobody.error().file, file.path());
  EXPECT_STREQ(open_replay_device("/nowhere/x.mcap", {}).error().error.rule, "R-TRC-1");
  for (const double pace : {0.0, -1.0, 1001.0, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_STREQ(open_replay_device(file.path(), {.pace = pace}).error().error.rule, "R-API-4");
}

}  // namespace
}  // namespace tactus::device
