// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/encoder_choices.h>

#include <gtest/gtest.h>

#include "tests/unit/driven_fixture.h"

namespace tactus {
namespace {

using testing::driven_scene;
using testing::kHold;
using testing::kMass;
using testing::kPush;

constexpr double kTick = 1e-3;

/// A cube that a device pushes along x against a drag; the truth as a simulation gives it.
struct Pushing {
  SharedScene scene = driven_scene();
  double drag;
  Vec3 device{-0.0185, 0, 0};
  std::shared_ptr<DevicePath> path = std::make_shared<DevicePath>(device_scene(*scene).value());
  DrivenChoice choice{*scene, *path};
  RigidSample cube{{{}, {}}, {0.1, 0, 0}, {}};
  Contact contact{ContactKind::surface, 0, {-0.02, 0, 0}, {-1, 0, 0}, {}, kPush};
  std::int64_t tick = 0;
  std::vector<RigidState> truth{1};

  explicit Pushing(double braked) : drag(braked) { path->shift(0, 0); }

  DrivenContact step() {
    path->add(static_cast<std::uint64_t>(tick) + 1, testing::device_state(*scene, tick, device));
    contact.device = device;
    choice.read(tick, {&cube, 1}, {&contact, contact.kind == ContactKind::none ? 0u : 1u}, truth);
    const double depth = std::max(0.0, device.x - (cube.pose.position.x - 0.02));
    const double speed = cube.velocity.x + kTick * (kPush / kMass * depth - drag);
    cube.pose.position.x += kTick * speed;
    cube.velocity.x = (1 - testing::kLoss) * speed;
    device.x += 1e-4;
    ++tick;
    return truth[0].contact;
  }
};

/// That of a receiver, whose point is on a grid.
TEST(DrivenChoice, TheDragExplainsTheMotion) {
  const double rounding = kPush / kMass * (std::ldexp(164.0, -DrivenContact::kPoint) - 0.02);
  for (const double drag : {0.0, 2.0, 6.9}) {
    Pushing pushing(drag);
    DrivenContact told;
    for (int i = 0; i < 20; ++i) {
      told = pushing.step();
      if (i < 4) {
        EXPECT_EQ(told, DrivenContact{}) << "too little was seen";
      }
    }
    EXPECT_NEAR(std::ldexp(told.drag, -DrivenContact::kDrag), drag + rounding, 0.04);
    EXPECT_EQ(told.point, (Vec3i{-164, 0, 0}));
    EXPECT_EQ(told.normal, (Vec3i{-1024, 0, 0}));
    EXPECT_FALSE(told.is_held);
  }
}

/// What is remembered of an object is its own.
TEST(DrivenChoice, ObjectsThatTheDeviceMovesInTurnsAreToldAlike) {
  constexpr std::size_t kCubes = 3;
  SceneBuilder builder;
  for (std::size_t i = 0; i < kCubes; ++i) builder.rigid("cube" + std::to_string(i), {}).driven(testing::cube_physics());
  const SharedScene scene = builder.motion({{0, 0, -testing::kWeight}, testing::kGround}).baselines(64).build().value();
  DevicePath path(device_scene(*scene).value());
  path.shift(0, 0);
  DrivenChoice choice(*scene, path);
  std::vector<RigidState> truth(kCubes);
  std::vector<RigidSample> cubes(kCubes);
  for (std::int64_t tick = 0; tick < 60; ++tick) {
    const auto pushed = static_cast<std::uint32_t>(tick / 20);
    const Vec3 device{1e-4 * static_cast<double>(tick), 0, 0};
    path.add(static_cast<std::uint64_t>(tick) + 1, testing::device_state(*scene, tick, device));
    // Pushed at a constant speed: the drag is what the spring pulls.
    for (RigidSample& cube : cubes) cube = {{device + Vec3{0.0185, 0, 0}, {}}, {0.1, 0, 0}, {}};
    const Contact contact{ContactKind::surface, pushed, {-0.02, 0, 0}, {-1, 0, 0}, device, kPush};
    choice.read(tick, cubes, {&contact, 1}, truth);
    for (std::uint32_t i = 0; i < kCubes; ++i) {
      EXPECT_EQ(truth[i].contact == DrivenContact{}, i != pushed || tick % 20 < 4) << tick << ' ' << i;
    }
    if (tick % 20 == 19) {
      EXPECT_NEAR(std::ldexp(truth[pushed].contact.drag, -DrivenContact::kDrag),
                  kPush / kMass * 0.0015 - 0.1 * 1000 * testing::kLoss, 0.15);
    }
  }
}

TEST(DrivenChoice, WhatIsHeldIsToldAtOnce) {
  Pushing pushing(0);
  pushing.contact.kind = ContactKind::spring;
  pushing.contact.stiffness = kHold;
  const DrivenContact told = pushing.step();
  EXPECT_TRUE(told.is_held);
  EXPECT_EQ(told.normal, Vec3i{});
}

/// The contact of another user is where no path leads.
TEST(DrivenChoice, AnotherUsersContactIsNotTold) {
  Pushing pushing(2);
  for (int i = 0; i < 10; ++i) pushing.step();
  EXPECT_NE(pushing.step(), DrivenContact{});
  pushing.device.y += 1e-4;
  pushing.path->add(1000, testing::device_state(*pushing.scene, pushing.tick, {0, 0, 1}));
  EXPECT_EQ(pushing.step(), DrivenContact{});
}

/// Where nothing is touched for a moment, the drag is looked for anew.
TEST(DrivenChoice, AfterAPauseItWaitsForTheWindow) {
  Pushing pushing(2);
  for (int i = 0; i < 10; ++i) pushing.step();
  pushing.contact.kind = ContactKind::none;
  EXPECT_EQ(pushing.step(), DrivenContact{});
  pushing.contact.kind = ContactKind::surface;
  for (int i = 0; i < 4; ++i) EXPECT_EQ(pushing.step(), DrivenContact{});
  EXPECT_NE(pushing.step(), DrivenContact{});
}

}  // namespace
}  // namespace tactus
