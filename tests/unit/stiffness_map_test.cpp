// SPDX-License-Identifier: Apache-2.0
#include "sim/deformable/stiffness_map.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "sim/fem/model.h"

namespace tactus {
namespace {

SceneDeformable slab(std::uint32_t nx, std::uint32_t ny) {
  SceneDeformable object;
  object.mesh = make_slab(nx, ny, 1, 0.01);
  object.materials = {{1e4, 0.45, 1e4}};
  const std::uint32_t row = nx + 1, layer = row * (ny + 1);
  for (const std::uint32_t corner : {0u, nx, row * ny, row * ny + nx}) {
    object.fixed.push_back(corner);
    object.fixed.push_back(corner + layer);
  }
  return object;
}

TEST(StiffnessMap, EqualsADenseSolve) {
  const SceneDeformable object = slab(4, 3);
  const auto map = stiffness_map(object);
  ASSERT_TRUE(map) << map.error().rule;
  FemOptions options;
  options.materials = {{1e4, 0.45, 1e4}};
  options.fixed = object.fixed;
  auto model = FemModel::create(object.mesh, options).value();
  SparseMatrix K;
  model.stiffness(model.rest().u, K);
  const Eigen::MatrixXd inverse = Eigen::MatrixXd(K).inverse();
  const auto free = model.free_dofs();
  const std::uint32_t middle = 5 * 4 + 5 + 2;  // on the upper side, away from the rim: its normal is z
  const auto z = std::find(free.begin(), free.end(), static_cast<int>(3 * middle + 2)) - free.begin();
  const double expected = 1 / inverse.block<3, 1>(z - 2, z).norm();
  EXPECT_NEAR(map->stiffness.at(middle), expected, 1e-9 * expected);
}

TEST(StiffnessMap, FixedVerticesAreInfinitelyStiff) {
  const SceneDeformable object = slab(4, 3);
  const StiffnessMap map = stiffness_map(object).value();
  for (const std::uint32_t v : object.fixed) EXPECT_TRUE(std::isinf(map.stiffness[v]));
  EXPECT_EQ(std::count_if(map.stiffness.begin(), map.stiffness.end(), [](double k) { return std::isinf(k); }), 8);
  for (const double k : map.stiffness) EXPECT_GT(k, 0);
}

TEST(StiffnessMap, ASymmetricObjectHasASymmetricMap) {
  // The cubes' diagonals run from the lowest to the highest corner, so a half turn about the diagonal's normal through the middle,
  // which takes every coordinate to its opposite, maps the mesh onto itself.
  const StiffnessMap map = stiffness_map(slab(5, 4)).value();
  const std::size_t n = map.stiffness.size();
  for (std::size_t v = 0; v < n; ++v) {
    if (std::isinf(map.stiffness[v])) continue;
    EXPECT_NEAR(map.stiffness[v], map.stiffness[n - 1 - v], 1e-8 * map.stiffness[v]) << v;
  }
}

TEST(StiffnessMap, TheSofterHalfOfTheMembraneIsSofter) {
  const Scene scene = load_scene(find_scene("membrane").value()).value();
  const StiffnessMap map = stiffness_map(scene.deformables.at(0)).value();
  const auto upper = [](std::uint32_t i, std::uint32_t j) { return (21 + j) * 17 + i; };
  for (std::uint32_t j = 5; j <= 15; ++j) EXPECT_GT(map.stiffness[upper(4, j)], 1.5 * map.stiffness[upper(12, j)]) << j;
}

TEST(StiffnessMap, IsLinearBetweenVertices) {
  const StiffnessMap map = stiffness_map(slab(4, 3)).value();
  for (std::uint32_t t = 0; t < map.surface.triangles.size(); ++t) {
    const auto& [a, b, c] = map.surface.triangles[t];
    EXPECT_EQ(map.at(t, {1, 0, 0}), map.stiffness[a]);
    EXPECT_EQ(map.at(t, {0, 0, 1}), map.stiffness[c]);
    const double mean = 0.25 * map.stiffness[a] + 0.5 * map.stiffness[b] + 0.25 * map.stiffness[c];
    if (std::isfinite(mean)) {
      EXPECT_NEAR(map.at(t, {0.25, 0.5, 0.25}), mean, 1e-12 * mean);
    } else {
      EXPECT_TRUE(std::isinf(map.at(t, {0.25, 0.5, 0.25})));
    }
  }
}

TEST(StiffnessMap, WhatFloatsHasNone) {
  SceneDeformable object = slab(4, 3);
  object.fixed = {0, 1};  // may turn about the line through them
  const auto map = stiffness_map(object);
  ASSERT_FALSE(map);
  EXPECT_STREQ(map.error().rule, "R-FEM-7");
}

/// At a low rate an object bears little more than its own stiffness at that place; at a high one, four times the mass over T^2.
TEST(CriticalStiffness, IsThatOfEquation438WhereTheObjectIsPressed) {
  SceneDeformable object = slab(4, 3);
  const StiffnessMap map = stiffness_map(object).value();
  std::uint32_t triangle = 0;
  while (std::ranges::any_of(map.surface.triangles[triangle], [&](std::uint32_t v) { return std::isinf(map.stiffness[v]); }))
    ++triangle;
  MeshContact contact;
  contact.triangle = triangle;
  contact.weights = {1.0 / 3, 1.0 / 3, 1.0 / 3};
  object.rate = 1000;
  const double slow = critical_stiffness(object, contact).value();
  double lowest = 1e300, highest = 0;
  for (const std::uint32_t v : map.surface.triangles[triangle]) {
    lowest = std::min(lowest, map.stiffness[v]);
    highest = std::max(highest, map.stiffness[v]);
  }
  EXPECT_GT(slow, lowest);
  EXPECT_LT(slow, 4 * highest) << "spread over three vertices, which yield less than one alone";
  object.rate = 1;
  const double mass = (critical_stiffness(object, contact).value() - slow) * kTick * kTick / 4;
  const double whole = 1e4 * 4 * 3 * 1e-6;  // [kg]
  EXPECT_GT(mass, whole / 40) << "of three vertices out of 40";
  EXPECT_LT(mass, whole / 5);
  object.mass_damping = 10;
  EXPECT_NEAR(critical_stiffness(object, contact).value() - slow, (4 / (kTick * kTick) + 2 * 10 / kTick) * mass,
              1e-6 * mass / (kTick * kTick));
}

TEST(CriticalStiffness, OfAFreeObjectIsThatOfItsMass) {
  SceneDeformable object = slab(4, 3);
  object.fixed.clear();
  object.rate = 17;
  const double limit = critical_stiffness(object, {}).value();
  const double period = 17 * kTick, whole = 1e4 * 4 * 3 * 1e-6;
  EXPECT_GT(limit, 0);
  EXPECT_LT(limit, 4 * whole / 10 / (period * period));
}

TEST(CriticalStiffness, OfAFixedPlaceIsInfinite) {
  SceneDeformable object = slab(4, 3);
  object.fixed.clear();
  for (std::uint32_t v = 0; v < object.mesh.vertices.size(); ++v) object.fixed.push_back(v);
  EXPECT_TRUE(std::isinf(critical_stiffness(object, {}).value()));
}

}  // namespace
}  // namespace tactus
