// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/user/passivity.h>

#include <gtest/gtest.h>

#include <cmath>

namespace tactus::sim {
namespace {

constexpr double kTick = 1e-3;
constexpr double kStiffness = 1000;

/// A wall at x = 0 that pushes towards +x, without any loss.
Vec3 wall(const Vec3& position) { return {position.x < 0 ? -kStiffness * position.x : 0, 0, 0}; }

/// Thesis figure 2.2b: pressed and released at constant speed, the held force gives away k d X per stroke.
TEST(PassivityObserver, SampledSpringGivesAwayStiffnessTimesStepTimesDepth) {
  for (const double step : {1e-3, 1e-4, 1e-5}) {  // 1 m/s, 0.1 m/s, 0.01 m/s at 1 kHz
    constexpr double kDepth = 0.01;
    const int ticks = static_cast<int>(std::lround(kDepth / step));
    PassivityObserver port;
    double pressed = 0;
    for (int i = 0; i <= 2 * ticks; ++i) {
      const Vec3 position{-step * (i <= ticks ? i : 2 * ticks - i), 0, 0};
      port.arrive(position);
      if (i == ticks) pressed = port.energy();
      port.hold(wall(position));
    }
    const double half = 0.5 * kStiffness * kDepth * kDepth, leak = kStiffness * step * kDepth;
    EXPECT_NEAR(pressed, half - 0.5 * leak, 1e-12) << "stored on the way in: the hold is too weak";
    EXPECT_NEAR(port.energy(), -leak, 1e-12);
    EXPECT_EQ(port.lowest(), port.energy());
    EXPECT_GE(port.violations(), 1u);
  }
}

TEST(PassivityObserver, SlowStrokesInManyTicksApproachTheLosslessSpring) {
  PassivityObserver port;
  for (int i = 0; i <= 200'000; ++i) {
    const Vec3 position{-0.01 * std::sin(3.141592653589793 * i / 200'000), 0, 0};
    port.arrive(position);
    port.hold(wall(position));
  }
  EXPECT_NEAR(port.energy(), 0, 2e-6) << "of 50 mJ stored in between";
}

struct Bounce {
  double first_speed = 0, last_speed = 0;  // away from the wall after the first and the last bounce
  double lowest = 0;
};

/// A mass that a constant force drives against the wall; between ticks it moves exactly under the held force.
template <class Show>
Bounce bounce(double mass, int bounces, Show&& show) {
  Bounce out;
  double x = 0.005, v = -0.2;
  PassivityObserver port;
  for (int tick = 0, seen = 0; tick < 200'000 && seen < bounces; ++tick) {
    port.arrive({x, 0, 0});
    const Vec3 force = show(Vec3{x, 0, 0}, wall({x, 0, 0}));
    port.hold(force);
    const double acceleration = (force.x - 1.0) / mass;
    const double before = x;
    x += v * kTick + 0.5 * acceleration * kTick * kTick;
    v += acceleration * kTick;
    if (before < 0 && x >= 0) {
      if (++seen == 1) out.first_speed = v;
      out.last_speed = v;
    }
  }
  out.lowest = port.lowest();
  return out;
}

TEST(PassivityController, TakesBackWhatTheSampledSpringGivesAway) {
  constexpr double kMass = 0.1;
  const Bounce free = bounce(kMass, 20, [](const Vec3&, const Vec3& force) { return force; });
  EXPECT_GT(free.last_speed, 1.5 * free.first_speed) << "bounces faster and faster";
  EXPECT_LT(free.lowest, -1e-3);

  PassivityController controller({.tick = kTick, .max_damping = kMass / kTick});
  const Bounce held =
      bounce(kMass, 20, [&](const Vec3& position, const Vec3& force) { return controller.limit(position, force); });
  const double start = std::sqrt(0.2 * 0.2 + 2 * 0.005 * 1.0 / kMass);  // speed at the wall when it first gets there
  EXPECT_LE(held.last_speed, 1.01 * start);
  EXPECT_GT(held.last_speed, 0.5 * start) << "takes away no more than was given";
  EXPECT_GT(held.lowest, 0.02 * free.lowest);
}

TEST(PassivityController, LeavesAPassiveEnvironmentAlone) {
  PassivityController controller({.tick = kTick});
  for (int i = 0; i < 2000; ++i) {  // a damper that the hold makes no stronger: moved at constant speed
    const Vec3 position{1e-5 * i, 2e-5 * i, 0}, force{-0.02, -0.04, 0};
    ASSERT_EQ(controller.limit(position, force), force);
    ASSERT_EQ(controller.damping(), 0);
  }
  EXPECT_GT(controller.port().energy(), 0);
  EXPECT_EQ(controller.port().violations(), 0u);
}

TEST(PassivityController, DampingStaysBelowItsLimit) {
  PassivityController controller({.tick = kTick, .max_damping = 5});
  for (int i = 0; i < 100; ++i) {
    const Vec3 position{1e-4 * i, 0, 0};
    const Vec3 shown = controller.limit(position, {3, 0, 0});  // pulls the hand along: as active as can be
    ASSERT_LE(controller.damping(), 5);
    ASSERT_GE(shown.x, 3 - 5 * 0.1 - 1e-12);
  }
  EXPECT_GT(controller.port().violations(), 90u);
  EXPECT_NEAR(controller.port().energy(), -(3 + 98 * 2.5) * 1e-4, 2e-5);
}

TEST(PassivityController, ForgetsWhatItIsAskedToForget) {
  PassivityController capped({.tick = kTick, .max_stored = 1e-5});
  PassivityController reset({.tick = kTick, .reset_after = 0.1});
  const auto drive = [](PassivityController& controller, int from, int to, double force) {
    for (int i = from; i < to; ++i) controller.limit({1e-4 * i, 0, 0}, {force, 0, 0});
  };
  drive(capped, 0, 1000, -1);
  EXPECT_LE(capped.port().energy(), 1e-5);
  drive(reset, 0, 1000, -1);
  EXPECT_NEAR(reset.port().energy(), 999e-4, 1e-9);
  drive(reset, 1000, 1099, 0);
  EXPECT_NEAR(reset.port().energy(), 1000e-4, 1e-9) << "not free for long enough";
  drive(reset, 1099, 1102, 0);
  EXPECT_EQ(reset.port().energy(), 0);
}

}  // namespace
}  // namespace tactus::sim
