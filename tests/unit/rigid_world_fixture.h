// SPDX-License-Identifier: Apache-2.0
/// A cube on a floor, for tests of RigidWorld.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>

#include <tactus/sim/rigid/rigid_world.h>

namespace tactus::sim::testing {

inline constexpr double kMass = 0.15, kMu = 0.7, kGravity = 9.81;

inline Scene cube_scene(std::uint8_t dof = Dof::all) {
  Scene scene;
  scene.gravity = {0, 0, -kGravity};
  scene.floor = 0.0;
  SceneObject cube;
  cube.name = "cube";
  cube.size = {0.04, 0.04, 0.04};
  cube.mass = kMass;
  cube.friction = kMu;
  cube.dof = dof;
  cube.pose.position = {0, 0, 0.02};
  scene.objects.push_back(cube);
  return scene;
}

inline void run(RigidWorld& world, int ticks, const Vec3& force = {}) {
  for (int i = 0; i < ticks; ++i) {
    world.push(0, force, world.sample(0).pose.position);
    ASSERT_TRUE(world.step());
  }
}

}  // namespace tactus::sim::testing
