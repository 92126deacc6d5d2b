// SPDX-License-Identifier: Apache-2.0
/// Predictors of rigid objects.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <tactus/base/fixed.h>
#include <tactus/client/replica.h>
#include <tactus/rigid/rigid_predictor.h>
#include "tests/property/allocated.h"
#include "tests/unit/driven_fixture.h"
#include "tests/unit/rigid_fixture.h"

namespace tactus {
namespace {

using testing::contact_at;
using testing::driven_scene;
using testing::driven_state;
using testing::held_at;
using testing::kGround;
using testing::kHold;
using testing::kInertia;
using testing::kLoss;
using testing::kMass;
using testing::kPush;
using testing::kWeight;
using testing::path_along;

// ==== rigid predictor ====

constexpr double kGravity = 9.81, kFriction = 0.25, kDeceleration = kGravity * kFriction;

SharedScene with_motion(std::uint8_t dof = Dof::all) {
  return SceneBuilder().rigid("o", {}, {.dof = dof}).motion({{0, 0, -kGravity}, kFriction}).build().value();
}

RigidState state_of(const Scene& scene, Predictor predictor, const RigidSample& sample, std::int64_t tick = 0) {
  RigidState out = to_grid(sample, tick, scene.grid).value();
  out.predictor = predictor;
  return out;
}

double metres(std::int32_t grid, const Scene& scene) { return std::ldexp(grid, -scene.grid.position); }
double speed(std::int32_t grid, const Scene& scene) { return std::ldexp(grid, -scene.grid.velocity); }

TEST(RigidPredictor, FreeFallFollowsTheParabola) {
  const SharedScene scene = with_motion();
  const RigidPredictor predictor(*scene);
  const RigidState state = state_of(*scene, Predictor::ballistic, {{{1, 2, 3}, {}}, {0.5, -0.25, 4}, {0, 0, 3}});
  for (std::int64_t tick : {1, 7, 50, 333, 1000, 2000}) {
    const double t = 1e-3 * static_cast<double>(tick);
    const RigidPose pose = predictor.pose(state, tick);
    EXPECT_NEAR(metres(pose.position[0], *scene), 1 + 0.5 * t, 1e-6) << tick;
    EXPECT_NEAR(metres(pose.position[2], *scene), 3 + 4 * t - kGravity / 2 * t * t, 2e-5) << tick;
    RigidState linear = state;
    linear.predictor = Predictor::linear;
    EXPECT_EQ(pose.rotation, predictor.pose(linear, tick).rotation);
    const RigidMotion motion = predictor.motion(state, tick, {});
    EXPECT_NEAR(speed(motion.velocity[2], *scene), 4 - kGravity * t, 2e-5) << tick;
    EXPECT_EQ(motion.velocity[0], state.velocity[0]);
    EXPECT_EQ(motion.angular_velocity, state.angular_velocity);
  }
  EXPECT_EQ(predictor.pose(state, 2000).position, predictor.pose(state, 99999).position) << "after max_extrapolation";
  EXPECT_EQ(predictor.motion(state, 2000, {}).velocity, predictor.motion(state, 99999, {}).velocity);
}

/// Velocity and spin fall to 0 together at T = |v| / deceleration; nothing turns around.
TEST(RigidPredictor, SlidingComesToRest) {
  const SharedScene scene = with_motion();
  const RigidPredictor predictor(*scene);
  const RigidState state = state_of(*scene, Predictor::slide, {{{1, 2, 3}, {}}, {0.3, -0.4, 0}, {0, 0, 2}});
  const double rest = 0.5 / kDeceleration;  // 204 ms
  for (std::int64_t tick : {1, 10, 100, 203, 204, 205, 500, 2000}) {
    const double t = std::min(1e-3 * static_cast<double>(tick), rest), part = t - t * t / (2 * rest);
    const RigidPose pose = predictor.pose(state, tick);
    EXPECT_NEAR(metres(pose.position[0], *scene), 1 + 0.3 * part, 1e-5) << tick;
    EXPECT_NEAR(metres(pose.position[1], *scene), 2 - 0.4 * part, 1e-5) << tick;
    EXPECT_NEAR(2 * std::asin(std::ldexp(pose.rotation[3], -30)), 2 * part, 1e-4) << tick;
    const RigidMotion motion = predictor.motion(state, tick, {});
    EXPECT_NEAR(speed(motion.velocity[1], *scene), -0.4 * (1 - t / rest), 5e-5) << tick;
    EXPECT_NEAR(std::ldexp(motion.angular_velocity[2], -scene->grid.angular_velocity), 2 * (1 - t / rest), 5e-4) << tick;
  }
  EXPECT_EQ(predictor.pose(state, 206), predictor.pose(state, 99999)) << "it rests";
  EXPECT_EQ(predictor.motion(state, 206, {}).velocity, Vec3i{});
}

TEST(RigidPredictor, WhatOnlyTurnsRestsAtOnce) {
  const SharedScene scene = with_motion();
  const RigidState state = state_of(*scene, Predictor::slide, {{{1, 2, 3}, {}}, {}, {0, 0, 2}});
  EXPECT_EQ(RigidPredictor(*scene).pose(state, 30), (RigidPose{state.position, state.rotation}));
  EXPECT_EQ(RigidPredictor(*scene).motion(state, 30, {}).angular_velocity, Vec3i{});
}

/// Where B is what A predicts, the gap adds nothing.
TEST(RigidPredictor, ACurveBeginsWithThePredictorOfItsUpdate) {
  const SharedScene scene = with_motion();
  const RigidPredictor predictor(*scene);
  for (const Predictor chosen : {Predictor::linear, Predictor::ballistic, Predictor::slide}) {
    const RigidState a = state_of(*scene, chosen, {{{1, 2, 3}, {}}, {0.3, -0.4, 1}, {0, 1, 2}});
    const RigidPose end = predictor.pose(a, 250);
    const RigidMotion motion = predictor.motion(a, 250, {});
    const RigidState b{250, end.position, end.rotation, motion.velocity, motion.angular_velocity};
    for (std::int64_t tick = 0; tick < 250; tick += 10) {
      const RigidPose across = interpolate_gap(*scene, a, b, tick), predicted = predictor.pose(a, tick);
      for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(across.position[i], predicted.position[i], 2) << tick;
      for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(across.rotation[i], predicted.rotation[i], 64) << tick;
    }
  }
}

// ==== rigid driven body ====

constexpr double kTick = 1e-3;
constexpr double kFace = -164.0 / 8192;  // [m] of the cube, on the grid of contacts

Pose shown(const SharedScene& scene, const DevicePath& path, const RigidState& state, std::int64_t tick) {
  return to_pose(DrivenBody().pose(*scene, 0, path, state, tick), scene->grid.position);
}

/// The same in floating point, at the centre: a mass on a spring that is pulled about.
TEST(DrivenBody, WhatIsHeldHangsOnItsSpring) {
  const auto scene = driven_scene();
  const auto device = [](std::int64_t tick) { return Vec3{0.03 * std::sin(0.008 * static_cast<double>(tick)), 0, 0.02}; };
  const auto path = path_along(scene, 500, device);
  const RigidState state = driven_state(*scene, {{{}, {}}, {0.05, -0.02, 0}, {}}, held_at({}));
  DrivenBody body;
  Vec3 x, v{0.05, -0.02, 0};
  for (std::int64_t tick = 0; tick < 500; ++tick) {
    const Vec3 at = to_pose(body.pose(*scene, 0, *path, state, tick), scene->grid.position).position;
    ASSERT_LT(norm(at - x), 5e-6) << "tick " << tick;
    v = v + kTick * ((kHold / kMass) * (device(tick) - x) + Vec3{0, 0, -kWeight});
    x = x + kTick * v;
    v = (1 - kLoss) * v;
  }
  EXPECT_GT(norm(x), 0.01) << "it has moved";
}

/// Held beside its centre it swings: the spring turns it, at the rate of its moment of inertia.
TEST(DrivenBody, ASpringBesideTheCentreTurns) {
  const auto scene = driven_scene(Dof::all, {0, 0, 0});
  const auto path = path_along(scene, 10, [](std::int64_t) { return Vec3{0.02, 0.01, 0}; });
  const RigidState state = driven_state(*scene, {}, held_at({0.02, 0, 0}));
  const Pose pose = shown(scene, *path, state, 10);
  const double angular = kHold * 0.01 * 0.02 / kInertia;  // [rad/s^2]
  EXPECT_NEAR(2 * pose.rotation.z, angular * kTick * kTick * 55, 0.06 * angular * kTick * kTick * 55);
  EXPECT_NEAR(pose.rotation.x, 0, 1e-6);
  EXPECT_NEAR(pose.position.y, kHold / kMass * 0.01 * kTick * kTick * 55, 4e-6) << "the spring gets shorter";
}

/// Pushed along x on the ground: device, friction as it was at the start, and damping.
TEST(DrivenBody, WhatIsPushedFollowsTheDevice) {
  const auto scene = driven_scene();
  const double drag = 6.5;
  const auto device = [](std::int64_t tick) { return Vec3{-0.0185 + 1e-4 * static_cast<double>(tick), 0, 0}; };
  const auto path = path_along(scene, 300, device);
  const RigidState state = driven_state(*scene, {{{}, {}}, {0.08, 0, 0}, {}}, contact_at({kFace, 0, 0}, {-1, 0, 0}, drag));
  DrivenBody body;
  double x = 0, v = 0.08;
  for (std::int64_t tick = 0; tick < 300; ++tick) {
    const Vec3 at = to_pose(body.pose(*scene, 0, *path, state, tick), scene->grid.position).position;
    ASSERT_NEAR(at.x, x, 2e-5) << "tick " << tick;
    ASSERT_NEAR(at.y, 0, 1e-6);
    const double depth = std::max(0.0, device(tick).x - (x + kFace));
    v = std::max(0.0, v + kTick * (kPush / kMass * depth - drag));
    x += kTick * v;
    v *= 1 - kLoss;
  }
  EXPECT_GT(x, 0.02);
}

/// What the device takes off the load on the ground, the ground takes off its friction.
TEST(DrivenBody, TheLoadOnTheGroundChangesTheDrag) {
  const auto scene = driven_scene();
  const auto pressed = [&](double change) {  // the proxy sticks where it is, and the device rises or falls
    const auto path = path_along(scene, 40, [change](std::int64_t tick) { return Vec3{-0.017, 0, tick == 0 ? 0 : change}; });
    const RigidState state = driven_state(*scene, {{{}, {}}, {0.1, 0, 0}, {}}, contact_at({-0.02, 0, 0}, {-1, 0, 0}, 10));
    return shown(scene, *path, state, 8).position.x;
  };
  const double lifted = pressed(0.001), level = pressed(0), down = pressed(-0.001);
  const double expected = kGround * kPush / kMass * 0.001 * kTick * kTick * 28;  // 7 ticks of it
  EXPECT_NEAR(lifted - level, expected, 0.15 * expected);
  EXPECT_NEAR(level - down, expected, 0.15 * expected);
}

TEST(DrivenBody, LeftAloneItSlidesToRest) {
  const auto scene = driven_scene();
  const auto path = path_along(scene, 1, [](std::int64_t) { return Vec3{-1, 0, 0}; });
  const RigidState state = driven_state(*scene, {{{}, {}}, {0.1, 0, 0}, {}}, contact_at({-0.02, 0, 0}, {-1, 0, 0}, 5));
  EXPECT_NEAR(shown(scene, *path, state, 15).position.x, 0.1 * 0.015 - 5 * kTick * kTick * 120, 1.2e-5);
  EXPECT_EQ(shown(scene, *path, state, 100).position, shown(scene, *path, state, 1900).position);
}

TEST(DrivenBody, AScrewTurnsAndMoves) {
  const auto scene = driven_scene(Dof::all, {0, 0, 0});
  const auto path = path_along(scene, 1, [](std::int64_t) { return Vec3{-1, 0, 0}; });
  const RigidState state = driven_state(*scene, {{{}, {}}, {0, 0, 0.05}, {0, 0, 2}}, contact_at({}, {-1, 0, 0}));
  const Pose pose = shown(scene, *path, state, 100);
  const double left = (1 - std::pow(1 - kLoss, 100)) / kLoss / 100;  // mean speed
  EXPECT_NEAR(2 * std::atan2(pose.rotation.z, pose.rotation.w), 0.2 * left, 1e-4);
  EXPECT_NEAR(pose.position.z, 0.005 * left, 1e-6);
}

TEST(DrivenBody, LockedAxesStay) {
  const auto scene = driven_scene(Dof::x);
  const auto path = path_along(scene, 200, [](std::int64_t tick) {
    return Vec3{-0.018 + 1e-4 * static_cast<double>(tick), 0.003, 0.001};
  });
  for (const DrivenContact& contact : {held_at({-0.02, 0.005, 0}), contact_at({-0.02, 0.003, 0}, {-1, 0, 0})}) {
    const RigidState state = driven_state(*scene, {{{0.1, 0.2, 0.3}, {0.6, 0.8, 0, 0}}, {0.05, 0, 0}, {}}, contact);
    const RigidPose pose = DrivenBody().pose(*scene, 0, *path, state, 100);
    EXPECT_NE(pose.position[0], state.position[0]);
    EXPECT_EQ(pose.position[1], state.position[1]);
    EXPECT_EQ(pose.position[2], state.position[2]);
    EXPECT_EQ(pose.rotation, state.rotation);
  }
}

/// Looks in any order, on two objects' states: what is remembered of the last look changes nothing.
TEST(DrivenBody, TheOrderOfLooksDoesNotMatter) {
  const auto scene = driven_scene();
  const auto path = path_along(scene, 600, [](std::int64_t tick) {
    return Vec3{-0.0185 + 5e-5 * static_cast<double>(tick), 0.002, 0};
  });
  const RigidState a = driven_state(*scene, {{{}, {}}, {0.04, 0, 0}, {0, 0, 1}}, contact_at({-0.02, 0.002, 0}, {-1, 0, 0}, 3), 5);
  const RigidState b = driven_state(*scene, {{{}, {}}, {0.04, 0, 0}, {}}, held_at({0, 0, 0.02}), 30);
  DrivenBody remembers;
  std::mt19937_64 random(5);
  for (int i = 0; i < 300; ++i) {
    const RigidState& state = random() % 4 == 0 ? b : a;
    const auto tick = state.tick + static_cast<std::int64_t>(random() % 500);
    ASSERT_EQ(remembers.pose(*scene, 0, *path, state, tick), DrivenBody().pose(*scene, 0, *path, state, tick)) << tick;
  }
}

/// The path turns out to have been another one: the pose is found anew.
TEST(DrivenBody, ItLooksAgainWhenThePastChanges) {
  const auto scene = driven_scene();
  const auto path = path_along(scene, 100, [](std::int64_t tick) {
    return Vec3{-0.0185 + 1e-4 * static_cast<double>(tick), 0, 0};
  });
  const RigidState state = driven_state(*scene, {{{}, {}}, {0.04, 0, 0}, {}}, held_at({}));
  DrivenBody body;
  const RigidPose before = body.pose(*scene, 0, *path, state, 90);
  path->settle(200, [](std::uint64_t number) { return number < 85; });
  EXPECT_EQ(body.pose(*scene, 0, *path, state, 90), DrivenBody().pose(*scene, 0, *path, state, 90));
  EXPECT_NE(before, body.pose(*scene, 0, *path, state, 90));
}

TEST(DrivenBody, OfADeviceThatIsNotKnownItIsFree) {
  const auto scene = driven_scene();
  const DevicePath none(device_scene(*scene).value());
  const RigidState state = driven_state(*scene, {}, held_at({}));
  EXPECT_NEAR(shown(scene, none, state, 100).position.z, -0.5 * kWeight * 0.01, 0.002);
}

/// For anyone who does not know the device it is linear.
TEST(DrivenBody, WithoutItsDeviceAStateIsLinear) {
  const auto scene = driven_scene();
  RigidState state = driven_state(*scene, {{{}, {}}, {0.1, 0, 0.2}, {1, 2, 3}}, held_at({}));
  const RigidPredictor without(*scene);
  const RigidPose coded = without.pose(state, 70);
  EXPECT_EQ(without.shown(0, state, 70), coded);
  const auto path = path_along(scene, 100, [](std::int64_t) { return Vec3{0.05, 0, 0}; });
  const RigidPredictor predictor(*scene, path.get());
  EXPECT_NE(predictor.shown(0, state, 70), coded);
  EXPECT_EQ(predictor.pose(state, 70), coded) << "packets are coded on what every receiver knows";
  state.predictor = Predictor::linear;
  EXPECT_EQ(predictor.shown(0, state, 70), coded);
}

/// Any numbers that a packet can bring, on any grid: no overflow (the sanitizers look), and the time is bounded.
TEST(DrivenBody, AnyStateIsTaken) {
  std::mt19937_64 random(11);
  const auto any = [&random] {
    return static_cast<std::int32_t>(random() >> (32 + random() % 31)) * (random() % 2 == 0 ? 1 : -1);
  };
  const auto constant = [&random] { return 1 + static_cast<std::uint32_t>(random() % (std::uint64_t{1} << (random() % 31))); };
  for (int i = 0; i < 400; ++i) {
    SceneSpec spec;
    const auto position = static_cast<std::uint8_t>(8 + random() % 23);
    spec.grid = {position, static_cast<std::uint8_t>(position - random() % std::min<std::uint64_t>(position + 1u, 13)), 20, 12};
    spec.tick_rate = 1 + static_cast<std::uint32_t>(random() % 5000);
    spec.objects.push_back({"o", Dof::all, {}});
    spec.motion = {{any() / 16, any() / 16, -(1 << 28)}, 1 << 28};
    spec.driven = {{{constant(), constant(), {constant(), constant(), constant()}, 65535, 65535}}};
    const auto scene = Scene::create(spec);
    ASSERT_TRUE(scene) << scene.error().rule;
    DevicePath path(device_scene(spec).value());
    path.shift(0, 0);
    RigidState state;
    state.predictor = Predictor::driven;
    for (auto* v : {&state.position, &state.velocity}) *v = {any(), any(), any()};
    state.angular_velocity = {any() / 64, any() / 64, any() / 64};
    const std::int32_t point = 1 << 20;
    state.contact = {.is_held = random() % 2 == 0, .point = {any() % point, point, -point}, .normal = {any() % point, 1, -point}};
    state.contact.drag = any() % point;
    RigidState device = state;
    for (std::int32_t& c : device.position) c = saturate32(std::int64_t{c} + any() / 4);
    path.add(1, device);
    DrivenBody body;
    for (const std::int64_t tick : {0, 1, 2, 50, 1000}) body.pose(**scene, 0, path, state, tick);
  }
}

TEST(DrivenBody, ALookDoesNotAllocate) {
  const auto scene = driven_scene();
  const auto path = path_along(scene, 100, [](std::int64_t) { return Vec3{0.01, 0, 0}; });
  const RigidState state = driven_state(*scene, {}, held_at({}));
  DrivenBody body;
  const std::uint64_t before = testing::allocated_bytes();
  body.pose(*scene, 0, *path, state, 400);
  EXPECT_EQ(testing::allocated_bytes(), before);
}

}  // namespace
}  // namespace tactus
