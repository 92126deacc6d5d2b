// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/deformable/stiffness_map.h>

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include <tactus/sim/fem/model.h>

namespace tactus::sim {
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

/// Stiffness [N/m] and mass [kg] that a force along the normal meets at a contact, by a dense inverse.
std::pair<double, double> pressed(const SceneDeformable& object, const SurfaceContact& contact) {
  FemOptions options;
  options.materials = {{1e4, 0.45, 1e4}};  // those of slab()
  options.fixed = object.fixed;
  auto model = FemModel::create(object.mesh, options).value();
  SparseMatrix K;
  model.stiffness(model.rest().u, K);
  const TetSurface surface = tactus::sim::surface(model.mesh());
  const auto& triangle = surface.mesh.triangles[contact.triangle];
  const auto corner = [&](std::size_t k) { return surface.mesh.vertices[triangle[k]]; };
  Vec3 normal = cross(corner(1) - corner(0), corner(2) - corner(0));
  normal = (1 / norm(normal)) * normal;
  const auto free = model.free_dofs();
  Eigen::VectorXd unit = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(free.size()));
  double inverse_mass = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t vertex = surface.vertex[triangle[k]];
    const double weight = contact.weights[k], along[3]{normal.x, normal.y, normal.z};
    inverse_mass += weight * weight / model.lumped_mass()[3 * Eigen::Index{vertex}];
    const auto at = std::find(free.begin(), free.end(), static_cast<int>(3 * vertex)) - free.begin();
    for (Eigen::Index d = 0; d < 3; ++d) unit[at + d] = weight * along[d];
  }
  return {1 / unit.dot(Eigen::MatrixXd(K).inverse() * unit), 1 / inverse_mass};
}

/// At a low rate an object tolerates little more than its own stiffness at that point; at a high one, four times the mass over T^2.
TEST(CriticalStiffness, IsThatOfEquation438WhereTheObjectIsPressed) {
  SceneDeformable object = slab(4, 3);
  const StiffnessMap map = stiffness_map(object).value();
  SurfaceContact contact;
  while (
      std::ranges::any_of(map.surface.triangles[contact.triangle], [&](std::uint32_t v) { return std::isinf(map.stiffness[v]); }))
    ++contact.triangle;
  contact.weights = {0.5, 0.3, 0.2};
  const auto [stiffness, mass] = pressed(object, contact);
  object.mass_damping = 10;
  object.stiffness_damping = 1e-3;
  for (const std::uint32_t rate : {1U, 17U, 1000U}) {
    object.rate = rate;
    const double period = rate * kTick, damping = 10 * mass + 1e-3 * stiffness;
    const double expected = 4 * mass / (period * period) + 2 * damping / period + stiffness;
    EXPECT_NEAR(critical_stiffness(object, contact).value(), expected, 1e-3 * expected) << rate;  // as exact as the solve
  }
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

TEST(CriticalStiffness, OfAFixedPointIsInfinite) {
  SceneDeformable object = slab(4, 3);
  object.fixed.clear();
  for (std::uint32_t v = 0; v < object.mesh.vertices.size(); ++v) object.fixed.push_back(v);
  EXPECT_TRUE(std::isinf(critical_stiffness(object, {}).value()));
}

}  // namespace
}  // namespace tactus::sim
