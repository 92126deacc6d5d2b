// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/encoder_choices.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/unit/rigid_fixture.h"

namespace tactus {
namespace {

using testing::scene_of;

/// Of an object with these velocities along x, and about z.
Acceleration::Motion after(std::array<std::int64_t, 3> ticks, std::array<double, 3> velocities, std::uint32_t tick_rate = 1000) {
  SceneSpec spec = testing::spec_of(1);
  spec.tick_rate = tick_rate;
  const SharedScene scene = testing::shared(spec);
  Acceleration acceleration(*scene);
  for (std::size_t i = 0; i < 3; ++i) {
    const RigidSample sample{{}, {velocities[i], 0, 0}, {0, 0, 2 * velocities[i]}};
    acceleration.read(ticks[i], {&sample, 1});
  }
  return acceleration.of(0);
}

TEST(Acceleration, IsTheSmallerOfTheLastTwoDifferences) {
  EXPECT_NEAR(after({7, 8, 9}, {0, 0.01, 0.02}).linear.x, 10, 1e-9);
  EXPECT_NEAR(after({7, 8, 9}, {0, 0.01, 0.02}).angular.z, 20, 1e-9);
  EXPECT_NEAR(after({7, 8, 9}, {0, -0.01, -0.03}).linear.x, -10, 1e-9);
  EXPECT_NEAR(after({0, 5, 10}, {0, 0.03, 0.04}).linear.x, 2, 1e-9) << "ticks between count";
  EXPECT_EQ(after({7, 8, 9}, {0, 0.01, 0.02}).linear.y, 0);
}

/// A kick, a pause and noise that turns around in every tick say nothing of the velocity to come.
TEST(Acceleration, IsNothingWhereTheLastTwoTicksDoNotAgreeOrAreLongAgo) {
  EXPECT_EQ(after({7, 8, 9}, {0, 0, 0.02}).linear, Vec3{});
  EXPECT_EQ(after({7, 8, 9}, {0, 0.02, 0.01}).linear, Vec3{});
  EXPECT_EQ(after({7, 8, 90}, {0, 0.01, 0.02}).linear, Vec3{});
  EXPECT_EQ(after({7, 8, 9}, {0, 0.01, 0.02}, 148).linear, Vec3{}) << "a third of the time in which it fades has passed";
  const SharedScene scene = scene_of(1);
  Acceleration fresh(*scene);
  const RigidSample first{{}, {1, 2, 3}, {4, 5, 6}};
  fresh.read(100, {&first, 1});
  EXPECT_EQ(fresh.of(0).linear, Vec3{});
  EXPECT_EQ(fresh.of(0).angular, Vec3{});
}

/// By integrating a e^(-t/tau) twice in small steps.
TEST(Acceleration, DepartureIsThatOfAFadingAcceleration) {
  double velocity = 0, place = 0;
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 100000; ++i) {
    velocity += kStep * std::exp(-(i + 0.5) * kStep / Acceleration::kFade);
    place += kStep * velocity;
  }
  EXPECT_NEAR(Acceleration::departure(0.1), place, 1e-4 * place);
  EXPECT_EQ(Acceleration::departure(0), 0);
}

}  // namespace
}  // namespace tactus
