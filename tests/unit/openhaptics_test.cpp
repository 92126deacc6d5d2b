// SPDX-License-Identifier: Apache-2.0
/// Devices of the OpenHaptics runtime.
#include <gtest/gtest.h>

#include <dlfcn.h>
#include <algorithm>
#include <chrono>
#include <clocale>
#include <cmath>
#include <fstream>
#include <limits>
#include <thread>
#include <utility>

#include <tactus/device/openhaptics/hd_runtime.h>
#include <tactus/device/openhaptics/openhaptics_device.h>
#include <tactus/device/real_time.h>
#include <tactus/device/servo.h>
#include "tests/property/stub_libhd.h"

namespace tactus::device::openhaptics {
namespace {

using tactus::testing::StubState;

// ==== hd exchange ====

RawSample sample_of_number(std::uint64_t number) {
  RawSample out;
  out.position.fill(static_cast<double>(number));
  out.velocity.fill(static_cast<double>(number));
  out.transform.fill(static_cast<double>(number));
  out.buttons = static_cast<std::uint32_t>(number);
  out.taken = static_cast<Time>(number);
  return out;
}

Time soon() { return monotonic_clock().now() + kAnswerTime; }

TEST(SampleRing, HandsEachOutOnceAndInOrder) {
  SampleRing ring;
  for (std::uint64_t i = 0; i < SampleRing::kSlots; ++i) ring.put(sample_of_number(i));
  for (std::uint64_t i = 0; i < SampleRing::kSlots; ++i) {
    const auto taken = ring.take(soon());
    ASSERT_TRUE(taken);
    EXPECT_EQ(taken->sample.taken, static_cast<Time>(i));
    EXPECT_EQ(taken->sample.transform[15], static_cast<double>(i));
    EXPECT_EQ(taken->lost, 0U);
  }
  EXPECT_FALSE(ring.take(monotonic_clock().now() + kMillisecond));
}

TEST(SampleRing, TheOldestAreLostAndCounted) {
  SampleRing ring;
  for (std::uint64_t i = 0; i < SampleRing::kSlots + 5; ++i) ring.put(sample_of_number(i));
  const auto taken = ring.take(soon());
  EXPECT_EQ(taken->sample.taken, 5);
  EXPECT_EQ(taken->lost, 5U);
  EXPECT_EQ(ring.take(soon())->lost, 0U);
}

TEST(SampleRing, NothingIsTornWhileAnotherThreadWrites) {
  constexpr std::uint64_t kSamples = 300'000;
  SampleRing ring;
  std::thread writer([&] {
    for (std::uint64_t i = 0; i < kSamples; ++i) ring.put(sample_of_number(i));
    ring.end();
  });
  std::uint64_t taken = 0, lost = 0;
  Time last = -1;
  while (const auto one = ring.take(soon())) {
    ++taken;
    lost += one->lost;
    EXPECT_GT(one->sample.taken, last);
    last = one->sample.taken;
    const auto number = static_cast<double>(last);
    EXPECT_TRUE(one->sample.position[0] == number && one->sample.velocity[1] == number && one->sample.transform[15] == number &&
                one->sample.buttons == static_cast<std::uint32_t>(last));
  }
  writer.join();
  EXPECT_EQ(taken + lost, kSamples);
}

TEST(ForceBox, AForceFadesWhenNoNewOneComes) {
  ForceBox box;
  EXPECT_EQ(box.get(kMillisecond), Vec3{});
  box.put({0, 0, 2}, 0);
  for (Time age = 0; age <= 30 * kMillisecond; age += kMillisecond) {
    const double left =
        age <= 10 * kMillisecond ? 2 : std::max(0.0, 2 * (1 - static_cast<double>(age - 10 * kMillisecond) / 1e7));
    EXPECT_NEAR(box.get(age).z, left, 1e-12) << age;
  }
}

TEST(ForceBox, AHaltLastsUntilTheNextForce) {
  ForceBox box;
  box.put({1, 2, 3}, 0);
  box.halt();
  EXPECT_EQ(box.get(0), Vec3{});
  box.put({1, 2, 3}, 0);
  EXPECT_EQ(box.get(0), (Vec3{1, 2, 3}));
}

TEST(ForceBox, NothingIsTornWhileAnotherThreadWrites) {
  ForceBox box;
  std::atomic<bool> ends{false};
  std::thread writer([&] {
    for (int i = 1; i < 300'000; ++i) box.put({1.0 * i, 2.0 * i, 3.0 * i}, 0);
    ends = true;
  });
  while (!ends) {
    const Vec3 force = box.get(0);
    EXPECT_TRUE(force.y == 2 * force.x && force.z == 3 * force.x);
  }
  writer.join();
}

// ==== hd runtime ====

bool is_loaded(const std::string& library) {
  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);)
    if (line.find(library) != std::string::npos) return true;
  return false;
}

TEST(HdRuntime, IsLoadedWhenADeviceIsOpenedAndNotBefore) {
  const OpenHapticsBackend backend;
  (void)backend.list();
  EXPECT_FALSE(is_loaded("libHD.so"));
  ASSERT_TRUE(Runtime::load(STUB_LIBHD));
  EXPECT_TRUE(is_loaded("libHD.so"));
}

TEST(HdRuntime, AMissingLibraryIsSaid) {
  const auto runtime = Runtime::load("/nowhere/libHD.so");
  ASSERT_FALSE(runtime);
  EXPECT_STREQ(runtime.error().error.rule, "R-DEV-3");
  EXPECT_EQ(runtime.error().file, "/nowhere/libHD.so");
  EXPECT_NE(runtime.error().remedy.find("--tune runtime="), std::string::npos);
}

TEST(HdRuntime, ALibraryWithoutItsFunctionsIsRefused) {
  const auto runtime = Runtime::load("libm.so.6");
  ASSERT_FALSE(runtime);
  EXPECT_STREQ(runtime.error().error.rule, "R-DEV-3");
  EXPECT_EQ(runtime.error().detail, "no function hdInitDevice");
}

// ==== openhaptics device ====
/// Against a runtime of our own (tests/property/stub_libhd.cpp): no device was at hand.

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
  Result<Reading> read(Time timeout = 10 * 1000 * kMillisecond) { return device->read(monotonic_clock().now() + timeout); }
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

TEST_F(OpenHaptics, ReportsWhatTheRuntimeReports) {
  open();
  const Capabilities& can = device->capabilities();
  EXPECT_EQ(can.name, "openhaptics");
  EXPECT_EQ(can.serial, "00-11");
  EXPECT_EQ(can.nominal_force, 3.3);
  EXPECT_EQ(can.rate, 1000);
  EXPECT_TRUE(can.has_clock);
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
