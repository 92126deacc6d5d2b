// SPDX-License-Identifier: Apache-2.0
#include <tactus/client/stiffness_reduction.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "tests/property/allocated.h"

namespace tactus {
namespace {

using Touch = StiffnessReduction::DeformableTouch;

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
    return reduction_.reduced(StiffnessReduction::DeformableTouch{{0, 0, -stretch}, {0, 0, 1}, kCoupling, kObject}, round_trip);
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

/// The object did not follow yet: what the client sees is the device's whole displacement, of which the server would see a fraction.
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
  EXPECT_EQ(reduction_.reduced(StiffnessReduction::DeformableTouch{{0.05, 0.01, -0.002}, {0, 0, 1}, kCoupling, kObject}, 80),
            kCoupling);
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

/// A device that pushes a block along x by 1e-4 m each tick (0.1 m/s), 0.3 kg on a surface of mu 0.45.
class Pushing : public ::testing::Test {
 protected:
  static constexpr double kStiffness = 700, kFriction = 0.45 * 0.3 * 9.81;  // [N/m], [N]
  using Rigid = StiffnessReduction::RigidTouch;

  void go(double speed, int ticks) {
    for (int i = 0; i < ticks; ++i) {
      x_ += speed;
      reduction_.move({x_, 0, 0});
    }
  }
  static Rigid moving(double stretch, double resistance = kFriction) {
    return {.stretch = {stretch, 0, 0},
            .normal = {-1, 0, 0},
            .coupling = kStiffness,
            .moves = true,
            .external = {-resistance, 0, 0},
            .others = {},
            .hold = {0, 0, kFriction}};
  }
  static Rigid standing(double stretch) {
    Rigid out = moving(stretch);
    out.moves = false;
    out.external = {};
    return out;
  }
  double x_ = 0;
  StiffnessReduction reduction_ = StiffnessReduction::create({.most_delay = 200, .filter = 1}).value();
};

/// Thesis 4.30; 0.3 kg, mu 0.45, 700 N/m at 0.1 m/s and 50 ms: 207 N/m with the damping of the block.
TEST_F(Pushing, AtConstantSpeedTheForceIsThatWithoutDelay) {
  go(1e-4, 300);
  const double resistance = kFriction + 0.3 * 5 * 0.1;  // b_o = m (1 - d)/T_s = 1.5 N s/m
  const double stretch = resistance / kStiffness + 0.005;
  const double k = reduction_.reduced(moving(stretch, resistance), 50);
  EXPECT_NEAR(k * stretch, resistance, 1e-12);
  EXPECT_NEAR(k, kStiffness * resistance / (resistance + kStiffness * 0.005), 1e-9) << "4.30";
  EXPECT_NEAR(k, 207, 1);
}

/// Lines 2 to 8 of algorithm 1.
TEST_F(Pushing, AsPrintedTheStiffnessFollowsTheDevicesVelocity) {
  reduction_ = StiffnessReduction::create({.most_delay = 200, .as_printed = true, .filter = 1}).value();
  go(1e-4, 300);
  const double resistance = kFriction + 0.3 * 5 * 0.1, stretch = resistance / kStiffness + 0.001;
  const double reduced = kStiffness * resistance / (resistance + kStiffness * 50 * 1e-4);
  EXPECT_NEAR(reduction_.reduced(moving(stretch, resistance), 50), reduced, 1e-9) << "4.30, whatever the stretch holds";
  EXPECT_NEAR(reduced, 207, 1);
  EXPECT_NEAR(reduction_.reduced(moving(stretch, resistance), 100),
              kStiffness * resistance / (resistance + kStiffness * 100 * 1e-4), 1e-9);
  Rigid outpushed = moving(stretch);
  outpushed.others = {2 * kFriction, 0, 0};
  EXPECT_EQ(reduction_.reduced(outpushed, 50), kStiffness) << "line 3";
  go(0, 8);
  EXPECT_EQ(reduction_.reduced(moving(stretch, resistance), 50), kStiffness)
      << "a device that stands still leaves nothing behind";
}

TEST_F(Pushing, AsPrintedARestingObjectIsStiffUntilItsFrictionIsExceeded) {
  reduction_ = StiffnessReduction::create({.most_delay = 200, .as_printed = true, .filter = 1}).value();
  go(1e-4, 300);
  EXPECT_EQ(reduction_.reduced(standing(0.9 * kFriction / kStiffness), 50), kStiffness) << "line 8: nothing was rendered yet";
  EXPECT_EQ(reduction_.reduced(standing(1.1 * kFriction / kStiffness), 50), kStiffness) << "line 8: less than the friction was";
  const double reduced = kStiffness * kFriction / (kFriction + kStiffness * 50 * 1e-4);
  EXPECT_NEAR(reduction_.reduced(standing(1.1 * kFriction / kStiffness), 50), reduced, 1e-9) << "line 7";
  reduction_.release();
  EXPECT_EQ(reduction_.reduced(standing(1.1 * kFriction / kStiffness), 50), kStiffness) << "another contact";
}

TEST_F(Pushing, AsPrintedTheFilterBeginsWithTheOriginalStiffness) {
  reduction_ = StiffnessReduction::create({.most_delay = 200, .as_printed = true}).value();
  go(1e-4, 300);
  const double reduced = kStiffness * kFriction / (kFriction + kStiffness * 50 * 1e-4);
  EXPECT_NEAR(reduction_.reduced(moving(0.01), 50), 0.01 * reduced + 0.99 * kStiffness, 1e-9);
}

/// While it gains speed it takes more than it resists with: the fraction of that which 4.30 leaves.
TEST_F(Pushing, WhoSetsAMassInMotionFeelsSomeOfItsInertia) {
  go(1e-4, 300);
  const double stretch = (kFriction + 0.6) / kStiffness + 0.005;
  const double force = reduction_.reduced(moving(stretch), 50) * stretch;
  EXPECT_GT(force, kFriction + 0.1);
  EXPECT_LT(force, kFriction + 0.6);
}

TEST_F(Pushing, WithoutDelayOrAtRestNothingIsReduced) {
  go(1e-4, 300);
  EXPECT_EQ(reduction_.reduced(moving(0.007), 0), kStiffness);
  go(0, 300);
  EXPECT_EQ(reduction_.reduced(moving(0.007), 50), kStiffness);
}

TEST_F(Pushing, WhatOthersPushAwayIsNotRendered) {
  go(1e-4, 300);
  EXPECT_EQ(reduction_.reduced(moving(0.004, -1), 50), 0);
  Rigid flat = moving(0.004, 0);
  flat.hold = {kFriction, 0, 0};
  EXPECT_EQ(reduction_.reduced(flat, 50), kStiffness) << "but it cannot run away into what holds it";
}

TEST_F(Pushing, WhoLetsGoFeelsTheWholeStiffness) {
  go(-1e-4, 300);
  EXPECT_EQ(reduction_.reduced(moving(0.007), 50), kStiffness);
}

/// Another user holds the block from the other side with 4 N: it stands still until both friction and user are overcome.
TEST_F(Pushing, WhatAnotherUserHoldsIsNotSoftened) {
  go(1e-4, 300);
  Rigid held = standing((kFriction + 3.9) / kStiffness);
  held.others = {-4, 0, 0};
  EXPECT_EQ(reduction_.reduced(held, 50), kStiffness);
}

TEST_F(Pushing, BeforeTheFrictionIsOvercomeTheStiffnessStays) {
  for (double stretch = 0; stretch < kFriction / kStiffness; stretch += 1e-4) {
    go(1e-4, 1);
    EXPECT_EQ(reduction_.reduced(standing(stretch), 50), kStiffness);
  }
}

/// The object stands still as far as the client knows: the force stays what overcomes the friction, and does not break down.
TEST_F(Pushing, WhileTheStartIsInFlightTheForceIsTheFriction) {
  go(1e-4, 300);
  for (double stretch = kFriction / kStiffness + 1e-9; stretch < 0.0068; stretch += 1e-4) {
    go(1e-4, 1);
    EXPECT_NEAR(reduction_.reduced(standing(stretch), 50) * stretch, kFriction, 1e-6) << stretch;
  }
}

TEST_F(Pushing, AFaceThatLiesOnWhatHoldsTheObjectKeepsItsStiffness) {
  go(1e-4, 300);
  Rigid touch = moving(0.007);
  touch.hold = {-kFriction, 0, 0};
  EXPECT_NEAR(reduction_.reduced(touch, 50), kStiffness, 1e-9) << "beta 0";
  touch.hold = {kFriction, 0, kFriction};  // 45 degrees: beta 1/2
  const double excess = std::min(0.005, 0.007 - kFriction / kStiffness);
  EXPECT_NEAR(reduction_.reduced(touch, 50), kStiffness * kFriction / (kFriction + 0.5 * kStiffness * excess), 1e-9);
  touch.hold = {};
  touch.stretch.x = 0.0068;
  EXPECT_NEAR(reduction_.reduced(touch, 50) * 0.0068, kFriction, 1e-9) << "nothing holds it: it can go anywhere";
}

TEST_F(Pushing, NoForceIsReducedBelowWhatItShouldBe) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> any(0, 1);
  for (int i = 0; i < 10'000; ++i) {
    go(2e-4 * (any(random) - 0.3), 1);
    const double stretch = 0.02 * any(random), due = 3 * any(random);
    const double k = reduction_.reduced(moving(stretch, due), static_cast<std::uint32_t>(200 * any(random)));
    EXPECT_LE(k, kStiffness);
    EXPECT_GE(k * stretch, std::min(due, kStiffness * stretch) - 1e-9) << "at most down to what is due";
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
    const double displacement = 0.01 * std::max(9 - i, 0);
    const double wanted = displacement >= 0.01 ? kLeast : kCoupling;
    mean = 0.01 * wanted + 0.99 * mean;
    EXPECT_NEAR(reduction.reduced(touch, 10), mean, 1e-9) << i;
  }
  reduction.release();
  EXPECT_EQ(reduction.reduced(touch, 10), kCoupling);
}

/// lambda of the step from the first value of a contact to the second, of touches that want k and then less.
TEST(StiffnessReduction, WithoutAFilterItGoesByWhatIsTouched) {
  using Rigid = StiffnessReduction::RigidTouch;
  const auto lambda = [](const auto& touch, double wanted) {
    auto reduction = StiffnessReduction::create({.most_delay = 10}).value();
    reduction.move({});
    EXPECT_EQ(reduction.reduced(touch, 10), touch.coupling) << "nothing has moved";
    for (int i = 1; i <= 10; ++i) reduction.move({0, 0, -0.001 * i});
    return (touch.coupling - reduction.reduced(touch, 10)) / (touch.coupling - wanted);
  };
  const Touch yields{{0, 0, -0.01}, {0, 0, 1}, kCoupling, kObject};
  EXPECT_NEAR(lambda(yields, kLeast), 0.1, 1e-9);
  // It goes down with 1 N against it, and lies on nothing: of the stretch of 10 mm all but what 1 N needs is behind.
  Rigid alone{.stretch = {0, 0, -0.01},
              .normal = {0, 0, 1},
              .coupling = 500,
              .moves = true,
              .external = {0, 0, 1},
              .others = {},
              .hold = {}};
  const double behind = 0.01 - 1.0 / 500, wanted = 500 / (1 + 500 * behind);
  EXPECT_NEAR(lambda(alone, wanted), 0.1, 1e-9);
  alone.others = {0, 0, 1e-12};
  EXPECT_NEAR(lambda(alone, wanted), 0.03, 1e-9);
}

TEST(StiffnessReduction, ATickAllocatesNothing) {
  auto reduction = StiffnessReduction::create({}).value();
  const std::uint64_t before = testing::allocated_bytes();
  for (int i = 0; i < 3000; ++i) {
    reduction.move({0, 0, -1e-5 * i});
    (void)reduction.reduced(StiffnessReduction::DeformableTouch{{0, 0, -0.01}, {0, 0, 1}, kCoupling, kObject}, 80);
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
