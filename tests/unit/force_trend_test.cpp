// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/encoder_choices.h>

#include <array>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/rigid_fixture.h"

namespace tactus {
namespace {

constexpr double kStiffness = 1000;

/// Of an object that a probe presses with these forces [N]; less than 0: it does not touch.
double sinking(std::array<std::int64_t, 3> ticks, std::array<double, 3> forces) {
  const SharedScene scene = testing::scene_of(2);
  ForceTrend trend(*scene);
  const std::vector<RigidSample> samples(2);
  for (std::size_t i = 0; i < 3; ++i) {
    Contact contact = testing::touch(1, {}, forces[i] / kStiffness, kStiffness);
    if (forces[i] < 0) contact.kind = ContactKind::none;
    trend.read(ticks[i], samples, {&contact, 1});
  }
  EXPECT_EQ(trend.sinking(0), 0) << "of another object";
  return trend.sinking(1);
}

TEST(ForceTrend, IsWhatTheLastTwoTicksTook) {
  EXPECT_NEAR(sinking({7, 8, 9}, {0.5, 0.46, 0.4}), 0.1 / 0.4 / 0.002, 1e-6);
  EXPECT_NEAR(sinking({1, 5, 9}, {0.5, 0.5, 0.4}), 0.1 / 0.4 / 0.008, 1e-6) << "ticks between count";
  EXPECT_NEAR(sinking({0, 5, 10}, {0.5, 0.5, 0.4}), 0.1 / 0.4 / 0.01, 1e-6) << "the longest that counts";
}

TEST(ForceTrend, IsNothingWhereTheForceGrowsBeginsOrWasLongAgo) {
  EXPECT_EQ(sinking({7, 8, 9}, {0.4, 0.6, 0.5}), 0);
  EXPECT_EQ(sinking({7, 8, 9}, {-1, 0.5, 0.4}), 0);
  EXPECT_EQ(sinking({7, 8, 9}, {0.5, 0.4, -1}), 0);
  EXPECT_EQ(sinking({7, 8, 9}, {0.5, 0.4, 0}), 0) << "nothing is left to sink";
  EXPECT_EQ(sinking({0, 5, 11}, {0.5, 0.45, 0.4}), 0);
  EXPECT_EQ(ForceTrend(*testing::scene_of(1)).sinking(0), 0);
}

TEST(ForceTrend, TheLeastOfTheForcesCounts) {
  const SharedScene scene = testing::scene_of(1);
  ForceTrend trend(*scene);
  const RigidSample sample;
  for (std::int64_t tick = 0; tick < 3; ++tick) {
    const double lost = 0.02 * static_cast<double>(tick);
    const std::array contacts{testing::touch(0, {}, (2 - 5 * lost) / kStiffness, kStiffness),
                              testing::touch(0, {}, (0.3 - lost) / kStiffness, kStiffness)};
    trend.read(tick, {&sample, 1}, contacts);
  }
  EXPECT_NEAR(trend.sinking(0), 0.04 / 0.26 / 0.002, 1e-6);
}

}  // namespace
}  // namespace tactus
