// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include <tactus/deformable/displacement.h>
#include <tactus/mesh/graph.h>
#include "tests/unit/deformable_fixture.h"

namespace tactus {
namespace {

// ==== deformable graph ====

DeformableObject object_of(const TriMesh& mesh) { return make_deformable_object("m", mesh, 22).value(); }

TEST(VertexHierarchy, OrderNamesEveryVertexOnceAndParentsComeFirst) {
  for (const auto& [nx, ny] : {std::pair{1U, 1U}, {7U, 3U}, {20U, 31U}}) {
    const DeformableObject mesh = object_of(testing::sheet(nx, ny));
    const VertexHierarchy h = vertex_hierarchy(mesh);
    std::vector<std::size_t> order_index(mesh.rest.size(), mesh.rest.size());
    ASSERT_EQ(h.order.size(), mesh.rest.size());
    ASSERT_EQ(h.parents[0].size(), mesh.rest.size());
    for (std::size_t i = 0; i < h.order.size(); ++i) order_index[h.order[i]] = i;
    EXPECT_EQ(std::ranges::count(order_index, mesh.rest.size()), 0);
    std::size_t roots = 0;
    for (std::size_t i = 0; i < h.order.size(); ++i) {
      std::int64_t sum = 0;
      for (const VertexParent& p : h.parents[0][i]) {
        EXPECT_LT(order_index[p.vertex], i);
        sum += p.weight;
      }
      roots += h.parents[0][i].empty() ? 1U : 0U;
      if (!h.parents[0][i].empty()) {
        EXPECT_NEAR(static_cast<double>(sum), 32768, VertexHierarchy::kParents);
      }
      if (i > 0) {
        EXPECT_LE(h.depth[h.order[i]], h.depth[h.order[i - 1]]);
      }
    }
    EXPECT_EQ(roots, 1U);
  }
}

TEST(VertexHierarchy, ComponentsAndLoneVerticesAreRoots) {
  TriMesh mesh = testing::sheet(5, 5);
  const auto shift = static_cast<std::uint32_t>(mesh.vertices.size());
  const TriMesh second = testing::sheet(3, 3);
  for (const Vec3& v : second.vertices) mesh.vertices.push_back(v + Vec3{1, 0, 0});
  for (const Triangle& t : second.triangles) mesh.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
  mesh.vertices.push_back({5, 5, 5});
  const VertexHierarchy h = vertex_hierarchy(object_of(mesh));
  std::size_t roots = 0;
  for (std::size_t i = 0; i < h.order.size(); ++i) roots += h.parents[0][i].empty() ? 1U : 0U;
  EXPECT_EQ(roots, 3U);
}

/// Two sheets that meet at a seam: copies of the vertices along it predict each other alone.
TEST(VertexHierarchy, CopiesOfAVertexAreNeighbours) {
  TriMesh mesh = testing::sheet(6, 6);
  const auto shift = static_cast<std::uint32_t>(mesh.vertices.size());
  const Vec3 across{mesh.vertices[6].x - mesh.vertices[0].x, 0, 0};
  for (std::uint32_t v = 0; v < shift; ++v) mesh.vertices.push_back(mesh.vertices[v] + across);
  for (std::size_t t = 0, count = mesh.triangles.size(); t < count; ++t) {
    const Triangle& c = mesh.triangles[t];
    mesh.triangles.push_back({c[0] + shift, c[1] + shift, c[2] + shift});
  }
  const DeformableObject object = object_of(mesh);
  const VertexHierarchy h = vertex_hierarchy(object);
  std::size_t roots = 0, copies = 0;
  for (std::size_t i = 0; i < h.order.size(); ++i) {
    roots += h.parents[0][i].empty() ? 1U : 0U;
    if (h.parents[0][i].empty() || object.rest[h.parents[0][i][0].vertex] != object.rest[h.order[i]]) continue;
    EXPECT_EQ(h.parents[0][i].size(), 1U);
    EXPECT_EQ(h.parents[0][i][0].weight, 32768);
    ++copies;
  }
  EXPECT_EQ(roots, 1U);
  EXPECT_EQ(copies, 7U);
}

/// A plane is predicted well from coarser vertices: weights of linear prediction, not of mere distance.
TEST(VertexHierarchy, PredictsASlopeInsideTheSheet) {
  const DeformableObject mesh = object_of(testing::sheet(30, 30));
  const VertexHierarchy h = vertex_hierarchy(mesh);
  for (std::size_t i = 0; i < h.order.size(); ++i) {
    const std::uint32_t v = h.order[i];
    const std::uint32_t column = v % 31, row = v / 31;
    if (h.depth[v] > 0 || column < 3 || column > 27 || row < 3 || row > 27) continue;
    double predicted = 0;
    for (const VertexParent& p : h.parents[0][i]) predicted += p.weight / 32768.0 * static_cast<double>(p.vertex % 31);
    EXPECT_NEAR(predicted, static_cast<double>(column), 0.2);
  }
}

/// One vertex amid 2^16 others: neither rings nor hierarchy may take the square of that.
TEST(VertexHierarchy, FanWithManySpokes) {
  constexpr std::uint32_t kSpokes = 1U << 16;
  DeformableObject mesh;
  mesh.name = "fan";
  for (std::uint32_t i = 0; i <= kSpokes; ++i)
    mesh.rest.push_back({static_cast<std::int32_t>(i % 256), static_cast<std::int32_t>(i / 256), 0});
  for (std::uint32_t i = 0; i < kSpokes; ++i) mesh.triangles.push_back({kSpokes, i, (i + 1) % kSpokes});
  EXPECT_EQ(vertex_hierarchy(mesh).order.size(), mesh.rest.size());
  Rings rings(mesh);
  EXPECT_EQ(rings.triangles_around(7, 3).size(), mesh.triangles.size());
}

TEST(VertexHierarchy, ManyVerticesAtOnePosition) {
  constexpr std::size_t kVertices = 1U << 16;
  DeformableObject mesh;
  mesh.name = "heap";
  mesh.rest.resize(kVertices);
  const VertexHierarchy h = vertex_hierarchy(mesh);
  EXPECT_EQ(h.order.size(), kVertices);
  EXPECT_EQ(std::ranges::count_if(h.order, [&](std::uint32_t v) { return h.depth[v] == h.depth[h.order[0]]; }), 1);
}

TEST(Rings, AgreeWithTheTopologyOfTriangleMeshes) {
  const TriMesh mesh = testing::sheet(9, 8);
  const DeformableObject object = object_of(mesh);
  Rings rings(object);
  const MeshTopology topology(mesh);
  for (const std::uint32_t triangle : {0U, 17U, 70U, 143U}) {
    for (std::uint32_t r = 0; r < 5; ++r) {
      const auto ours = rings.triangles_around(triangle, r);
      std::vector<std::uint32_t> a(ours.begin(), ours.end()), b;
      topology.rings_around(triangle, r, b);
      std::ranges::sort(a);
      std::ranges::sort(b);
      EXPECT_EQ(a, b);
    }
  }
}

// ==== deformable displacement ====

std::string rule_of(float value, unsigned position_exp) {
  std::array<std::array<std::int32_t, 3>, 1> out;
  const auto done = to_grid(std::vector<float>{0, value, 0}, position_exp, out);
  return done ? "" : done.error().rule;
}

TEST(Displacement, GoesToTheNearestPointAndBack) {
  const std::vector<float> metres{0.1f, -0.1f, 0, 0.5f, -0.5f, 1e-9f};
  std::array<std::array<std::int32_t, 3>, 2> grid;
  ASSERT_TRUE(to_grid(metres, 20, grid));
  for (std::size_t i = 0; i < metres.size(); ++i) {
    const Vec3 shown = to_metres(grid[i / 3], 20);
    EXPECT_LE(std::abs(std::array{shown.x, shown.y, shown.z}[i % 3] - static_cast<double>(metres[i])), std::ldexp(0.5, -20));
  }
}

TEST(Displacement, RefusesWhatTheGridCannotHold) {
  EXPECT_EQ(rule_of(std::numeric_limits<float>::quiet_NaN(), 22), "R-API-1");
  EXPECT_EQ(rule_of(-std::numeric_limits<float>::infinity(), 22), "R-API-1");
  EXPECT_EQ(rule_of(32, 22), "");  // 2^27 units
  EXPECT_EQ(rule_of(32.1f, 22), "R-API-2");
  EXPECT_EQ(rule_of(-1e30f, 22), "R-API-2");
  std::array<std::array<std::int32_t, 3>, 2> more;
  EXPECT_STREQ(to_grid(std::vector<float>{0, 0, 0}, 22, more).error().rule, "R-API-5");
}

}  // namespace
}  // namespace tactus
