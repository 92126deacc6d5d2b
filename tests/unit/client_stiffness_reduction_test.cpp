// SPDX-License-Identifier: Apache-2.0
#include <tactus/client/stiffness_reduction.h>

#include <gtest/gtest.h>

#include <limits>

#include "tests/property/allocated.h"

namespace tactus {
namespace {

using Touch = StiffnessReduction::Touch;

constexpr double kCoupling = 340, kObject = 100;  // [N/m] thesis figure 4.18
constexpr double kFollows = kCoupling / (kCoupling + kObject);
constexpr double kLeast = kCoupling * (1 - kFollows);

/// A surface that looks up; the device goes down by `speed` [m] each tick.
class Pressing : public ::testing::Test {
 protected:
  void go(double speed, int ticks) {
    for (int i = 0; i < ticks; ++i) {
      z_ -= speed;
      reduction_.move({0, 0, z_});
    }
  }
  double reduced(double stretch, std::uint32_t round_trip) {
    return reduction_.reduced({{0, 0, -stretch}, {0, 0, 1}, kCoupling, kObject}, round_trip);
  }
  double z_ = 0;
  StiffnessReduction reduction_ = StiffnessReduction::create({.most_delay = 200, .filter = 1}).value();
};

TEST_F(Pressing, WhoHoldsStillFeelsTheWholeStiffness) {
  go(0, 300);
  EXPECT_EQ(reduced(0.01, 80), kCoupling);
}

TEST_F(Pressing, WithoutDelayNothingIsReduced) {
  go(1e-4, 300);
  EXPECT_EQ(reduced(0.01, 0), kCoupling);
}

TEST_F(Pressing, WhoGoesInFeelsLessByWhatTheObjectWouldHaveFollowed) {
  go(1e-4, 300);
  EXPECT_NEAR(reduced(0.02, 80), kCoupling * (1 - kFollows * 0.008 / 0.02), 1e-9);
}

/// The object did not follow yet: what the client sees is the device's whole way, of which the server would see a share.
TEST_F(Pressing, AtFirstTheObjectIsAsSoftAsBothSpringsTogether) {
  go(1e-4, 50);
  EXPECT_NEAR(reduced(0.004, 80), kLeast, 1e-9);
  EXPECT_NEAR(reduced(0, 80), kLeast, 1e-9);
  EXPECT_NEAR(reduced(-0.001, 80), kLeast, 1e-9);
}

TEST_F(Pressing, WhoLetsGoFeelsTheWholeStiffness) {
  go(-1e-4, 300);
  EXPECT_EQ(reduced(0.02, 80), kCoupling);
}

TEST_F(Pressing, MotionAlongTheSurfaceDoesNotCount) {
  for (int i = 0; i < 100; ++i) reduction_.move({1e-4 * i, -2e-4 * i, 0});
  EXPECT_EQ(reduction_.reduced({{0.05, 0.01, -0.002}, {0, 0, 1}, kCoupling, kObject}, 80), kCoupling);
}

TEST_F(Pressing, LongerThanThePathThatIsKnownCountsAsThat) {
  EXPECT_EQ(reduced(0.02, 80), kCoupling) << "no path at all";
  go(1e-4, 11);
  EXPECT_NEAR(reduced(0.02, 80), kCoupling * (1 - kFollows * 0.001 / 0.02), 1e-9);
  go(1e-4, 1000);
  EXPECT_NEAR(reduced(0.05, 4'000'000'000u), kCoupling * (1 - kFollows * 0.02 / 0.05), 1e-9) << "200 ticks";
}

/// The force is that of both springs in a row, in every tick of a push at constant speed.
TEST_F(Pressing, ForceOfAPushIsThatWithoutDelay) {
  constexpr double kSpeed = 1e-4;
  constexpr int kDelay = 80;
  go(0, kDelay);
  for (int tick = 1; tick <= 400; ++tick) {
    go(kSpeed, 1);
    const double in = kSpeed * tick, surface = kFollows * kSpeed * std::max(tick - kDelay, 0);
    const double stretch = in - surface;
    EXPECT_NEAR(reduced(stretch, kDelay) * stretch, kLeast * in, 1e-9) << tick;
  }
}

TEST(StiffnessReduction, TheFilterBeginsWithTheFirstValueOfAContact) {
  auto reduction = StiffnessReduction::create({.most_delay = 10, .filter = 0.01}).value();
  const Touch touch{{0, 0, -0.01}, {0, 0, 1}, kCoupling, kObject};
  for (int i = 0; i < 20; ++i) reduction.move({0, 0, -0.01 * i});
  double mean = kLeast;
  EXPECT_NEAR(reduction.reduced(touch, 10), mean, 1e-9);
  for (int i = 0; i < 50; ++i) {
    reduction.move({0, 0, -0.19});  // holds still: the path moves on
    const double way = 0.01 * std::max(9 - i, 0);
    const double wanted = way >= 0.01 ? kLeast : kCoupling;
    mean = 0.01 * wanted + 0.99 * mean;
    EXPECT_NEAR(reduction.reduced(touch, 10), mean, 1e-9) << i;
  }
  reduction.release();
  EXPECT_EQ(reduction.reduced(touch, 10), kCoupling);
}

TEST(StiffnessReduction, ATickAllocatesNothing) {
  auto reduction = StiffnessReduction::create({}).value();
  const std::uint64_t before = testing::allocated_bytes();
  for (int i = 0; i < 3000; ++i) {
    reduction.move({0, 0, -1e-5 * i});
    (void)reduction.reduced({{0, 0, -0.01}, {0, 0, 1}, kCoupling, kObject}, 80);
  }
  EXPECT_EQ(testing::allocated_bytes(), before);
}

TEST(StiffnessReduction, OptionsOutOfRangeAreRefused) {
  for (const std::uint32_t delay : {0u, StiffnessReduction::kMostDelay + 1})
    EXPECT_STREQ(StiffnessReduction::create({.most_delay = delay, .filter = 0.01}).error().rule, "R-API-4");
  for (const double filter : {0.0, -0.1, 1.1, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_STREQ(StiffnessReduction::create({.most_delay = 10, .filter = filter}).error().rule, "R-API-4");
}

}  // namespace
}  // namespace tactus
