// SPDX-License-Identifier: Apache-2.0
// Rigid objects that rest are left out, and nothing else changes by it: sim/rigid/rigid_world.h.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include <tactus/sim/random.h>
#include <tactus/sim/rigid/collision.h>
#include <tactus/sim/rigid/rigid_world.h>

namespace tactus::sim {
namespace {

SceneObject cube(const Vec3& position, std::uint8_t dof = Dof::all) {
  SceneObject object;
  object.name = "cube";
  object.size = {0.04, 0.04, 0.04};
  object.mass = 0.15;
  object.friction = 0.5;
  object.dof = dof;
  object.pose.position = position;
  return object;
}

SceneObject turned(SceneObject object, const Vec3& about) {
  const double w = std::sqrt(1 - dot(about, about));
  object.pose.rotation = {w, about.x, about.y, about.z};
  return object;
}

Scene scene_of(std::vector<SceneObject> objects) {
  Scene scene;
  scene.gravity = {0, 0, -9.81};
  scene.floor = 0.0;
  scene.objects = std::move(objects);
  return scene;
}

/// Some that lie apart, one on a static box, two that lean on each other, two that fall, one of them onto one that rests.
Scene busy_scene() {
  std::vector<SceneObject> objects;
  for (int i = 0; i < 6; ++i) objects.push_back(cube({0.2 * i, 0, 0.02}));
  for (int i = 0; i < 4; ++i) objects.push_back(cube({0.2 * i, 1, 0.02}, Dof::none));
  objects.push_back(cube({0.2, 1, 0.06}));
  objects.push_back(cube({0.0, 0.2, 0.02}));
  objects.push_back(cube({0.041, 0.2, 0.02}));
  objects.push_back(turned(cube({0.4, 0.5, 0.1}), {0.1, 0.3, 0.2}));
  objects.push_back(turned(cube({1.0, 0.01, 2.0}), {0.3, 0.1, 0}));
  return scene_of(objects);
}

bool are_same(const RigidSample& a, const RigidSample& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

TEST(RigidRest, SleepChangesNoBit) {
  const Scene scene = busy_scene();
  RigidWorld sleeps(scene), is_kept_awake(scene);
  std::size_t left_out = 0;
  for (int tick = 0; tick < 3000; ++tick) {
    for (RigidWorld* world : {&sleeps, &is_kept_awake}) {
      if (tick >= 900 && tick < 1100) world->push(2, {2, 0, 0}, world->sample(2).pose.position);  // slides into its neighbour
      if (tick == 1500) world->push(11, {30, 0, 0}, world->sample(11).pose.position);             // hits the one beside it
      if (tick == 2000) world->push(0, {1e-7, 0, 0}, world->sample(0).pose.position);             // does not slide
    }
    for (std::uint32_t i = 0; i < scene.objects.size(); ++i) is_kept_awake.wake(i);
    ASSERT_TRUE(sleeps.step() && is_kept_awake.step());
    left_out += is_kept_awake.changed().size() - sleeps.changed().size();
    for (std::uint32_t i = 0; i < scene.objects.size(); ++i)
      ASSERT_TRUE(are_same(sleeps.sample(i), is_kept_awake.sample(i))) << "object " << i << ", tick " << tick;
  }
  EXPECT_GT(left_out, 25000u) << "of 36000: or sleep was not tried";
  EXPECT_GT(sleeps.sample(2).pose.position.x, 0.5);
  EXPECT_TRUE(sleeps.changed().empty()) << "in the end all sleep";
}

TEST(RigidRest, WhatOthersDoChangesNoBitOfOneThatTouchesNone) {
  std::vector<SceneObject> objects{turned(cube({0, 0, 0.1}), {0.1, 0.3, 0.2})};
  RigidWorld alone(scene_of(objects));
  for (int i = 0; i < 5; ++i) objects.push_back(turned(cube({0.3 * (i + 1), 0, 0.05 + 0.03 * i}), {0.2, 0.1 * i, 0.1}));
  RigidWorld among(scene_of(objects));
  for (int tick = 0; tick < 600; ++tick) {
    ASSERT_TRUE(alone.step() && among.step());
    ASSERT_TRUE(are_same(alone.sample(0), among.sample(0))) << tick;
  }
}

TEST(RigidRest, EveryPostureSleeps) {
  Random random(5);
  for (int run = 0; run < 20; ++run) {
    SceneObject object = cube({random.uniform(-2, 2), random.uniform(-2, 2), 0.1});
    object.size = {random.uniform(0.02, 0.1), random.uniform(0.02, 0.1), random.uniform(0.02, 0.06)};
    object.mass = random.uniform(0.01, 5);
    RigidWorld world(
        scene_of({turned(object, {random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5)})}));
    for (int tick = 0; tick < 6000 && !(tick > 0 && world.changed().empty()); ++tick) ASSERT_TRUE(world.step());
    EXPECT_TRUE(world.changed().empty()) << "run " << run << ": " << norm(world.sample(0).velocity) << " m/s, "
                                         << norm(world.sample(0).angular_velocity);
  }
}

TEST(RigidRest, ALightPushIsNoRest) {
  Scene scene = scene_of({cube({0, 0, 0.02})});
  scene.gravity = {};
  scene.floor.reset();
  RigidWorld world(scene);
  for (int tick = 0; tick < 1000; ++tick) {
    world.push(0, {1e-8, 0, 0}, world.sample(0).pose.position);
    ASSERT_TRUE(world.step());
  }
  EXPECT_NEAR(world.sample(0).velocity.x, 1e-8 / 0.15, 1e-16);
  for (int tick = 0; tick < 1000; ++tick) ASSERT_TRUE(world.step());
  EXPECT_NEAR(world.sample(0).velocity.x, 1e-8 / 0.15, 1e-16) << "it floats on";
}

/// A body that comes at 3 m/s, one that is let down, a push: each wakes what it meets, in that very step.
TEST(RigidRest, WakesWhenItIsMet) {
  Scene scene = scene_of({cube({0, 0, 0.02}), cube({-1, 0, 0.02}), cube({0.5, 0, 0.02}), cube({0.5, 0, 1.5})});
  scene.objects[1].friction = 0.01;
  RigidWorld world(scene);
  for (int tick = 0; tick < 100; ++tick) ASSERT_TRUE(world.step());
  ASSERT_EQ(world.changed().size(), 1u) << "only what falls";
  const RigidSample rest = world.sample(0);
  world.push(1, {450, 0, 0}, world.sample(1).pose.position);
  int met = 0, landed = 0;
  for (int tick = 0; tick < 900; ++tick) {
    ASSERT_TRUE(world.step());
    if (met == 0 && !are_same(world.sample(0), rest)) met = tick;
    if (landed == 0 && std::abs(world.sample(3).pose.position.z - 0.06) < 1e-3) landed = tick;
  }
  EXPECT_GT(met, 0);
  EXPECT_GT(world.sample(0).pose.position.x, 0.05);
  EXPECT_GT(landed, 0);
}

TEST(BoxTree, FindsWhatOverlaps) {
  Random random(2);
  const auto box = [&random](double size) {
    const Vec3 low{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    return Extent{low, low + Vec3{random.uniform(0, size), random.uniform(0, size), random.uniform(0, size)}};
  };
  for (const std::uint32_t count : {0u, 1u, 5u, 300u}) {
    std::vector<BoxTree::Item> items;
    for (std::uint32_t i = 0; i < count; ++i) items.push_back({i, box(i % 7 == 0 ? 1 : 0.1)});
    BoxTree tree;
    for (const auto& item : items) tree.add(item);
    tree.build();
    for (int run = 0; run < 200; ++run) {
      const Extent asked = box(0.3);
      std::vector<std::uint32_t> found, expected;
      tree.visit(asked, [&](std::uint32_t number) { found.push_back(number); });
      std::sort(found.begin(), found.end());
      for (const auto& item : items)
        if (overlap(item.bounds, asked)) expected.push_back(item.number);
      ASSERT_EQ(found, expected);
    }
  }
}

}  // namespace
}  // namespace tactus::sim
