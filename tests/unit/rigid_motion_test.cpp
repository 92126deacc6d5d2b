// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/unit/rigid_world_fixture.h"

namespace tactus::sim {
namespace {

using testing::cube_scene, testing::kGravity, testing::kMass, testing::kMu, testing::run;

/// Half a tick matters: x = v t + a t^2 / 2 at the end of each tick, from the first on.
TEST(RigidMotion, FallsAndPushesStartExactly) {
  Scene scene = cube_scene();
  scene.floor.reset();
  scene.objects[0].velocity = {0.3, 0, 1};
  RigidWorld world(scene);
  for (int tick = 1; tick <= 1000; ++tick) {
    if (tick > 200 && tick <= 500) world.push(0, {0, 0.6, 0}, world.sample(0).pose.position);
    ASSERT_TRUE(world.step());
    const RigidSample s = world.sample(0);
    const double t = tick * kTick, pushed = std::clamp(t - 0.2, 0.0, 0.3), since = std::max(0.0, t - 0.5), a = 0.6 / kMass;
    ASSERT_NEAR(s.pose.position.x, 0.3 * t, 1e-12) << tick;
    ASSERT_NEAR(s.pose.position.y, a * pushed * pushed / 2 + a * pushed * since, 1e-12) << tick;
    ASSERT_NEAR(s.pose.position.z, 0.02 + t - kGravity * t * t / 2, 1e-9) << tick;
    ASSERT_NEAR(s.velocity.z, 1 - kGravity * (t - kTick / 2), 1e-11) << "half a step before: " << tick;
  }
  EXPECT_LT(world.errors().flight.value, 1e-12);
}

/// Velocities are those of half a step before; energies are not.
TEST(RigidMotion, EnergyIsThatOfTheTick) {
  for (const int parts : {1, 2}) {
    Scene scene = cube_scene();
    scene.floor.reset();
    scene.objects[0].velocity = {0.3, 0, 1};
    scene.objects[0].angular_velocity = {0, 0, 2};
    RigidWorld world(scene, {.parts = parts});
    const double inertia = world.inertia(0).z, start = kMass * (0.3 * 0.3 + 1) / 2 + inertia * 2 * 2 / 2;
    for (int tick = 1; tick <= 500; ++tick) {
      ASSERT_TRUE(world.step());
      ASSERT_NEAR(world.energy(0), start, 1e-9) << tick;
    }
  }
  Scene scene = cube_scene();
  scene.objects[0].velocity = {1, 0, 0};
  RigidWorld world(scene);
  run(world, 50);
  const double v = 1 - kMu * kGravity * 0.05;
  EXPECT_NEAR(world.energy(0), kMass * v * v / 2, 1e-6);
  run(world, 950);
  EXPECT_NEAR(world.energy(0), 0, 1e-9) << "lies";
}

TEST(RigidMotion, SlidesStartAndEndExactly) {
  Scene scene = cube_scene();
  scene.objects[0].velocity = {1, 0, 0};
  RigidWorld world(scene);
  run(world, 50);
  EXPECT_NEAR(world.sample(0).pose.position.x, 0.05 - kMu * kGravity * 0.05 * 0.05 / 2, 1e-8);
  run(world, 950);
  EXPECT_NEAR(world.sample(0).pose.position.x, 1 / (2 * kMu * kGravity), 2e-6);
}

/// Euler's equations: a box spun about its middle axis flips. References: periods of the elliptic functions.
class FreeBox : public ::testing::TestWithParam<double> {};

struct Spin {
  double energy;
  Vec3 momentum;  // angular
};

Spin spin_of(const RigidSample& s, const Vec3& inertia) {
  const Vec3 w = rotate(conjugate(s.pose.rotation), s.angular_velocity);
  const Vec3 l{inertia.x * w.x, inertia.y * w.y, inertia.z * w.z};
  return {dot(w, l) / 2, rotate(s.pose.rotation, l)};
}

TEST_P(FreeBox, KeepsEnergyAndMomentumAndFlipsInTime) {
  const double speed = GetParam();
  Scene scene = cube_scene();
  scene.floor.reset();
  scene.gravity = {};
  scene.objects[0].size = {0.02, 0.06, 0.12};
  scene.objects[0].angular_velocity = {0.01 * speed, speed, 0.003 * speed};
  RigidWorld world(scene);
  const Vec3 inertia = world.inertia(0);
  const Spin before = spin_of(world.sample(0), inertia);
  // Half a turn of the middle component: 2 K(m) / rate, with its zeros a quarter period after its greatest.
  const double e2 = 2 * before.energy, l2 = dot(before.momentum, before.momentum);
  const Vec3& i = inertia;  // x > y > z
  ASSERT_TRUE(i.x > i.y && i.y > i.z);
  const double high = l2 - e2 * i.z, low = e2 * i.x - l2;
  const bool about_x = l2 > e2 * i.y;
  const double rate =
      std::sqrt((about_x ? (i.x - i.y) * high : (i.y - i.z) * low) / (i.x * i.y * i.z)) * (about_x ? std::sqrt(low / low) : 1);
  const double m = about_x ? (i.y - i.z) * low / ((i.x - i.y) * high) : (i.x - i.y) * high / ((i.y - i.z) * low);
  const double half_period = 2 * std::comp_ellint_1(std::sqrt(m)) / rate;
  std::vector<double> flips;  // [s]
  double last = speed;
  for (int tick = 1; tick <= 60000 && flips.size() < 10; ++tick) {
    ASSERT_TRUE(world.step());
    const RigidSample s = world.sample(0);
    const double w = rotate(conjugate(s.pose.rotation), s.angular_velocity).y;
    if (w * last < 0) flips.push_back((tick - w / (w - last)) * kTick);
    last = w;
    const Spin now = spin_of(s, inertia);
    ASSERT_NEAR(now.energy / before.energy, 1, 1e-9) << tick;
    ASSERT_LT(norm(now.momentum - before.momentum) / norm(before.momentum), 1e-9) << tick;
  }
  ASSERT_GE(flips.size(), speed < 10 ? 5u : 10u);
  for (std::size_t k = 1; k < flips.size(); ++k) EXPECT_NEAR((flips[k] - flips[k - 1]) / half_period, 1, 1e-4) << k;
}

INSTANTIATE_TEST_SUITE_P(Speeds, FreeBox, ::testing::Values(2.0, 10.0, 50.0, 200.0));

/// A symmetric top that leans, with its weight at 0.05 m from a fixed point: turns about its axis at w, and its axis about the vertical.
TEST(RigidMotion, ASymmetricTopPrecessesAtItsRate) {
  Scene scene = cube_scene(Dof::rx | Dof::ry | Dof::rz);
  scene.floor.reset();
  const double tilt = 0.3, lever = 0.05, weight = 2;  // [rad], [m], [N]
  scene.objects[0].size = {0.06, 0.06, 0.02};
  scene.objects[0].pose.rotation = {std::cos(tilt / 2), std::sin(tilt / 2), 0, 0};
  const double across = kMass * (0.06 * 0.06 + 0.02 * 0.02) / 12, along = kMass * 2 * 0.06 * 0.06 / 12, spin = 150;
  // The slow root of I1 cos(tilt) p^2 - L3 p + weight lever = 0
  const double l3 = along * spin, c = across * std::cos(tilt);
  const double rate = (l3 - std::sqrt(l3 * l3 - 4 * c * weight * lever)) / (2 * c);
  const Vec3 axis{0, -std::sin(tilt), std::cos(tilt)};
  scene.objects[0].angular_velocity = rate * Vec3{0, 0, 1} + (spin - rate * std::cos(tilt)) * axis;
  RigidWorld world(scene);
  double turned = 0;
  Vec3 last = axis;
  for (int tick = 0; tick < 3000; ++tick) {
    const RigidSample s = world.sample(0);
    world.push(0, {0, 0, -weight}, to_world(s.pose, {0, 0, lever}));
    ASSERT_TRUE(world.step());
    const Vec3 now = rotate(world.sample(0).pose.rotation, {0, 0, 1});
    turned += std::atan2(last.x * now.y - last.y * now.x, last.x * now.x + last.y * now.y);
    last = now;
    ASSERT_NEAR(now.z, std::cos(tilt), 1e-3) << "it does not nod";
  }
  EXPECT_NEAR(turned / 3, rate, 1e-3 * rate);
}

/// A light cube carries what is up to 1e5 times as heavy.
TEST(RigidMotion, HeavyLiesOnLight) {
  for (const double ratio : {1e2, 1e3, 1e4, 1e5}) {
    Scene scene = cube_scene();
    scene.objects.push_back(scene.objects[0]);
    scene.objects[1].pose.position.z = 0.06;
    scene.objects[1].mass = ratio * kMass;
    RigidWorld world(scene);
    run(world, 3000);
    EXPECT_LT(norm(world.sample(0).pose.position - Vec3{0, 0, 0.02}), 0.1e-3) << ratio;
    EXPECT_LT(norm(world.sample(1).pose.position - Vec3{0, 0, 0.06}), 0.1e-3) << ratio;
    EXPECT_EQ(world.errors().unsolved, 0u) << ratio;
  }
}

/// What cannot be solved is counted from the first tick on.
TEST(RigidMotion, WhatTheSolverCannotDoIsReported) {
  Scene scene = cube_scene();
  for (int i = 1; i < 8; ++i) {
    scene.objects.push_back(scene.objects[0]);
    scene.objects.back().pose.position.z = 0.02 + 0.04 * i;
  }
  scene.objects.back().mass = 1e6 * kMass;
  RigidWorld world(scene);
  run(world, 10);
  EXPECT_GT(world.errors().unsolved, 0u);
  EXPECT_GT(world.errors().residual.value, 2e-3);
}

class Bullet : public ::testing::TestWithParam<double> {};

TEST_P(Bullet, StopsAtAWall) {
  for (const double thickness : {1e-3, 5e-3, 20e-3}) {
    for (int phase = 0; phase < 10; ++phase) {
      Scene scene = cube_scene();
      scene.gravity = {};
      scene.floor.reset();
      scene.objects[0].size = {0.01, 0.01, 0.01};
      scene.objects[0].pose.position = {-0.2 - 1e-4 * phase * GetParam(), 0, 0};
      scene.objects[0].velocity = {GetParam(), 0, 0};
      scene.objects.push_back(cube_scene(Dof::none).objects[0]);
      scene.objects[1].size = {thickness, 1, 1};
      scene.objects[1].pose.position = {};
      RigidWorld world(scene);
      run(world, 300);
      EXPECT_NEAR(world.sample(0).pose.position.x, -thickness / 2 - 5e-3, 0.1e-3) << thickness << ' ' << phase;
      EXPECT_LT(norm(world.sample(0).velocity), 0.05);
      EXPECT_LT(world.errors().penetration.value, 0.1e-3);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Speeds, Bullet, ::testing::Values(2.0, 8.0, 20.0, 100.0));

/// What half the step shows: faults of a simulation are larger than what it changes in a right one.
TEST(RigidMotion, AFinerStepDistinguishesFaults) {
  const auto end = [](const RigidEffort& effort, double force, double mass, int lost_every) {
    Scene scene = cube_scene();
    scene.objects[0].mass = mass;
    RigidWorld world(scene, effort);
    for (int tick = 0; tick < 300; ++tick) {
      if (lost_every > 0 && tick % lost_every == lost_every - 1) continue;
      world.push(0, {force, 0, 0}, world.sample(0).pose.position);
      EXPECT_TRUE(world.step());
    }
    return world.sample(0).pose.position;
  };
  const Vec3 right = end({}, 2, kMass, 0);
  const double step = norm(right - end({.parts = 2}, 2, kMass, 0));
  EXPECT_LT(step, 1e-5);
  EXPECT_GT(norm(right - end({.parts = 2}, 2 * 1.01, kMass, 0)), 100 * step) << "a force of 1 % too much";
  EXPECT_GT(norm(right - end({.parts = 2}, 2, 1.01 * kMass, 0)), 100 * step) << "a mass of 1 % too much";
  EXPECT_GT(norm(right - end({.parts = 2}, 2, kMass, 100)), 100 * step) << "one step of a hundred lost";
}

}  // namespace
}  // namespace tactus::sim
