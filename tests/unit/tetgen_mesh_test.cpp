// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/surface/tetgen.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "tests/unit/tet_fixture.h"

namespace tactus::sim {
namespace {

/// The program is a package of its own; without it these tests say that they are skipped.
bool has_tetgen() {
  const auto filled = fill(surface(make_slab(1, 1, 1, 1)).mesh, {});
  return filled || std::string_view(filled.error().error.rule) != "R-TGN-1";
}
#define NEEDS_TETGEN() \
  if (!has_tetgen()) GTEST_SKIP() << "the program tetgen is not installed (apt-get install tetgen)"

void expect_broken(const tl::expected<TetMesh, Diagnostic>& filled, std::string_view rule, std::string_view detail) {
  ASSERT_FALSE(filled) << rule;
  EXPECT_EQ(filled.error().error.rule, rule) << to_string(filled.error());
  EXPECT_EQ(location_of(filled.error()), detail);
}

TriMesh moved(TriMesh mesh, const Vec3& by) {
  for (Vec3& v : mesh.vertices) v = v + by;
  return mesh;
}

TriMesh joined(TriMesh mesh, const TriMesh& other) {
  const auto start = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& [a, b, c] : other.triangles) mesh.triangles.push_back({a + start, b + start, c + start});
  return mesh;
}

TEST(TetGen, SlabsSurfaceGivesTheCountsOfTheThesis) {
  NEEDS_TETGEN();
  const TriMesh outside = surface(make_slab(16, 20, 1, 0.01)).mesh;
  const auto filled = fill(outside, {});
  ASSERT_TRUE(filled) << to_string(filled.error());
  EXPECT_EQ(filled->vertices.size(), 714U);
  EXPECT_EQ(filled->tets.size(), 1920U);
  EXPECT_EQ(filled->vertices, outside.vertices);
  EXPECT_EQ(surface(*filled).mesh.triangles.size(), 1424U);
}

TEST(TetGen, LargestVolumeHoldsWhereTheSurfaceMayBeSplit) {
  NEEDS_TETGEN();
  const TriMesh outside = surface(make_slab(3, 3, 3, 0.1)).mesh;
  const auto filled = fill(outside, {.boundary = Boundary::split, .max_volume = 1e-5, .quality = 1.5});
  ASSERT_TRUE(filled) << to_string(filled.error());
  EXPECT_GT(filled->tets.size(), 2700U);  // 0.027 m^3 in parts of at most 1e-5
  for (std::size_t t = 0; t < filled->tets.size(); ++t) ASSERT_LE(volume(*filled, t), 1e-5 * (1 + 1e-9));
  EXPECT_GT(surface(*filled).mesh.triangles.size(), outside.triangles.size());
  EXPECT_TRUE(std::equal(outside.vertices.begin(), outside.vertices.end(), filled->vertices.begin()));
}

TEST(TetGen, KeptSurfacesHaveNewPointsInsideOnly) {
  NEEDS_TETGEN();
  const TriMesh outside = surface(make_slab(3, 3, 3, 0.1)).mesh;
  const auto filled = fill(outside, {.max_volume = 1e-5, .quality = 1.5});
  ASSERT_TRUE(filled) << to_string(filled.error());
  EXPECT_GT(filled->vertices.size(), outside.vertices.size());
  EXPECT_EQ(surface(*filled).mesh.vertices, outside.vertices);
  EXPECT_EQ(surface(*filled).mesh.triangles.size(), outside.triangles.size());
}

TEST(TetGen, TinyAndFarSurfacesAreFilled) {
  NEEDS_TETGEN();
  for (const double cell : {1e-5, 1e3}) EXPECT_TRUE(fill(surface(make_slab(2, 2, 2, cell)).mesh, {}));
  EXPECT_TRUE(fill(moved(surface(make_slab(2, 2, 2, 0.01)).mesh, {10, 20, 30}), {}));
}

TEST(TetGen, HolesNameTheirTriangle) {
  TriMesh mesh = surface(make_slab(2, 2, 1, 1)).mesh;
  const Triangle removed = mesh.triangles.back();
  mesh.triangles.pop_back();
  const auto filled = fill(mesh, {});
  ASSERT_FALSE(filled);
  EXPECT_STREQ(filled.error().error.rule, "R-TGN-2");
  const Triangle named = mesh.triangles.at(filled.error().element);
  std::size_t shared = 0;
  for (const std::uint32_t v : named) shared += static_cast<std::size_t>(std::count(removed.begin(), removed.end(), v));
  EXPECT_EQ(shared, 2U);
}

TEST(TetGen, TrianglesThatCutEachOtherAreNamed) {
  NEEDS_TETGEN();
  const TriMesh tetrahedron{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
  expect_broken(fill(joined(tetrahedron, moved(tetrahedron, {0.1, 0.1, 0.1})), {}), "R-TGN-3", "triangles 2 and 4");
}

TEST(TetGen, SurfacesThatEncloseNothingAreRefused) {
  TriMesh inward = surface(make_slab(1, 1, 1, 1)).mesh;
  for (Triangle& t : inward.triangles) std::swap(t[0], t[1]);
  expect_broken(fill(inward, {}), "R-TGN-4", "");
  expect_broken(fill(TriMesh{}, {}), "R-TGN-4", "");
}

TEST(TetGen, CavitiesAreNotFilledUnnoticed) {
  NEEDS_TETGEN();
  TriMesh cavity = moved(surface(make_slab(1, 1, 1, 1)).mesh, {1, 1, 1});
  for (Triangle& t : cavity.triangles) std::swap(t[0], t[1]);
  expect_broken(fill(joined(surface(make_slab(3, 3, 3, 1)).mesh, cavity), {}), "R-TGN-9", "27 m^3 filled, 26 m^3 enclosed");
}

TEST(TetGen, UnusedAndDoubledVerticesAreNamed) {
  TriMesh mesh = surface(make_slab(1, 1, 1, 1)).mesh;
  mesh.vertices.push_back({5, 5, 5});
  expect_broken(fill(mesh, {}), "R-TGN-8", "vertex 8");
  const TriMesh cube = surface(make_slab(1, 1, 1, 1)).mesh;
  expect_broken(fill(joined(cube, moved(cube, {1, 1, 1})), {}), "R-TGN-8", "vertices 7 and 8");
}

TEST(TetGen, BrokenMeshesAndOptionsAreRefused) {
  TriMesh mesh = surface(make_slab(1, 1, 1, 1)).mesh;
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const FillOptions& options : {FillOptions{.max_volume = -1}, FillOptions{.max_volume = kNan}, FillOptions{.quality = 1},
                                     FillOptions{.quality = kNan}, FillOptions{.time_limit = 0}})
    expect_broken(fill(mesh, options), "R-TGN-7", "");
  expect_broken(fill(mesh, {.max_volume = 1e-9}), "R-TGN-5", "");
  mesh.vertices[3].x = kNan;
  expect_broken(fill(mesh, {}), "R-SRF-8", "vertex 3");
}

TEST(TetGen, MissingFailingAndHangingProgramsAreReported) {
  const TempFolder folder;
  const TriMesh mesh = surface(make_slab(1, 1, 1, 1)).mesh;
  const auto program = [&](std::string_view name, std::string_view text) {
    const std::string path = folder.write(name, text);
    std::filesystem::permissions(path, std::filesystem::perms::owner_all);
    return path;
  };
  const auto missing = fill(mesh, {.program = "tetgen-that-is-not-there"});
  expect_broken(missing, "R-TGN-1", "tetgen-that-is-not-there");
  EXPECT_NE(to_string(missing.error()).find("apt-get install tetgen"), std::string::npos);
  const std::string failing = program("failing", "#!/bin/sh\npwd > " + folder.file("where") + "\necho out of memory\nexit 3\n");
  expect_broken(fill(mesh, {.program = failing}), "R-TGN-6", failing + " says 'out of memory'");
  const std::string silent = program("silent", "#!/bin/sh\nexit 0\n");
  expect_broken(fill(mesh, {.program = silent}), "R-TGN-6", silent);
  expect_broken(fill(mesh, {.time_limit = 0.05, .program = program("hanging", "#!/bin/sh\nexec sleep 60\n")}), "R-TGN-5", "");
  std::string where = read_all(folder.file("where"));
  where.pop_back();
  ASSERT_NE(where, "");
  EXPECT_FALSE(std::filesystem::exists(where)) << "the private folder is left behind";
}

}  // namespace
}  // namespace tactus::sim
