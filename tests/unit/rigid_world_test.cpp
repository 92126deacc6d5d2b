// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <ode/ode.h>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <numbers>
#include <string>

#include <tactus/sim/random.h>
#include <tactus/sim/rigid/collision.h>
#include <tactus/sim/rigid/rigid_parts.h>
#include <tactus/sim/rigid/rigid_world.h>
#include "tests/unit/rigid_world_fixture.h"
#include "tests/unit/rule_fixture.h"

namespace tactus::sim {
namespace {

// ==== rigid world ====

using testing::cube_scene, testing::kGravity, testing::kMass, testing::kMu, testing::run;
constexpr double kFriction = kMu * kMass * kGravity;  // [N] of the sliding cube

/// Thesis 4.2.3.4: f_e, and the normal force within it.
TEST(Load, IsWhatActsOnAnObjectBesidesItsUsers) {
  Scene scene = cube_scene();
  scene.objects[0].damping = 0.995;
  scene.compensation.emplace();
  scene.users.resize(1);
  RigidWorld world(scene);
  run(world, 200);
  EXPECT_NEAR(norm(world.load(0).external), 0, 1e-6) << "at rest";
  EXPECT_NEAR(world.load(0).hold.z, kFriction, 1e-3);
  EXPECT_NEAR(std::hypot(world.load(0).hold.x, world.load(0).hold.y), 0, 1e-3);
  run(world, 20, {0.6 * kFriction, 0, 0});
  EXPECT_NEAR(world.load(0).external.x, -0.6 * kFriction, 1e-3 * kFriction) << "static friction";
  run(world, 20, {0, 0, -1});
  EXPECT_NEAR(world.load(0).hold.z, kFriction + kMu * 1, 2e-2 * kFriction) << "pressed on the floor";
  run(world, 200, {2 * kFriction, 0, 0});
  const double speed = world.sample(0).velocity.x, damping = kMass * (1 - 0.995) / kTick;
  EXPECT_GT(speed, 0.3);
  EXPECT_NEAR(world.load(0).external.x, -(kFriction + damping * speed), 0.02 * kFriction) << "friction and 4.12";
}

TEST(Load, IsNotComputedUnlessTheSceneAsks) {
  RigidWorld world(cube_scene());
  run(world, 50, {2 * kFriction, 0, 0});
  EXPECT_EQ(world.load(0).external, Vec3{});
  EXPECT_EQ(world.load(0).hold, Vec3{});
}

/// Asking changes no bit of the motion.
TEST(Load, DoesNotDisturbWhatItMeasures) {
  Scene asked = cube_scene();
  asked.compensation.emplace();
  asked.users.resize(1);
  RigidWorld with(asked), without(cube_scene());
  for (int i = 0; i < 500; ++i) {
    const Vec3 force{3 * std::sin(0.02 * i), std::cos(0.05 * i), i % 100 == 0 ? 5.0 : 0.0};
    run(with, 1, force);
    run(without, 1, force);
    const RigidSample a = with.sample(0), b = without.sample(0);
    ASSERT_EQ(a.pose.position, b.pose.position) << i;
    ASSERT_EQ(a.velocity, b.velocity) << i;
  }
}

class SlidingCube : public ::testing::TestWithParam<double> {};

TEST_P(SlidingCube, DeceleratesWithMuGInEveryDirection) {
  const double angle = GetParam() * std::numbers::pi / 180;
  const Vec3 direction{std::cos(angle), std::sin(angle), 0};
  RigidWorld world(cube_scene());
  run(world, 20, (kFriction + kMass * 50) * direction);  // to 1 m/s
  run(world, 1);                                         // in which the push ends
  const Vec3 before = world.sample(0).velocity;
  run(world, 100);
  const Vec3 after = world.sample(0).velocity;
  EXPECT_NEAR((norm(before) - norm(after)) / 0.1, kMu * kGravity, 0.01 * kMu * kGravity);
  const double drift = std::atan2(after.y, after.x) - angle;
  EXPECT_LT(std::abs(drift), std::numbers::pi / 180);
  EXPECT_GT(norm(after), 0.2) << "it must still be sliding for the figures to mean anything";
}

INSTANTIATE_TEST_SUITE_P(Directions, SlidingCube, ::testing::Values(0.0, 22.5, 45.0, 67.5, 90.0));

TEST(RigidWorld, FrictionHoldsUpToMuNAndNoFurther) {
  for (const double angle : {0.0, 0.4, std::numbers::pi / 4}) {
    const Vec3 direction{std::cos(angle), std::sin(angle), 0};
    RigidWorld held(cube_scene());
    run(held, 1000, 0.98 * kFriction * direction);
    EXPECT_LT(norm(held.sample(0).pose.position - Vec3{0, 0, 0.02}), 1e-7) << angle;
    RigidWorld moved(cube_scene());
    run(moved, 1000, 1.1 * kFriction * direction);
    EXPECT_NEAR(norm(moved.sample(0).velocity), 0.1 * kFriction / kMass, 0.01 * kFriction / kMass) << angle;
  }
}

TEST(RigidWorld, RestsWhereTheSceneStandsIt) {
  RigidWorld world(cube_scene());
  run(world, 2000);
  EXPECT_LT(norm(world.sample(0).pose.position - Vec3{0, 0, 0.02}), 1e-9);
  EXPECT_LT(norm(world.sample(0).velocity), 1e-9);
  EXPECT_LT(angle_between(world.sample(0).pose.rotation, Quat{}), 1e-9);
}

TEST(RigidWorld, FreeFallWithDamping) {
  Scene scene = cube_scene();
  scene.floor.reset();
  scene.objects[0].damping = 0.999;
  RigidWorld world(scene);
  run(world, 500);
  // v' = d (v - g h) from half a step before the tick, -g h / 2 less, to half a step before the last
  const double d = 0.999, kick = kGravity * kTick, damped = std::pow(d, 500);
  const double expected = -kick * d * (1 - damped) / (1 - d) + damped * kick / 2;
  EXPECT_NEAR(world.sample(0).velocity.z, expected, 1e-10);
  EXPECT_LT(world.sample(0).pose.position.z, -1);
}

TEST(RigidWorld, TipsOverItsEdgeOnlyAboveTheLever) {
  // Pushed at height h a cube tips when F h > m g a / 2. F stays below the friction that would let it slide.
  const double height = 0.036, needed = kMass * kGravity * 0.02 / height;
  ASSERT_LT(1.05 * needed, kFriction);
  for (const double fraction : {0.95, 1.05}) {
    RigidWorld world(cube_scene());
    for (int i = 0; i < 150; ++i) {
      const RigidSample s = world.sample(0);
      world.push(0, {fraction * needed, 0, 0}, to_world(s.pose, {-0.02, 0, height - 0.02}));
      ASSERT_TRUE(world.step());
    }
    const double tilt = angle_between(world.sample(0).pose.rotation, Quat{});
    if (fraction < 1) EXPECT_LT(tilt, 1e-6);
    else EXPECT_GT(tilt, 0.05);
  }
}

TEST(RigidWorld, LockedAxesKeepTheirBits) {
  Scene scene = cube_scene(Dof::x);
  scene.objects[0].pose = {{0.1, -0.3, 0.02}, {0.8, 0, 0, 0.6}};
  RigidWorld world(scene);
  const RigidSample start = world.sample(0);
  Random random(3);
  for (int i = 0; i < 2000; ++i) {
    const auto any = [&] { return random.uniform(-3, 3); };
    world.push(0, {any() + 1, any(), any()}, start.pose.position + Vec3{0.02, 0.01, 0.015});
    ASSERT_TRUE(world.step());
    const RigidSample s = world.sample(0);
    ASSERT_EQ(s.pose.position.y, start.pose.position.y);
    ASSERT_EQ(s.pose.position.z, start.pose.position.z);
    ASSERT_EQ(s.pose.rotation, start.pose.rotation);
    ASSERT_EQ(s.velocity, (Vec3{s.velocity.x, 0, 0}));
    ASSERT_EQ(s.angular_velocity, Vec3{});
  }
  EXPECT_GT(std::abs(world.sample(0).pose.position.x - start.pose.position.x), 0.01);
}

TEST(RigidWorld, TurnsAboutItsOnlyFreeAxis) {
  Scene scene = cube_scene(Dof::rz);
  scene.objects[0].pose.rotation = {std::cos(0.2), std::sin(0.2), 0, 0};  // lies askew: a free one would turn about x, too
  scene.objects[0].pose.position.z = 0.1;
  RigidWorld world(scene);
  const Quat start = world.sample(0).pose.rotation;
  for (int i = 0; i < 300; ++i) {
    world.push(0, {0.02, 0.05, 0.01}, world.sample(0).pose.position + Vec3{0.02, 0, 0.01});
    ASSERT_TRUE(world.step());
    const Quat turned = world.sample(0).pose.rotation * conjugate(start);
    ASSERT_NEAR(turned.x, 0, 1e-12);
    ASSERT_NEAR(turned.y, 0, 1e-12);
  }
  EXPECT_GT(angle_between(world.sample(0).pose.rotation, start), 0.1);
  EXPECT_EQ(world.sample(0).pose.position, scene.objects[0].pose.position);
}

TEST(RigidWorld, StaticObjectCarriesAndNeverMoves) {
  Scene scene = cube_scene();
  scene.floor.reset();
  SceneObject table = scene.objects[0];
  table.dof = Dof::none;
  table.size = {1, 1, 0.1};
  table.pose.position = {0, 0, -0.05};
  scene.objects.push_back(table);
  RigidWorld world(scene);
  for (int i = 0; i < 500; ++i) {
    world.push(1, {100, 0, 100}, {0, 0, 0});
    ASSERT_TRUE(world.step());
  }
  EXPECT_EQ(world.sample(1).pose.position, table.pose.position);
  EXPECT_EQ(world.sample(1).velocity, Vec3{});
  EXPECT_NEAR(world.sample(0).pose.position.z, 0.02, 5e-5);
}

TEST(RigidWorld, BrokenStateStopsWithTheObjectAndTheTick) {
  Scene scene = cube_scene();
  scene.objects.push_back(scene.objects[0]);
  scene.objects[1].pose.position = {1, 0, 0.02};
  for (const double force : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e300, 1e8}) {
    RigidWorld world(scene);
    run(world, 3);
    world.push(1, {force, 0, 0}, {1, 0.01, 0.03});
    const auto step = world.step();
    ASSERT_FALSE(step) << force;
    EXPECT_EQ(step.error().error.code, Errc::invalid_argument);
    EXPECT_STREQ(step.error().error.rule, "R-SIM-1");
    EXPECT_STREQ(step.error().kind, "object");
    EXPECT_EQ(step.error().element, 1u);
    EXPECT_EQ(step.error().step, 3);
  }
}

TEST(RigidWorld, WorldsDoNotDisturbEachOther) {
  const auto push = [](RigidWorld& world, int tick) {
    world.push(0, {1.2, 0.3 * std::sin(tick * 0.05), 0}, world.sample(0).pose.position + Vec3{-0.02, 0.004, 0.012});
    return world.step().has_value();
  };
  RigidWorld alone(cube_scene()), first(cube_scene()), second(cube_scene());
  for (int i = 0; i < 500; ++i) ASSERT_TRUE(push(alone, i));
  for (int i = 0; i < 500; ++i) ASSERT_TRUE(push(first, i) && push(second, i + 77));
  EXPECT_EQ(first.sample(0).pose.position, alone.sample(0).pose.position);
  EXPECT_EQ(first.sample(0).pose.rotation, alone.sample(0).pose.rotation);
  EXPECT_NE(second.sample(0).pose.position, alone.sample(0).pose.position);
}

/// Two cubes, one on the other, and a third one 3 mm above them.
Scene pile_scene() {
  Scene scene = cube_scene();
  for (const double height : {0.06, 0.103}) {
    scene.objects.push_back(scene.objects[0]);
    scene.objects.back().pose.position.z = height;
  }
  return scene;
}

bool rests(const RigidWorld& world, std::uint32_t object) {
  const RigidSample s = world.sample(object);
  return s.velocity == Vec3{} && s.angular_velocity == Vec3{};
}

TEST(RigidWorld, APileComesToRestAndStays) {
  RigidWorld world(pile_scene());
  run(world, 2000);
  for (const std::uint32_t i : {0u, 1u, 2u}) EXPECT_TRUE(rests(world, i)) << i;
  const Vec3 before = world.sample(2).pose.position;
  EXPECT_NEAR(before.z, 0.1, 1e-4);
  run(world, 10000);
  EXPECT_EQ(world.sample(2).pose.position, before);
  EXPECT_EQ(world.tick(), 12000);
}

TEST(RigidWorld, APushWakesAllOfAPile) {
  RigidWorld world(pile_scene());
  run(world, 2000);
  const double before = world.sample(2).pose.position.x;
  run(world, 200, {3.5 * kFriction, 0, 0});  // at the lowest; the upper ones ride on it
  EXPECT_GT(world.sample(0).velocity.x, 0.01);
  EXPECT_GT(world.sample(2).pose.position.x, before + 1e-3);
}

TEST(RigidWorld, ABodyThatFallsOnASleepingPileWakesIt) {
  Scene scene = pile_scene();
  scene.objects.push_back(scene.objects[0]);
  scene.objects.back().pose.position = {0.015, 0, 8};  // falls for 1.27 s
  RigidWorld world(scene);
  run(world, 1200);
  ASSERT_TRUE(rests(world, 2)) << "the pile must sleep before it is hit";
  run(world, 100);
  EXPECT_FALSE(rests(world, 2));
}

std::size_t ode_allocations = 0;

TEST(RigidWorld, OdeAllocatesNothingAfterTheFirstStep) {
  dAllocFunction* const alloc = dGetAllocHandler();
  dReallocFunction* const realloc = dGetReallocHandler();
  dSetAllocHandler([](dsizeint size) {
    ++ode_allocations;
    return std::malloc(size);  // NOLINT(cppcoreguidelines-no-malloc): ODE wants memory of this kind
  });
  dSetReallocHandler([](void* p, dsizeint, dsizeint size) {
    ++ode_allocations;
    return std::realloc(p, size);  // NOLINT(cppcoreguidelines-no-malloc)
  });
  {
    RigidWorld world(cube_scene());
    run(world, 1);
    EXPECT_GT(ode_allocations, 0u) << "the counter must count";
    ode_allocations = 0;
    run(world, 1000, {1.2, 0.4, 0.1});
    EXPECT_EQ(ode_allocations, 0u);
  }
  dSetAllocHandler(alloc);
  dSetReallocHandler(realloc);
}

/// 200 boxes at one position touch each other 19 900 times, in several points each.
TEST(RigidWorld, MoreContactsThanFitAreRefused) {
  Scene scene = cube_scene();
  const SceneObject cube = scene.objects[0];
  for (int i = 1; i < 200; ++i) {
    scene.objects.push_back(cube);
    scene.objects.back().name += std::to_string(i);
  }
  RigidWorld world(scene);
  const auto stepped = world.step();
  ASSERT_FALSE(stepped);
  EXPECT_STREQ(stepped.error().error.rule, "R-SIM-6");
  EXPECT_EQ(stepped.error().error.code, Errc::limit_exceeded);
  for (std::uint32_t i = 0; i < 200; ++i) EXPECT_EQ(world.sample(i).pose.position, cube.pose.position) << i;
}

TEST(RigidWorld, TheTableOfRulesNamesItsLimit) {
  tactus::testing::expect_limits("R-SIM-6", {std::to_string(rigid::kMostTouching) + " contacts"});
}

// ==== rigid rest ====
// Rigid objects that rest are left out, and nothing else changes by it: sim/rigid/rigid_world.h.

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
  ASSERT_TRUE(world.step()) << "in which the push ends";
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
