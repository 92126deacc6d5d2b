// SPDX-License-Identifier: Apache-2.0
/// Servo, and what devices are replaced by.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <stdexcept>

#include <tactus/base/rule.h>
#include <tactus/device/recording.h>
#include <tactus/device/servo.h>
#include <tactus/device/shared_library.h>
#include "tests/property/allocated.h"
#include "tests/unit/device_fixture.h"
#include "tests/unit/trace_fixture.h"

namespace tactus::device {
namespace {

using testing::TestClock;
using testing::TestDevice;

// ==== device replay ====

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
  const auto device = open({.user = "right", .playback_rate = 0.25});
  for (int i = 0; i < 390; ++i) EXPECT_NEAR(x(*device, i), 0.005 + 0.25e-3 * i, 1e-12);
}

TEST_F(Replay, FasterSkips) {
  const auto device = open({.user = "right", .playback_rate = 10});
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
  for (const double rate : {0.0, -1.0, 1001.0, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_STREQ(open_replay_device(file.path(), {.playback_rate = rate}).error().error.rule, "R-API-4");
}

// ==== device servo ====

class ServoLoop : public ::testing::Test {
 protected:
  void start(double rate = 0) { servo = Servo::start(device, {.rate = rate}, clock).value(); }
  /// Force up to its full size.
  void push(const Vec3& force) {
    for (int i = 0; i < 20; ++i) {
      ASSERT_TRUE(servo->next());
      ASSERT_TRUE(servo->exert(force));
    }
    ASSERT_EQ(device.force, force);
  }

  TestClock clock;
  TestDevice device;
  std::unique_ptr<Servo> servo;
};

TEST_F(ServoLoop, TicksHaveAbsoluteTimes) {
  start();
  const Time begin = clock.time;
  clock.lateness = 200'000;
  for (std::int64_t i = 0; i < 1000; ++i) {
    const ServoTick tick = servo->next().value();
    EXPECT_EQ(tick.number, i);
    EXPECT_EQ(tick.due, begin + i * kMillisecond);
    EXPECT_EQ(tick.lateness, i == 0 ? 0 : 200'000);
    EXPECT_EQ(tick.missed, 0U);
    clock.time += 700'000;  // work
  }
}

TEST_F(ServoLoop, ATickThatComesLateLeavesOutWholePeriodsAndKeepsThePhase) {
  start();
  const Time begin = servo->next()->due;
  clock.time += 3'400'000;
  const ServoTick late = servo->next().value();
  EXPECT_EQ(late.number, 3);
  EXPECT_EQ(late.missed, 2U);
  EXPECT_EQ(late.due, begin + 3 * kMillisecond);
  EXPECT_EQ(late.lateness, 2'400'000);
  const ServoTick next = servo->next().value();
  EXPECT_EQ(next.number, 4);
  EXPECT_EQ(next.due, begin + 4 * kMillisecond);
  EXPECT_EQ(servo->times().missed, 2U);
}

TEST_F(ServoLoop, AMillionTicksAreCountedOneByOne) {
  start();
  for (std::int64_t i = 0; i < 1'000'000; ++i) {
    const auto tick = servo->next();
    ASSERT_TRUE(tick && tick->number == i);
    ASSERT_TRUE(servo->exert({}));
  }
  EXPECT_EQ(servo->times().ticks, 1'000'000U);
  EXPECT_EQ(servo->times().missed, 0U);
  EXPECT_EQ(device.writes, 1'000'000);
}

TEST_F(ServoLoop, ADeviceWithAClockIsWaitedFor) {
  device.can.has_clock = true;
  start();
  ASSERT_TRUE(servo->next());
  device.reading.lost = 2;
  const ServoTick tick = servo->next().value();
  EXPECT_EQ(tick.number, 3);
  EXPECT_EQ(tick.missed, 2U);
}

TEST_F(ServoLoop, TheForceIsZeroAfterAnErrorOfTheDevice) {
  start();
  push({1, 2, 0});
  device.read_error = fail(Errc::io, "R-DEV-4").value();
  EXPECT_STREQ(servo->next().error().rule, "R-DEV-4");
  EXPECT_EQ(device.force, Vec3{});
  device.read_error.reset();
  push({1, 2, 0});
  device.write_error = fail(Errc::io, "R-DEV-4").value();
  EXPECT_STREQ(servo->exert({1, 2, 0}).error().rule, "R-DEV-4");
  EXPECT_EQ(device.force, Vec3{});
  EXPECT_GE(device.halts, 1) << "it took no zero, either";
}

TEST_F(ServoLoop, TheForceIsZeroAfterAnExceptionAndAtTheEnd) {
  try {
    start();
    push({1, 2, 0});
    const std::unique_ptr<Servo> own = std::move(servo);
    throw std::runtime_error("in the caller");
  } catch (const std::runtime_error&) {
  }
  EXPECT_EQ(device.force, Vec3{});
}

TEST_F(ServoLoop, ACallerThatHangsIsHaltedWithinTwentyMilliseconds) {
  start();
  push({1, 2, 0});
  clock.time += 15 * kMillisecond;
  std::this_thread::sleep_for(std::chrono::milliseconds(20));  // it looks in vain
  EXPECT_EQ(device.halts, 0);
  ++clock.time;
  const auto begin = std::chrono::steady_clock::now();
  while (device.halts == 0 && std::chrono::steady_clock::now() - begin < std::chrono::seconds(10)) std::this_thread::yield();
  EXPECT_EQ(device.halts, 1);
  ASSERT_TRUE(servo->next());
  ASSERT_TRUE(servo->exert({1, 2, 0}));
  EXPECT_EQ(device.force, Vec3{}) << "it begins anew";
  EXPECT_EQ(servo->times().halted, 1U);
}

TEST_F(ServoLoop, AForceIsAsOldAsTheSampleBehindIt) {
  start();
  push({1, 2, 0});
  device.age = 20 * kMillisecond;
  ASSERT_TRUE(servo->next());
  ASSERT_TRUE(servo->exert({1, 2, 0}));
  EXPECT_EQ(device.force, Vec3{});
  EXPECT_EQ(servo->guard()->count(GuardAction::stale), 1U);
}

TEST_F(ServoLoop, NobodyWatchesADeviceWithoutForce) {
  device.can.force_axes = 0;
  start();
  ASSERT_TRUE(servo->next());
  ASSERT_TRUE(servo->exert({1, 2, 0}));
  EXPECT_EQ(servo->guard(), nullptr);
  EXPECT_EQ(device.writes, 0);
}

TEST_F(ServoLoop, TicksAllocateNothing) {
  start();
  const std::uint64_t before = tactus::testing::allocated_bytes();
  for (int i = 0; i < 1000; ++i) {
    (void)servo->next();
    (void)servo->exert({1, 0, 0});
  }
  EXPECT_EQ(tactus::testing::allocated_bytes(), before);
}

TEST_F(ServoLoop, ARateOutOfRangeIsRefused) {
  for (const double rate : {0.5, 10'001.0, -1.0, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_STREQ(Servo::start(device, {.rate = rate}, clock).error().rule, "R-API-4");
}

TEST(Histogram, QuantilesAreUpperEndsOfBins) {
  Histogram histogram;
  EXPECT_EQ(histogram.quantile(0.5), 0);
  for (Time i = 0; i < 100; ++i) histogram.add(i * 1000);
  EXPECT_EQ(histogram.quantile(0.5), 51'000);
  EXPECT_EQ(histogram.quantile(0.99), 99'000);
  histogram.add(50 * kMillisecond);
  EXPECT_EQ(histogram.quantile(1), 50 * kMillisecond);
  EXPECT_EQ(histogram.longer(), 1U);
}

// ==== device shared library ====

TEST(SharedLibrary, FindsFunctionsAndNamesTheFirstThatIsMissing) {
  auto library = SharedLibrary::load("libm.so.6");
  ASSERT_TRUE(library) << library.error();
  double (*root)(double) = nullptr;
  library->find("sqrt", root);
  ASSERT_NE(root, nullptr);
  EXPECT_EQ(root(9), 3);
  EXPECT_EQ(library->missing(), nullptr);
  void (*none)() = nullptr;
  library->find("no_such_function", none);
  library->find("nor_this_one", none);
  EXPECT_EQ(none, nullptr);
  EXPECT_STREQ(library->missing(), "no_such_function");
}

TEST(SharedLibrary, ReportsWhyItCannotBeLoaded) {
  const auto library = SharedLibrary::load("libno-such-library.so.0");
  ASSERT_FALSE(library);
  EXPECT_NE(library.error().find("libno-such-library.so.0"), std::string::npos) << library.error();
}

}  // namespace
}  // namespace tactus::device
