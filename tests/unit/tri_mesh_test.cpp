// SPDX-License-Identifier: Apache-2.0
#include <tactus/base/tri_mesh.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include <tactus/sim/tets/tet_mesh.h>

namespace tactus::sim {
namespace {

/// Rows x columns unit squares in the plane z = 0, cut along the same diagonal; counter-clockwise seen from +z.
TriMesh grid(std::uint32_t rows, std::uint32_t columns) {
  TriMesh mesh;
  for (std::uint32_t j = 0; j <= rows; ++j)
    for (std::uint32_t i = 0; i <= columns; ++i) mesh.vertices.push_back({1.0 * i, 1.0 * j, 0});
  for (std::uint32_t j = 0; j < rows; ++j) {
    for (std::uint32_t i = 0; i < columns; ++i) {
      const std::uint32_t o = j * (columns + 1) + i, above = o + columns + 1;
      mesh.triangles.push_back({o, o + 1, above + 1});
      mesh.triangles.push_back({o, above + 1, above});
    }
  }
  return mesh;
}

void expect_broken(const TriMesh& mesh, std::string_view rule, std::string_view location) {
  const auto checked = check(mesh);
  ASSERT_FALSE(checked) << rule;
  EXPECT_EQ(checked.error().error.rule, rule);
  EXPECT_EQ(location_of(checked.error()), location);
}

TEST(TriMesh, SoundMeshesPass) {
  EXPECT_TRUE(check(TriMesh{}));
  EXPECT_TRUE(check(grid(3, 4)));
  EXPECT_TRUE(check(surface(make_slab(16, 20, 1, 0.01)).mesh));
}

TEST(TriMesh, VertexOutsideOfRangeIsNamed) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), -1.1e6}) {
    TriMesh mesh = grid(2, 2);
    mesh.vertices[7].y = bad;
    expect_broken(mesh, "R-SRF-8", "vertex 7");
  }
}

TEST(TriMesh, IndexBeyondTheVerticesIsNamed) {
  TriMesh mesh = grid(2, 2);
  mesh.triangles[5][1] = 9;
  expect_broken(mesh, "R-SRF-9", "triangle 5");
}

TEST(TriMesh, DegenerateTriangleIsNamed) {
  TriMesh mesh = grid(2, 2);
  mesh.triangles[3][2] = mesh.triangles[3][0];
  expect_broken(mesh, "R-SRF-10", "triangle 3");
  mesh = grid(2, 2);
  mesh.triangles.push_back({0, 1, 2});  // three vertices on a line
  expect_broken(mesh, "R-SRF-10", "triangle 8");
}

TEST(TriMesh, ThirdTriangleOfAnEdgeIsNamed) {
  TriMesh mesh = grid(2, 2);
  mesh.vertices.push_back({0.5, 0.5, 1});
  mesh.triangles.push_back({0, 4, 9});
  expect_broken(mesh, "R-SRF-11", "triangle 8");
}

TEST(TriMesh, TurnedAndDoubledTrianglesAreNamed) {
  TriMesh mesh = grid(2, 2);
  std::swap(mesh.triangles[7][0], mesh.triangles[7][1]);
  expect_broken(mesh, "R-SRF-12", "triangle 7");
  mesh = TriMesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {1, 2, 0}}};
  expect_broken(mesh, "R-SRF-12", "triangle 1");
}

TEST(TriMesh, VertexWithTwoFansIsNamed) {
  TriMesh mesh = grid(1, 1);
  mesh.vertices.insert(mesh.vertices.end(), {{2, 1, 1}, {1, 2, 1}});
  mesh.triangles.push_back({3, 4, 5});  // open fans that touch in a vertex only
  expect_broken(mesh, "R-SRF-13", "vertex 3");

  mesh = surface(make_slab(1, 1, 1, 1)).mesh;  // two closed cubes that touch in a vertex only
  const TriMesh other = mesh;
  for (const Vec3& v : other.vertices) mesh.vertices.push_back(v + Vec3{1, 1, 1});
  for (const Triangle& t : other.triangles) {
    Triangle moved{};
    std::transform(t.begin(), t.end(), moved.begin(), [](std::uint32_t v) { return v == 0 ? 7 : v + 8; });
    mesh.triangles.push_back(moved);
  }
  expect_broken(mesh, "R-SRF-13", "vertex 7");
}

