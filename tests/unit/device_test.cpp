// SPDX-License-Identifier: Apache-2.0
/// Guard, guardian, servo and what devices are replaced by.
#include <gtest/gtest.h>

#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <thread>

#include <tactus/base/rule.h>
#include <tactus/device/force_guard.h>
#include <tactus/device/guardian.h>
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

// ==== device force guard ====

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// A guard of a device of 3 N with 600 N/s, called each millisecond with a fresh command.
class Guarded : public ::testing::Test {
 protected:
  Vec3 pass(const Vec3& force, Time age = 0) {
    now += kMillisecond;
    return guard.pass({force, now - age}, reading, now).value();
  }
  /// Until the slew limit no longer counts.
  void settle(const Vec3& force) {
    for (int i = 0; i < 20; ++i) pass(force);
    ASSERT_EQ(guard.written(), force);
  }
  bool took(GuardAction action) const { return (guard.actions() >> static_cast<unsigned>(action) & 1) != 0; }

  ForceGuard guard = ForceGuard::create(testing::haptic_device(), {}).value();
  Reading reading{};
  Time now = 5'000'000'000;
};

TEST_F(Guarded, ALimitThatNoDeviceHasIsRefused) {
  const Capabilities can = testing::haptic_device();
  Capabilities input = can;
  input.force_axes = 0;
  EXPECT_STREQ(ForceGuard::create(input, {}).error().rule, "R-API-4");
  for (const GuardLimits& limits :
       {GuardLimits{.force = 3.1}, GuardLimits{.force = -1}, GuardLimits{.force = kNan}, GuardLimits{.slew = -1},
        GuardLimits{.slew = kNan}, GuardLimits{.fresh = 0}, GuardLimits{.fresh = 11 * kMillisecond}})
    EXPECT_STREQ(ForceGuard::create(can, limits).error().rule, "R-API-4");
}

TEST_F(Guarded, TheFirstForceStartsFromZeroAndRisesWithTheSlewLimit) {
  EXPECT_EQ(pass({0, 0, 3}), Vec3{});
  for (int i = 1; i <= 5; ++i) EXPECT_NEAR(pass({0, 0, 3}).z, 0.6 * i, 1e-12) << i;
  EXPECT_GE(guard.count(GuardAction::slew), 5U);
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(pass({0, 0, 3}).z, 3, 1e-12);
  EXPECT_FALSE(took(GuardAction::slew));
}

TEST_F(Guarded, AReversalPassesThroughTheLimitToo) {
  settle({2, 0, 0});
  Vec3 last = guard.written();
  for (int i = 0; i < 20; ++i) {
    const Vec3 force = pass({-2, 0.5, 0});
    EXPECT_LE(norm(force - last), 0.6 + 1e-12);
    last = force;
  }
  EXPECT_EQ(last, (Vec3{-2, 0.5, 0}));
}

TEST_F(Guarded, MoreThanTheNominalForceKeepsItsDirection) {
  for (int i = 0; i < 20; ++i) pass({30, 40, 0});
  EXPECT_NEAR(guard.written().x, 1.8, 1e-12);
  EXPECT_NEAR(guard.written().y, 2.4, 1e-12);
  EXPECT_TRUE(took(GuardAction::clamp));
}

TEST_F(Guarded, APauseOfTheCallerAllowsNoJump) {
  settle({0, 0, 1});
  now += 500 * kMillisecond;
  EXPECT_LE(norm(pass({0, 0, -3}) - Vec3{0, 0, 1}), 1.2 + 1e-12);
}

TEST_F(Guarded, AStaleForceIsGoneTwentyMillisecondsAfterItWasComputed) {
  settle({0, 0, 3});
  for (Time age = kMillisecond; age <= 30 * kMillisecond; age += kMillisecond) {
    const double force = pass({0, 0, 3}, age).z;
    const double left =
        age <= 10 * kMillisecond ? 3 : std::max(0.0, 3 * (1 - static_cast<double>(age - 10 * kMillisecond) / 1e7));
    EXPECT_NEAR(force, left, 1e-9) << age;
  }
  EXPECT_TRUE(took(GuardAction::stale));
  EXPECT_EQ(guard.written(), Vec3{});
}

