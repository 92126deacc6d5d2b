// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/msd/msd.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "tests/property/allocated.h"

namespace tactus::sim {
namespace {

constexpr MsdObject kObject{.stiffness = 100, .damping = 1, .mass = 0.01};

MsdLoopOptions one_user(std::uint32_t divider) {
  MsdLoopOptions out{.object = kObject, .divider = divider, .users = {}};
  out.users.push_back({.server_stiffness = 200, .client_stiffness = 300, .client_damping = 2});
  return out;
}

TEST(MsdModel, SolvesItsDifferenceEquation) {
  constexpr double kPeriod = 0.01;
  MsdModel model(kObject, kPeriod);
  double x1 = 0, x2 = 0;
  for (int n = 0; n < 50; ++n) {
    const double f = std::sin(0.3 * n), x = model.step(f);
    const double acceleration = (x - 2 * x1 + x2) / (kPeriod * kPeriod), velocity = (x - x1) / kPeriod;
    ASSERT_NEAR(kObject.mass * acceleration + kObject.damping * velocity + kObject.stiffness * x, f, 1e-12);
    x2 = x1;
    x1 = x;
  }
}

TEST(MsdLoop, RestsWhereTheSpringsBalance) {
  MsdLoop loop(one_user(10));
  for (int i = 0; i < 3000; ++i) loop.step(std::array{1e-3});
  const double surface = 1e-3 * 200 / 300;
  EXPECT_NEAR(loop.surface(), surface, 1e-12);
  EXPECT_NEAR(loop.felt(0), -300 * (1e-3 - surface), 1e-9);
}

TEST(MsdLoop, TheSurfaceMovesOncePerPeriodAndOnePeriodLate) {
  MsdLoop loop(one_user(10));
  MsdModel model(kObject, 0.01);
  double expected = 0;
  for (int tick = 0; tick < 200; ++tick) {
    loop.step(std::array{1e-3});
    ASSERT_NEAR(loop.surface(), expected, 1e-15) << tick;
    if (tick % 10 == 9) expected = model.step(200 * (1e-3 - expected));
  }
}

TEST(MsdLoop, TheMeanOfAPeriodCounts) {
  MsdLoopOptions options = one_user(4);
  MsdLoop mean(options);
  options.decimator = Decimator::last;
  MsdLoop last(options);
  for (int tick = 0; tick < 5; ++tick) {
    const std::array device{tick < 2 ? 2e-3 : 0.0};
    mean.step(device);
    last.step(device);
  }
  EXPECT_NEAR(mean.surface(), MsdModel(kObject, 4e-3).step(0.5 * 200 * 2e-3), 1e-15);
  EXPECT_EQ(last.surface(), 0);
}

TEST(MsdLoop, DelaysShiftTheirChannels) {
  MsdLoopOptions options = one_user(1);
  MsdLoop direct(options);
  options.users[0].to_server = 7;
  options.users[0].from_server = 5;
  MsdLoop delayed(options);
  std::vector<double> surfaces;
  for (int tick = 0; tick < 60; ++tick) {
    direct.step(std::array{1e-3});
    delayed.step(std::array{1e-3});
    surfaces.push_back(direct.surface());
    if (tick < 7) ASSERT_EQ(delayed.surface(), 0) << tick;
    else ASSERT_EQ(delayed.surface(), surfaces[static_cast<std::size_t>(tick - 7)]) << tick;
    const double seen = tick < 12 ? 0 : surfaces[static_cast<std::size_t>(tick - 12)];
    const double before = tick < 13 ? 0 : surfaces[static_cast<std::size_t>(tick - 13)];
    const double rate = tick == 0 ? 1 : (before - seen) / 1e-3;  // of the penetration
    ASSERT_NEAR(delayed.felt(0), -(300 * (1e-3 - seen) + 2 * rate), 1e-12) << tick;
  }
}

TEST(MsdLoop, ALinearApproachEndsWithThePeriod) {
  MsdLoopOptions options = one_user(10);
  options.client = Approach::linear;
  options.users[0].client_damping = 0;
  MsdLoop loop(options);
  for (int tick = 0; tick < 10; ++tick) loop.step(std::array{1e-3});
  const double felt = loop.felt(0);
  for (int tick = 1; tick <= 10; ++tick) {
    loop.step(std::array{1e-3});
    EXPECT_NEAR(loop.felt(0), felt + 300 * loop.surface() * tick / 10, 1e-12) << tick;
  }
}

TEST(MsdLoop, PressingNeverPulls) {
  MsdLoopOptions options = one_user(10);
  options.coupling = Coupling::pressing;
  MsdLoop loop(options);
  for (int tick = 0; tick < 500; ++tick) {
    loop.step(std::array{5e-3 * std::sin(0.05 * tick)});
    ASSERT_LE(loop.felt(0), 0) << tick;
  }
}

TEST(MsdLoop, AHandThatIsAwayChangesNothing) {
  MsdLoopOptions options = one_user(10);
  MsdLoop alone(options);
  options.users.push_back(options.users[0]);
  MsdLoop accompanied(options);
  for (int tick = 0; tick < 300; ++tick) {
    alone.step(std::array{1e-3});
    accompanied.step(std::array{1e-3, kAway});
    ASSERT_EQ(accompanied.surface(), alone.surface());
    ASSERT_EQ(accompanied.felt(1), 0);
  }
}

TEST(MsdLoop, StepsAllocateNothing) {
  MsdLoopOptions options = one_user(10);
  options.users[0].to_server = 50;
  MsdLoop loop(options);
  const std::uint64_t before = testing::allocated_bytes();
  for (int tick = 0; tick < 1000; ++tick) loop.step(std::array{1e-3});
  EXPECT_EQ(testing::allocated_bytes(), before);
}

}  // namespace
}  // namespace tactus::sim
