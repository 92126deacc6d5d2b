// SPDX-License-Identifier: Apache-2.0
/// Against a runtime of our own (tests/property/stub_libhd.cpp): no device was at hand.
#include <tactus/device/openhaptics/openhaptics_device.h>

#include <gtest/gtest.h>

#include <dlfcn.h>

#include <chrono>
#include <clocale>
#include <cmath>
#include <limits>
#include <thread>
#include <utility>

#include <tactus/device/openhaptics/hd_runtime.h>
#include <tactus/device/servo.h>
#include "tests/property/stub_libhd.h"

namespace tactus::device::openhaptics {
namespace {

using tactus::testing::StubState;

class OpenHaptics : public ::testing::Test {
 protected:
  OpenHaptics() : library_(dlopen(STUB_LIBHD, RTLD_NOW)) { control<tactus::testing::StubReset>("stub_reset")(); }
  ~OpenHaptics() override {
    device.reset();
    EXPECT_EQ(look().wrong_calls, 0U);
    EXPECT_FALSE(look().is_open || look().is_running);
  }

  template <class Function>
  Function control(const char* name) {
    return reinterpret_cast<Function>(dlsym(library_, name));
  }
  StubState look() {
    StubState state;
    control<tactus::testing::StubLook>("stub_look")(&state);
    return state;
  }
  void fail(const char* function, std::uint64_t number) { control<tactus::testing::StubFail>("stub_fail")(function, number); }
  tl::expected<std::unique_ptr<Device>, Diagnostic> try_open(const std::string& which = "") {
    return OpenHapticsBackend().open(which, {.runtime = STUB_LIBHD});
  }
  void open() { device = try_open().value(); }
  /// A loaded machine may stand still for longer than a device may.
  Result<Reading> read(Time patience = 10 * 1000 * kMillisecond) { return device->read(monotonic_clock().now() + patience); }
  /// Until the runtime was given all of a force of 2 N: where the machine stands still, it fades meanwhile.
  ::testing::AssertionResult push(Servo& servo) {
    for (int i = 0; i < 5000; ++i) {
      if (!servo.next() || !servo.exert({0, 0, 2})) break;
      const StubState state = look();
      if (std::abs(state.force[1] - 2) < 1e-9 && std::abs(state.force[2]) < 1e-9) return ::testing::AssertionSuccess();  // up
    }
    return ::testing::AssertionFailure() << "no force";
  }
  bool has_force() {
    const StubState state = look();
    return state.force[0] != 0 || state.force[1] != 0 || state.force[2] != 0;
  }
  void wait_for_no_force() {
    const auto begin = std::chrono::steady_clock::now();
    while (has_force() && std::chrono::steady_clock::now() - begin < std::chrono::seconds(10)) std::this_thread::yield();
    EXPECT_FALSE(has_force());
  }

  std::unique_ptr<Device> device;

