// SPDX-License-Identifier: Apache-2.0
/// Forces that reach no device, or later, or less of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <tactus/device/force_guard.h>
#include "tests/unit/device_fixture.h"

namespace tactus::device {
namespace {

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

}  // namespace
}  // namespace tactus::device
