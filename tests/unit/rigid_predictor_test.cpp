// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/rigid_predictor.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include <tactus/base/fixed.h>
#include <tactus/client/replica.h>
#include "tests/unit/rigid_fixture.h"

namespace tactus {
namespace {

constexpr double kGravity = 9.81, kFriction = 0.25, kDeceleration = kGravity * kFriction;

SharedScene with_motion(std::uint8_t dof = Dof::all) {
  return SceneBuilder().rigid("o", {}, dof).motion({{0, 0, -kGravity}, kFriction}).build().value();
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

/// Where B is what A predicts, nothing bends.
TEST(RigidPredictor, ACurveBeginsWithThePredictorOfItsUpdate) {
  const SharedScene scene = with_motion();
  const RigidPredictor predictor(*scene);
  for (const Predictor chosen : {Predictor::linear, Predictor::ballistic, Predictor::slide}) {
    const RigidState a = state_of(*scene, chosen, {{{1, 2, 3}, {}}, {0.3, -0.4, 1}, {0, 1, 2}});
    const RigidPose end = predictor.pose(a, 250);
    const RigidMotion motion = predictor.motion(a, 250, {});
    const RigidState b{250, end.position, end.rotation, motion.velocity, motion.angular_velocity};
    for (std::int64_t tick = 0; tick < 250; tick += 10) {
      const RigidPose bent = bend(*scene, a, b, tick), predicted = predictor.pose(a, tick);
      for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(bent.position[i], predicted.position[i], 2) << tick;
      for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(bent.rotation[i], predicted.rotation[i], 64) << tick;
    }
  }
}

}  // namespace
}  // namespace tactus