TEST(TriMesh, TooManyElementsAreRefused) {
  TriMesh mesh;
  mesh.vertices.resize(kMaxMeshVertices + 1);
  expect_broken(mesh, "R-SRF-14", "");
  mesh.vertices.clear();
  mesh.triangles.resize(kMaxMeshTriangles + 1);
  expect_broken(mesh, "R-SRF-14", "");
}

TEST(MeshTopology, AgreesWithCounting) {
  const TriMesh mesh = surface(make_slab(3, 4, 2, 0.5)).mesh;
  const MeshTopology topology(mesh);
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
    std::vector<std::uint32_t> triangles;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const Triangle& corners = mesh.triangles[t];
      if (std::find(corners.begin(), corners.end(), v) == corners.end()) continue;
      triangles.push_back(t);
    }
    EXPECT_TRUE(std::ranges::equal(topology.triangles_of(v), triangles));
  }
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for (unsigned k = 0; k < 3; ++k) {
      const std::uint32_t other = topology.across(t, k);
      ASSERT_NE(other, MeshTopology::kNone);
      const Triangle& corners = mesh.triangles[other];
      const bool mutual = topology.across(other, 0) == t || topology.across(other, 1) == t || topology.across(other, 2) == t;
      EXPECT_TRUE(mutual && other != t);
      for (const std::uint32_t v : {mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]})
        EXPECT_NE(std::find(corners.begin(), corners.end(), v), corners.end());
    }
  }
}

TEST(MeshTopology, NothingLiesAcrossABoundary) {
  const MeshTopology topology(grid(1, 1));
  EXPECT_EQ(topology.across(0, 0), MeshTopology::kNone);
  EXPECT_EQ(topology.across(0, 1), MeshTopology::kNone);
  EXPECT_EQ(topology.across(0, 2), 1U);
  EXPECT_EQ(topology.across(1, 0), 0U);
}

TEST(MeshTopology, RingsGrowOverSharedVertices) {
  const TriMesh mesh = grid(9, 9);
  const MeshTopology topology(mesh);
  std::vector<std::uint32_t> rings;
  const std::uint32_t centre = 2 * (4 * 9 + 4);
  topology.rings_around(centre, 0, rings);
  EXPECT_EQ(rings, std::vector<std::uint32_t>{centre});

  std::set<std::uint32_t> known{centre};
  std::vector<std::uint32_t> expected{centre};
  for (unsigned r = 1; r <= 30; ++r) {
    std::set<std::uint32_t> next;
    for (const std::uint32_t t : known)
      for (const std::uint32_t v : mesh.triangles[t])
        for (const std::uint32_t near : topology.triangles_of(v))
          if (!known.contains(near)) next.insert(near);
    known.insert(next.begin(), next.end());
    expected.insert(expected.end(), next.begin(), next.end());
    topology.rings_around(centre, r, rings);
    EXPECT_EQ(rings, expected) << r << " rings";
  }
  EXPECT_EQ(rings.size(), mesh.triangles.size());
}

TEST(MeshTopology, FirstRingOfARegularMeshHasThirteenTriangles) {
  const MeshTopology topology(grid(5, 5));
  std::vector<std::uint32_t> rings;
  topology.rings_around(2 * (2 * 5 + 2), 1, rings);
  EXPECT_EQ(rings.size(), 13U);
}

/// One vertex in the middle of 2^19 triangles: whatever is quadratic in a vertex's triangles would not end.
TEST(MeshTopology, ALargeFanIsNoTrap) {
  constexpr std::uint32_t kSpokes = 1U << 19;
  TriMesh mesh{{{0, 0, 0}}, {}};
  for (std::uint32_t i = 0; i < kSpokes; ++i) {
    const double angle = 2 * std::numbers::pi * i / kSpokes;
    mesh.vertices.push_back({std::cos(angle), std::sin(angle), 0});
    mesh.triangles.push_back({0, 1 + i, 1 + (i + 1) % kSpokes});
  }
  ASSERT_TRUE(check(mesh));
  std::vector<std::uint32_t> rings;
  MeshTopology(mesh).rings_around(0, 5, rings);
  EXPECT_EQ(rings.size(), kSpokes);
}

}  // namespace
}  // namespace tactus::sim