TEST_F(Guarded, WhatIsNotFiniteNeverReachesTheDevice) {
  for (const double bad : {kNan, std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()}) {
    settle({0, 0, 3});
    for (int i = 0; i <= 10; ++i) EXPECT_NEAR(pass({0, bad, 3}).z, 3 - 0.3 * i, 1e-9) << i;
    EXPECT_TRUE(took(GuardAction::not_finite));
    EXPECT_EQ(guard.written(), Vec3{});
  }
}

TEST_F(Guarded, ADeviceThatIsNotHomedOrOutOfReachGetsNoForce) {
  for (const auto state : {Reading::State::not_homed, Reading::State::out_of_reach, Reading::State::ended}) {
    reading.state = Reading::State::valid;
    settle({0, 0, 3});
    reading.state = state;
    for (int i = 0; i <= 10; ++i) pass({0, 0, 3});
    EXPECT_EQ(guard.written(), Vec3{});
    EXPECT_TRUE(took(GuardAction::not_valid));
  }
  reading.state = Reading::State::valid;
  reading.sample.position.x = kNan;
  EXPECT_EQ(pass({0, 0, 3}), Vec3{});
  EXPECT_TRUE(took(GuardAction::not_valid));
}

TEST_F(Guarded, FadingIsOverInTimeWhateverTheSlewLimit) {
  guard = ForceGuard::create(testing::haptic_device(), {.slew = 1}).value();
  for (int i = 0; i < 5000; ++i) pass({0, 0, 3});
  EXPECT_NEAR(guard.written().z, 3, 1e-9);
  for (int i = 0; i <= 10; ++i) pass({kNan, 0, 0});
  EXPECT_EQ(guard.written(), Vec3{});
}

TEST_F(Guarded, EachActionIsLoggedWhenItBegins) {
  settle({0, 0, 1});
  const std::size_t before = guard.log().size();
  for (int i = 0; i < 3; ++i) pass({0, 0, 1}, 12 * kMillisecond);
  for (int i = 0; i < 3; ++i) pass({0, 0, 1});
  pass({0, 0, 1}, 12 * kMillisecond);
  std::size_t stale = 0;
  for (const GuardEntry& entry : guard.log().subspan(before)) stale += entry.action == GuardAction::stale ? 1U : 0U;
  EXPECT_EQ(stale, 2U);
  EXPECT_EQ(guard.count(GuardAction::stale), 4U);
}

/// A virtual wall of stiffness k behind a mass that a person pushes lightly; the wall's force arrives `late` ticks late, which makes
/// it active.
double energy_of_late_wall(bool controls, int late) {
  ForceGuard guard = ForceGuard::create(testing::haptic_device(), {.slew = 1e6, .passivity = controls}).value();
  constexpr double kMass = 0.1, kStep = 1e-3, kStiffness = 1500, kPush = 0.4;
  double x = 0.005, v = -0.1;
  std::vector<double> forces(static_cast<std::size_t>(late) + 1);
  Reading reading;
  Time now = kMillisecond;
  for (int i = 0; i < 4000; ++i, now += kMillisecond) {
    reading.sample.position = {x, 0, 0};
    forces.insert(forces.begin(), x < 0 ? -kStiffness * x : 0);
    forces.pop_back();
    const double force = guard.pass({{forces.back(), 0, 0}, now}, reading, now).value().x;
    v += kStep * (force - kPush - 0.2 * v) / kMass;
    x += kStep * v;
  }
  return guard.energy();
}

TEST(ForceGuard, TheControllerTakesBackWhatALateWallGives) {
  const double without = energy_of_late_wall(false, 4), with = energy_of_late_wall(true, 4);
  EXPECT_GT(without, 0.01);
  EXPECT_LT(with, 0.1 * without);
}

TEST(ForceGuard, APassiveSpringGivesNothing) {
  ForceGuard guard = ForceGuard::create(testing::haptic_device(), {.slew = 1e6, .passivity = true}).value();
  Reading reading;
  Time now = kMillisecond;
  for (int i = 0; i < 2000; ++i, now += kMillisecond) {
    const double x = 0.005 * std::cos(0.003 * i) - 0.005;
    reading.sample.position = {x, 0, 0};
    (void)guard.pass({{-300 * x, 0, 0}, now}, reading, now);
    // The force of the last tick acts to the next: at most k v T of a spring's force is missing, along the way out and back.
    EXPECT_LT(guard.energy(), 300 * 0.01 * 1.5e-5);
  }
  EXPECT_LT(guard.count(GuardAction::passivity), 2000U);
}