 private:
  void* library_;
};

TEST_F(OpenHaptics, TellsWhatTheRuntimeTells) {
  open();
  const Capabilities& can = device->capabilities();
  EXPECT_EQ(can.name, "openhaptics");
  EXPECT_EQ(can.serial, "00-11");
  EXPECT_EQ(can.nominal_force, 3.3);
  EXPECT_EQ(can.rate, 1000);
  EXPECT_TRUE(can.paces);
  const Reading reading = read().value();
  EXPECT_EQ(reading.state, Reading::State::valid);
  EXPECT_NEAR(reading.sample.position.y, 0.030, 1e-12) << "away from the user";
  EXPECT_NEAR(reading.sample.position.z, 0.020, 1e-12);  // up
  EXPECT_NEAR(reading.sample.velocity.x, 0.010, 1e-12);
}

TEST_F(OpenHaptics, NoSampleIsLostOrDoubled) {
  open();
  double last = -1;
  std::uint64_t lost = 0;
  for (int i = 0; i < 2000; ++i) {
    const Reading reading = read().value();
    lost += reading.lost;
    const double tick = std::round(1e5 * reading.sample.position.x);
    if (last >= 0) {
      EXPECT_EQ(std::fmod(tick - last + 10'000, 10'000), 1.0 + reading.lost) << i;
    }
    last = tick;
  }
  RecordProperty("lost", static_cast<int>(lost));
}

TEST_F(OpenHaptics, ATurnAboutUpStaysOne) {
  open();
  const Quat a = read()->sample.orientation;
  for (int i = 0; i < 9; ++i) ASSERT_TRUE(read());
  const Quat b = read()->sample.orientation;
  const Quat turn = b * conjugate(a);
  EXPECT_NEAR(angle_between(a, b), 0.010, 1e-9);
  EXPECT_NEAR(turn.z, std::sin(0.005), 1e-9);
}

TEST_F(OpenHaptics, TheForceArrivesInTheRuntimesAxes) {
  open();
  const auto servo = Servo::start(*device, {}).value();
  EXPECT_TRUE(push(*servo));
}

TEST_F(OpenHaptics, AThousandTicksOfAServo) {
  open();
  const auto servo = Servo::start(*device, {}).value();
  std::int64_t number = -1;
  for (int i = 0; i < 1000; ++i) {
    const ServoTick tick = servo->next().value();
    EXPECT_EQ(tick.number, number + 1 + tick.missed);
    number = tick.number;
    ASSERT_TRUE(servo->exert({0.1, 0, 0}));
  }
}

TEST_F(OpenHaptics, WithoutNewForcesTheRuntimesThreadTakesTheLastOneAway) {
  open();
  auto guard = ForceGuard::create(device->capabilities(), {}).value();
  while (look().pushes == 0) {
    const Reading reading = read().value();
    ASSERT_TRUE(device->write(guard.pass({{0, 0, 2}, reading.taken}, reading, reading.taken)));
  }
  wait_for_no_force();  // nobody calls, nobody watches
}

TEST_F(OpenHaptics, AHaltIsAtOnceAndTheNextForceCounts) {
  open();
  const auto servo = Servo::start(*device, {}).value();
  ASSERT_TRUE(push(*servo));
  device->halt();
  wait_for_no_force();
  EXPECT_TRUE(push(*servo));
}

TEST_F(OpenHaptics, TheForceIsZeroAtTheEnd) {
  open();
  {
    const auto servo = Servo::start(*device, {}).value();
    ASSERT_TRUE(push(*servo));
  }
  device.reset();
  EXPECT_FALSE(has_force());
}

TEST_F(OpenHaptics, ASampleThatIsNoneKeepsTheLastOne) {
  open();
  const Vec3 before = read()->sample.position;
  control<tactus::testing::StubSpoil>("stub_spoil")(true);
  Reading reading;
  for (int i = 0; i < 200 && reading.state == Reading::State::valid; ++i) reading = read().value();
  EXPECT_EQ(reading.state, Reading::State::out_of_reach);
  EXPECT_TRUE(is_finite(reading.sample.position));
  EXPECT_GE(reading.sample.position.x, before.x);
}

TEST_F(OpenHaptics, SilenceIsAnError) {
  open();
  ASSERT_TRUE(read());
  control<tactus::testing::StubPause>("stub_pause")(4 * kAnswerTime);
  Result<Reading> reading = read(kAnswerTime);
  for (int i = 0; i < 200 && reading; ++i) reading = read(kAnswerTime);
  ASSERT_FALSE(reading);
  EXPECT_STREQ(reading.error().rule, "R-DEV-4");
}

TEST_F(OpenHaptics, EveryCallThatFailsWhileItOpensIsSaid) {
  const std::pair<const char*, std::uint64_t> calls[] = {
      {"hdInitDevice", 1}, {"hdMakeCurrentDevice", 1}, {"hdGetIntegerv", 1},         {"hdGetDoublev", 1}, {"hdGetString", 1},
      {"hdEnable", 1},     {"hdStartScheduler", 1},    {"hdScheduleAsynchronous", 1}};
  for (const auto& [function, number] : calls) {
    fail(function, number);
    const auto opened = try_open();
    ASSERT_FALSE(opened) << function;
    EXPECT_STREQ(opened.error().error.rule, "R-DEV-2") << function;
    EXPECT_EQ(opened.error().detail, "device fault") << function;
    EXPECT_FALSE(look().is_open) << function;
  }
  const auto nobody = try_open("nobody");
  EXPECT_EQ(nobody.error().file, "openhaptics:nobody");
}

TEST_F(OpenHaptics, EveryCallThatFailsInAFrameEndsTheUseWithoutForce) {
  for (const char* function : {"hdBeginFrame", "hdEndFrame", "hdGetDoublev", "hdGetIntegerv", "hdSetDoublev"}) {
    open();
    {
      const auto servo = Servo::start(*device, {}).value();
      ASSERT_TRUE(push(*servo));
      fail(function, 5);
      Result<void> done;
      for (int i = 0; i < 1000 && done; ++i) {
        const auto tick = servo->next();
        done = tick ? servo->exert({0, 0, 2}) : Result<void>(tl::unexpected(tick.error()));
      }
      ASSERT_FALSE(done) << function;
      EXPECT_STREQ(done.error().rule, "R-DEV-4") << function;
      wait_for_no_force();
    }
    device.reset();
    EXPECT_FALSE(has_force()) << function;
  }
}

TEST(OpenHapticsSample, WhatIsNotFiniteOrNoRotationIsNoSample) {
  RawSample raw;
  raw.transform = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  ASSERT_TRUE(sample_of(raw));
  EXPECT_EQ(sample_of(raw)->orientation, Quat{});
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    RawSample wrong = raw;
    wrong.position[1] = bad;
    EXPECT_FALSE(sample_of(wrong));
    wrong = raw;
    wrong.velocity[2] = bad;
    EXPECT_FALSE(sample_of(wrong));
    wrong = raw;
    wrong.transform[5] = bad;
    EXPECT_FALSE(sample_of(wrong));
  }
  RawSample mirrored = raw;
  mirrored.transform[0] = -1;
  EXPECT_FALSE(sample_of(mirrored));
  RawSample sheared = raw;
  sheared.transform[4] = 0.1;
  EXPECT_FALSE(sample_of(sheared));
  RawSample empty;
  EXPECT_FALSE(sample_of(empty));
}

TEST(OpenHapticsSample, EveryTurnIsAUnitQuaternion) {
  for (int axis = 0; axis < 3; ++axis)
    for (double angle = -3.1; angle < 3.14; angle += 0.1) {
      const double c = std::cos(angle), s = std::sin(angle);
      RawSample raw;
      const auto at = [&](int column, int row) -> double& { return raw.transform[static_cast<std::size_t>(4 * column + row)]; };
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      at(axis, axis) = 1;
      at(u, u) = at(v, v) = c;
      at(u, v) = s;
      at(v, u) = -s;
      const auto sample = sample_of(raw);
      ASSERT_TRUE(sample);
      const Vec3 axes[] = {{1, 0, 0}, {0, 0, 1}, {0, -1, 0}};  // the runtime's, in the device frame
      const Quat expected{std::cos(angle / 2), std::sin(angle / 2) * axes[axis].x, std::sin(angle / 2) * axes[axis].y,
                          std::sin(angle / 2) * axes[axis].z};
      EXPECT_LT(angle_between(sample->orientation, expected), 1e-7) << axis << ' ' << angle;
    }
}

}  // namespace
}  // namespace tactus::device::openhaptics
