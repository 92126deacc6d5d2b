// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/tets/tet_mesh.h>

#include <gtest/gtest.h>

#include <limits>
#include <utility>

#include "tests/unit/rule_fixture.h"
#include "tests/unit/tet_fixture.h"

namespace tactus::sim {
namespace {

void expect_broken(const TetMesh& mesh, std::string_view rule, std::string_view location) {
  const auto checked = check(mesh);
  ASSERT_FALSE(checked) << rule;
  EXPECT_EQ(checked.error().error.rule, rule);
  EXPECT_EQ(location_of(checked.error()), location);
}

TEST(TetMesh, SlabHasTheCountsOfTheThesis) {
  const TetMesh mesh = make_slab(16, 20, 1, 0.01);
  EXPECT_EQ(mesh.vertices.size(), 714U);
  EXPECT_EQ(mesh.tets.size(), 1920U);
  EXPECT_TRUE(check(mesh));
  EXPECT_NEAR(total_volume(mesh), 0.16 * 0.20 * 0.01, 1e-15);
}

TEST(TetMesh, SurfaceIsClosedOutwardAndKeepsNumbers) {
  const TetMesh slab = make_slab(16, 20, 1, 0.01);
  const TetSurface outside = surface(slab);
  EXPECT_EQ(outside.mesh.triangles.size(), 1424U);
  EXPECT_EQ(outside.mesh.vertices, slab.vertices);
  EXPECT_TRUE(check(outside.mesh));
  double enclosed = 0;  // divergence theorem: positive when the triangles look outward
  for (const auto& [a, b, c] : outside.mesh.triangles)
    enclosed += dot(cross(outside.mesh.vertices[a], outside.mesh.vertices[b]), outside.mesh.vertices[c]) / 6;
  EXPECT_NEAR(enclosed, total_volume(slab), 1e-15);

  const TetSurface thick = surface(make_slab(2, 2, 2, 1));
  EXPECT_EQ(thick.mesh.vertices.size(), 26U);  // all but the one in the middle
  EXPECT_EQ(thick.vertex[13], 14U);
}

TEST(TetMesh, VertexOutsideOfRangeIsNamed) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::infinity(), 1.1e6}) {
    TetMesh mesh = make_slab(2, 1, 1, 1);
    mesh.vertices[4].z = bad;
    expect_broken(mesh, "R-TET-1", "vertex 4");
  }
}

TEST(TetMesh, IndexBeyondTheVerticesIsNamed) {
  TetMesh mesh = make_slab(2, 1, 1, 1);
  mesh.tets[11][0] = 12;
  expect_broken(mesh, "R-TET-2", "tetrahedron 11");
}

TEST(TetMesh, FlatTetrahedraAreNamedAtAnyScale) {
  TetMesh mesh = make_slab(2, 1, 1, 1);
  mesh.tets[3][1] = mesh.tets[3][2];
  expect_broken(mesh, "R-TET-3", "tetrahedron 3");
  for (const double scale : {1e-4, 1.0, 1e5}) {
    TetMesh sliver{{{0, 0, 0}, {scale, 0, 0}, {0, scale, 0}, {scale, scale, 5e-12 * scale}}, {{0, 1, 2, 3}}};
    expect_broken(sliver, "R-TET-3", "tetrahedron 0");  // 0.83e-12 / 2.83 of the longest edge's cube
    sliver.vertices[3].z = 2e-11 * scale;
    EXPECT_TRUE(check(sliver));
  }
}

TEST(TetMesh, InsideOutIsNamed) {
  TetMesh mesh = make_slab(2, 1, 1, 1);
  std::swap(mesh.tets[8][0], mesh.tets[8][1]);
  expect_broken(mesh, "R-TET-4", "tetrahedron 8");
}

TEST(TetMesh, SharedFacesAreNamed) {
  TetMesh mesh = make_slab(2, 1, 1, 1);
  mesh.tets.push_back(mesh.tets[2]);
  expect_broken(mesh, "R-TET-5", "tetrahedron 12");

  mesh = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}, {1, 2, 0, 3}}};  // alone, but twice
  expect_broken(mesh, "R-TET-5", "tetrahedron 1");

  mesh = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 2}}, {{0, 1, 2, 3}, {0, 1, 2, 4}}};  // one inside the other
  expect_broken(mesh, "R-TET-5", "tetrahedron 1");

  mesh.vertices[4].z = -1;
  mesh.tets[1] = {0, 2, 1, 4};
  EXPECT_TRUE(check(mesh));
}

TEST(TetMesh, VertexWithoutTetrahedronIsNamed) {
  TetMesh mesh = make_slab(2, 1, 1, 1);
  mesh.vertices.push_back({5, 5, 5});
  expect_broken(mesh, "R-TET-6", "vertex 12");
}

TEST(TetMesh, TooManyElementsAreRefused) {
  TetMesh mesh;
  mesh.vertices.resize(kMaxMeshVertices + 1);
  expect_broken(mesh, "R-TET-7", "");
  mesh.vertices.clear();
  mesh.tets.resize(kMaxTets + 1);
  expect_broken(mesh, "R-TET-7", "");
}

TEST(TetMesh, TheTableOfRulesNamesItsLimits) {
  using tactus::testing::count;
  tactus::testing::expect_limits("R-TET-7", {count(kMaxMeshVertices) + " vertices", count(kMaxTets) + " tetrahedra"});
  tactus::testing::expect_limits("R-TET-9", {count(kMaxMeshVertices) + " vertices", count(kMaxTets) + " tetrahedra"});
  tactus::testing::expect_limits("R-SRF-2", {count(kMaxMeshVertices) + " vertices", count(kMaxMeshTriangles) + " faces"});
  tactus::testing::expect_limits("R-TGN-5", {count(kMaxTets) + " tetrahedra"});
}

}  // namespace
}  // namespace tactus::sim