// ==== device guardian ====

/// A file whose being there says that the last act was done.
class Act {
 public:
  Act() { std::filesystem::remove(file_.path()); }
  std::function<void()> last_act() const {
    return [path = file_.path()] { std::ofstream(path) << "done"; };
  }
  bool is_done() const { return std::filesystem::exists(file_.path()); }
  bool comes() const {
    for (int i = 0; i < 5000 && !is_done(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return is_done();
  }

 private:
  TempFile file_;
};

/// A process that has a guardian and ends in this way.
void end_by(const Act& act, const std::function<void()>& end) {
  const pid_t process = fork();
  if (process == 0) {
    const auto guardian = Guardian::start(act.last_act());
    if (guardian) end();
    _exit(1);
  }
  waitpid(process, nullptr, 0);
}

TEST(Guardian, ActsWhenItsProcessIsKilled) {
  const Act act;
  end_by(act, [] { kill(getpid(), SIGKILL); });
  EXPECT_TRUE(act.comes());
}

/// As who stops a command and all that it started.
TEST(Guardian, ActsWhenTheGroupOfItsProcessIsKilled) {
  const Act act;
  const pid_t process = fork();
  if (process == 0) {
    setpgid(0, 0);
    const auto guardian = Guardian::start(act.last_act());
    if (guardian) kill(0, SIGKILL);
    _exit(1);
  }
  waitpid(process, nullptr, 0);
  EXPECT_TRUE(act.comes());
}

TEST(Guardian, ActsWhenItsProcessEndsWithoutGoodbye) {
  const Act act;
  end_by(act, [] { _exit(0); });
  EXPECT_TRUE(act.comes());
}

TEST(Guardian, DoesNothingAfterAGoodbye) {
  const Act act;
  Guardian::start(act.last_act()).value().reset();  // has ended when this is done
  EXPECT_FALSE(act.is_done());
  EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1) << "a process is left";
}

TEST(Guardian, MayEndBeforeUs) {
  const Act act;
  auto guardian = Guardian::start(act.last_act()).value();
  pid_t process = 0;
  ASSERT_TRUE(std::ifstream("/proc/thread-self/children") >> process);
  kill(process, SIGKILL);
  guardian.reset();
  EXPECT_FALSE(act.is_done());
}

TEST(Guardian, HoldsNothingOfOursOpen) {
  std::array<int, 2> ends{};
  ASSERT_EQ(pipe(ends.data()), 0);
  const Act act;
  const auto guardian = Guardian::start(act.last_act()).value();
  close(ends[1]);
  pollfd hung{ends[0], POLLIN, 0};
  EXPECT_EQ(poll(&hung, 1, 5000), 1);
  EXPECT_NE(hung.revents & POLLHUP, 0);
  close(ends[0]);
}

TEST(Guardian, OneDoesNotKeepAnotherFromActing) {
  const Act first, second;
  end_by(first, [&] {
    const auto other = Guardian::start(second.last_act());
    kill(getpid(), SIGKILL);
  });
  EXPECT_TRUE(first.comes());
  EXPECT_TRUE(second.comes());
}

TEST(Guardian, SignalsOfOurTerminalDoNotEndIt) {
  const Act act;
  const pid_t process = fork();
  if (process == 0) {
    setpgid(0, 0);  // the guardian would be of this group
    const auto guardian = Guardian::start(act.last_act());
    kill(0, SIGINT);
    _exit(1);
  }
  waitpid(process, nullptr, 0);
  EXPECT_TRUE(act.comes());
}

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

TEST_F(ServoLoop, ADeviceThatPacesIsWaitedFor) {
  device.can.paces = true;
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

TEST(SharedLibrary, TellsWhyItCannotBeLoaded) {
  const auto library = SharedLibrary::load("libno-such-library.so.0");
  ASSERT_FALSE(library);
  EXPECT_NE(library.error().find("libno-such-library.so.0"), std::string::npos) << library.error();
}

}  // namespace
}  // namespace tactus::device
