// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/user/hand.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>

namespace tactus::sim {
namespace {

SceneUser still_user() {
  SceneUser user;
  user.name = "hand";
  user.start = {0.1, -0.2, 0.3};
  user.device.resolution = 1e-9;
  user.device.filter = 1;
  return user;
}

TEST(MinimumJerk, StartsAndEndsAtRest) {
  EXPECT_EQ(minimum_jerk(0).position, 0);
  EXPECT_EQ(minimum_jerk(1).position, 1);
  EXPECT_EQ(minimum_jerk(0).slope, 0);
  EXPECT_EQ(minimum_jerk(1).slope, 0);
  EXPECT_DOUBLE_EQ(minimum_jerk(0.5).position, 0.5);
  EXPECT_DOUBLE_EQ(minimum_jerk(0.5).slope, 1.875);
  for (int i = 1; i < 100; ++i) {
    const double s = 0.01 * i;
    EXPECT_NEAR((minimum_jerk(s + 1e-6).position - minimum_jerk(s - 1e-6).position) / 2e-6, minimum_jerk(s).slope, 1e-8);
  }
}

TEST(Random, IsUniformAndRepeats) {
  Random random(42), again(42);
  double sum = 0, squares = 0;
  constexpr int draws = 100'000;
  for (int i = 0; i < draws; ++i) {
    const double u = random.uniform(-1, 3);
    ASSERT_EQ(u, again.uniform(-1, 3));
    ASSERT_TRUE(u >= -1 && u < 3);
    sum += u;
    squares += u * u;
  }
  EXPECT_NEAR(sum / draws, 1, 0.02);
  EXPECT_NEAR(squares / draws - 1, 16.0 / 12, 0.02);
}

TEST(DeviceFilter, QuantisesAndAverages) {
  SceneDevice device;
  device.resolution = 0.055e-3;
  device.filter = 8;
  DeviceFilter filter(device, {0, 0, 0});
  EXPECT_EQ(filter.read({0.4 * device.resolution, -0.4 * device.resolution, 0}), Vec3{}) << "below half a step: nothing";
  Vec3 out;
  for (int i = 1; i <= 8; ++i) {
    out = filter.read({8.1 * device.resolution, 0, 0});
    EXPECT_NEAR(out.x, i * device.resolution, 1e-15) << "one eighth of the step enters per sample";
  }
  EXPECT_NEAR(out.x, 8 * device.resolution, 1e-15);
}

/// RMS about the mean of one axis of a hand that nothing touches.
Vec3 free_tremor(Grip grip, double rms, std::uint64_t seed) {
  SceneUser user = still_user();
  user.tremor = rms;
  Hand hand(user, grip, seed);
  constexpr int settle = 1000, ticks = 20'000;
  Vec3 sum, squares;
  for (int i = 0; i < settle + ticks; ++i) {
    hand.step({}, {});
    if (i < settle) continue;
    const Vec3 d = hand.position() - user.start;
    sum = sum + d;
    squares = squares + Vec3{d.x * d.x, d.y * d.y, d.z * d.z};
  }
  const Vec3 mean = (1.0 / ticks) * sum;
  const auto deviation = [&](double square, double m) { return std::sqrt(square / ticks - m * m); };
  return {deviation(squares.x, mean.x), deviation(squares.y, mean.y), deviation(squares.z, mean.z)};
}

TEST(Hand, FreeTremorHasTheAmplitudeAskedForInEveryGrip) {
  for (const Grip grip : {Grip::loose, Grip::normal, Grip::firm}) {
    for (const double wanted : {0.07e-3, 0.2e-3}) {
      const Vec3 rms = free_tremor(grip, wanted, 5);
      for (const double axis : {rms.x, rms.y, rms.z}) EXPECT_NEAR(axis, wanted, 0.1 * wanted);
    }
  }
  EXPECT_EQ(free_tremor(Grip::normal, 0, 5), Vec3{});
}

TEST(Hand, FollowsItsPathAndStaysAtItsEnd) {
  SceneUser user = still_user();
  user.path = {{"go", PathFrame::world, {0.2, 0, 0.1}, 0.8, false},
               {"hold", PathFrame::world, {0.2, 0, 0.1}, 0.5, true},
               {"back", PathFrame::hand, {0, 0.05, 0}, 0.5, false}};
  Hand hand(user, Grip::normal, 1);
  int pressed = 0;
  for (int i = 0; i < 1300; ++i) pressed += hand.step({}, {}).is_down(0);
  EXPECT_EQ(pressed, 500);
  EXPECT_LT(norm(hand.position() - Vec3{0.2, 0, 0.1}), 1e-4);
  for (int i = 0; i < 1500; ++i) EXPECT_FALSE(hand.step({}, {}).is_down(0));
  EXPECT_LT(norm(hand.position() - Vec3{0.2, 0.05, 0.1}), 1e-9);
}

TEST(Hand, YieldsToWhatItFeelsAccordingToItsGrip) {
  for (const Grip grip : {Grip::loose, Grip::normal, Grip::firm}) {
    Hand hand(still_user(), grip, 1);
    for (int i = 0; i < 3000; ++i) hand.step({0, 0, 2}, {});
    EXPECT_NEAR(hand.position().z - 0.3, 2 / hand_impedance(grip).stiffness, 1e-9);
  }
}

TEST(Hand, LockedAxesOfTheDeviceDoNotMove) {
  SceneUser user = still_user();
  user.tremor = 1e-4;
  user.device.axes = Dof::x | Dof::z;
  user.path = {{"go", PathFrame::world, {0.2, 0.4, 0.1}, 0.5, false}};
  Hand hand(user, Grip::loose, 1);
  for (int i = 0; i < 1000; ++i) {
    hand.step({0, 1, 0}, {});
    ASSERT_EQ(hand.position().y, user.start.y);
  }
  EXPECT_NEAR(hand.position().x, 0.2, 1e-3);
}

TEST(Hand, DurationScaleScalesTheTimeOfMovements) {
  SceneUser user = still_user(), faster = user;
  user.path =
      faster.path = {{"go", PathFrame::world, {0.2, 0.4, 0.1}, 0.8, false}, {"on", PathFrame::world, {0, 0, 0}, 0.4, true}};
  faster.duration_scale = 0.5;
  const auto presses = [](const SceneUser& of) {  // first and last tick with the button held, during the second movement
    Hand hand(of, Grip::firm, 1);
    std::array<int, 2> out{-1, -1};
    for (int i = 0; i < 2000; ++i) {
      if (hand.step({}, {}).buttons == 0) continue;
      if (out[0] < 0) out[0] = i;
      out[1] = i;
    }
    return out;
  };
  EXPECT_EQ(presses(user), (std::array{800, 1199}));
  EXPECT_EQ(presses(faster), (std::array{400, 599}));
}

TEST(Hand, SeedsMakeDifferentHandsAndVariationBoundsThem) {
  SceneUser user = still_user();
  user.variation = 0.15;
  std::set<double> stiffness;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const HandImpedance hand = Hand(user, Grip::normal, seed).impedance();
    const HandImpedance preset = hand_impedance(Grip::normal);
    EXPECT_NEAR(hand.stiffness, preset.stiffness, 0.15 * preset.stiffness);
    EXPECT_NEAR(hand.mass, preset.mass, 0.15 * preset.mass);
    EXPECT_NEAR(hand.damping, preset.damping, 0.15 * preset.damping);
    stiffness.insert(hand.stiffness);
  }
  EXPECT_EQ(stiffness.size(), 20u);
}

TEST(Waypoint, IsGivenInTheFrameOfThePhase) {
  const auto at = [](PathFrame frame, const Pose& object) {
    return waypoint(frame, {-0.1, 0.02, 0.03}, object, {1, 3, 0}, {5, 5, 5});
  };
  const auto near = [](const Vec3& a, const Vec3& b) { return norm(a - b) < 1e-12; };
  const Pose straight{{1, 2, 0.5}, {}};
  EXPECT_TRUE(near(at(PathFrame::world, straight), {-0.1, 0.02, 0.03}));
  EXPECT_TRUE(near(at(PathFrame::hand, straight), {4.9, 5.02, 5.03}));
  EXPECT_TRUE(near(at(PathFrame::object, straight), {0.9, 2.02, 0.53}));
  EXPECT_TRUE(near(at(PathFrame::toward_goal, straight), {0.98, 1.9, 0.53})) << "x of the frame is world y here";
  EXPECT_TRUE(near(at(PathFrame::at_goal, straight), {0.98, 2.9, 0.03}));
}

TEST(Waypoint, SeesACubeTheSameFromEverySide) {
  // Quarter turns about any axis bring a cube onto itself: the aim must not change.
  const Pose straight{{}, {}};
  const Vec3 aim{-0.1, 0.02, 0.03};
  const Vec3 expected = waypoint(PathFrame::object, aim, straight, {}, {});
  const double h = std::sqrt(0.5);
  for (const Quat& turn :
       {Quat{h, h, 0, 0}, Quat{h, 0, h, 0}, Quat{h, 0, 0, h}, Quat{0, 1, 0, 0}, Quat{0, 0, 0, 1}, Quat{h, 0, 0, -h}})
    EXPECT_LT(norm(waypoint(PathFrame::object, aim, {{}, turn}, {}, {}) - expected), 1e-12);
  const Quat yaw{std::cos(0.2), 0, 0, std::sin(0.2)};
  EXPECT_LT(norm(waypoint(PathFrame::object, aim, {{}, yaw * Quat{h, h, 0, 0}}, {}, {}) - rotate(yaw, expected)), 1e-12);
}

TEST(Spiral, RadiusAngleAndHeightChangeEvenly) {
  const Vec3 from{0.03, 0.01, 0.02}, to{-0.04, 0.01, -0.01}, centre{0.01, 0.01, 5};
  const Spiral spiral(from, to, centre, -2);
  EXPECT_LT(norm(spiral.at(0).position - from), 1e-15);
  EXPECT_LT(norm(spiral.at(1).position - to), 1e-15);
  double turned = 0;
  constexpr int kSteps = 1000;
  for (int i = 0; i < kSteps; ++i) {
    const double fraction = (i + 0.5) / kSteps, half = 0.5 / kSteps;
    const Vec3 before = spiral.at(fraction - half).position, after = spiral.at(fraction + half).position,
               now = spiral.at(fraction).position;
    EXPECT_NEAR(std::hypot(now.x - centre.x, now.y - centre.y), 0.02 + 0.03 * fraction, 1e-15);
    EXPECT_NEAR(now.z, 0.02 - 0.03 * fraction, 1e-15);
    EXPECT_LT(norm(static_cast<double>(kSteps) * (after - before) - spiral.at(fraction).velocity), 1e-4)
        << "velocity is the slope";
    const Vec3 a = before - centre, b = after - centre;
    turned += std::atan2(a.x * b.y - a.y * b.x, a.x * b.x + a.y * b.y);
  }
  EXPECT_NEAR(std::abs(turned), 2 * 2 * std::numbers::pi - std::numbers::pi, 1e-9) << "two turns back, half a one forward";
}

TEST(Spiral, HandFollowsIt) {
  SceneUser user;
  user.start = {0.05, 0, 0};
  user.path = {{"round", PathFrame::world, {0.05, 0, 0}, 4, false, 1, {}}};
  Hand hand(user, Grip::firm, 1);
  double nearest = 1, farthest = 0;
  for (int tick = 0; tick < 4000; ++tick) {
    hand.step({}, {});
    const double radius = norm(hand.position());
    nearest = std::min(nearest, radius);
    farthest = std::max(farthest, radius);
  }
  EXPECT_GT(nearest, 0.047);
  EXPECT_LT(farthest, 0.053);
  EXPECT_LT(norm(hand.position() - user.start), 0.005);
}

}  // namespace
}  // namespace tactus::sim
