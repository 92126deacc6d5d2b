// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/modes/spring_modes.h>

#include <gtest/gtest.h>

#include <array>

#include "tests/unit/deformable_fixture.h"

namespace tactus::sim {
namespace {

double product(std::span<const double> a, std::span<const double> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

/// Upper and lower side of a slab: springs reach through it.
TriMesh slab() {
  TriMesh mesh = testing::sheet(8, 5);
  const auto vertices = static_cast<std::uint32_t>(mesh.vertices.size());
  const std::size_t triangles = mesh.triangles.size();
  for (std::uint32_t v = 0; v < vertices; ++v) mesh.vertices.push_back(mesh.vertices[v] - Vec3{0, 0, 0.004});
  for (std::size_t t = 0; t < triangles; ++t) {
    const Triangle up = mesh.triangles[t];
    mesh.triangles.push_back({up[0] + vertices, up[2] + vertices, up[1] + vertices});
  }
  return mesh;
}

TEST(SpringModes, AreOrthonormalAndRestWhereFixed) {
  const TriMesh mesh = slab();
  const std::array<std::uint32_t, 4> fixed{0, 8, 45, 53};
  const auto modes = spring_modes(mesh, fixed, 10);
  ASSERT_TRUE(modes) << modes.error().rule;
  const std::size_t size = 3 * mesh.vertices.size();
  ASSERT_EQ(modes->size(), 10 * size);
  const auto mode = [&](std::size_t k) { return std::span(*modes).subspan(k * size, size); };
  for (std::size_t a = 0; a < 10; ++a) {
    for (std::size_t b = 0; b <= a; ++b) EXPECT_NEAR(product(mode(a), mode(b)), a == b ? 1 : 0, 1e-12) << a << " " << b;
    for (const std::uint32_t v : fixed)
      for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_EQ(mode(a)[3 * v + axis], 0);
  }
  EXPECT_EQ(*spring_modes(mesh, fixed, 10), *modes) << "the same bits again";
}

/// Every spring keeps its length under a rigid motion: what is free moves so before it deforms.
TEST(SpringModes, OfAFreeBodyBeginWithItsRigidMotions) {
  const TriMesh mesh = slab();
  const auto modes = spring_modes(mesh, {}, 6);
  ASSERT_TRUE(modes);
  const std::size_t size = 3 * mesh.vertices.size();
  for (std::size_t motion = 0; motion < 6; ++motion) {
    std::vector<double> moved;
    for (const Vec3& x : mesh.vertices) {
      Vec3 along{motion % 3 == 0 ? 1.0 : 0.0, motion % 3 == 1 ? 1.0 : 0.0, motion % 3 == 2 ? 1.0 : 0.0};
      if (motion >= 3) along = cross(along, x);
      moved.insert(moved.end(), {along.x, along.y, along.z});
    }
    double held = 0;  // fraction of the motion that the modes span
    for (std::size_t k = 0; k < 6; ++k) {
      const double part = product(moved, std::span(*modes).subspan(k * size, size));
      held += part * part / product(moved, moved);
    }
    EXPECT_NEAR(held, 1, 1e-6) << motion;
  }
}

TEST(SpringModes, RefusesMoreModesThanThereAre) {
  const TriMesh mesh = testing::sheet(1, 1);
  const std::array<std::uint32_t, 3> fixed{0, 1, 2};
  EXPECT_STREQ(spring_modes(mesh, fixed, 3).error().rule, "R-API-9");
  EXPECT_STREQ(spring_modes(mesh, fixed, 0).error().rule, "R-API-9");
  EXPECT_TRUE(spring_modes(mesh, fixed, 2));
}

}  // namespace
}  // namespace tactus::sim
