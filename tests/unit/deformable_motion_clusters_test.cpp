// SPDX-License-Identifier: Apache-2.0
#include <tactus/deformable/motion_clusters.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "tests/unit/deformable_fixture.h"

namespace tactus {
namespace {

constexpr std::uint32_t kSquares = 20;

/// A sheet that folds: what lies beyond the middle turns about it.
std::vector<std::vector<float>> folding(const TriMesh& rest, std::size_t shapes) {
  const double hinge = rest.vertices.back().x / 2;
  std::vector<std::vector<float>> out(shapes);
  for (std::size_t s = 0; s < shapes; ++s) {
    const double angle = 0.1 * static_cast<double>(s);
    for (const Vec3& p : rest.vertices) {
      const double beyond = std::max(0.0, p.x - hinge);
      const Vec3 u{beyond * (std::cos(angle) - 1), 0, beyond * std::sin(angle)};
      out[s].insert(out[s].end(), {static_cast<float>(u.x), static_cast<float>(u.y), static_cast<float>(u.z)});
    }
  }
  return out;
}

TEST(MotionClusters, SeparatesWhatMovesApart) {
  const TriMesh rest = testing::sheet(kSquares, kSquares);
  const auto found = motion_clusters(rest, folding(rest, 12), 4);
  ASSERT_TRUE(found);
  const double hinge = rest.vertices.back().x / 2;
  std::set<std::uint8_t> left, right;
  for (std::size_t v = 0; v < rest.vertices.size(); ++v) {
    if (rest.vertices[v].x < hinge - 1e-6) left.insert(found->clusters[v]);
    if (rest.vertices[v].x > hinge + 1e-6) right.insert(found->clusters[v]);
  }
  for (const std::uint8_t c : left) EXPECT_FALSE(right.contains(c)) << "cluster " << int{c} << " is on both sides of the hinge";
  EXPECT_EQ(found->blend, 441 / (16 * found->count));
}

TEST(MotionClusters, NumbersAllAndNoMoreThanAsked) {
  const TriMesh rest = testing::sheet(kSquares, kSquares);
  const auto found = motion_clusters(rest, folding(rest, 6), 9);
  ASSERT_TRUE(found);
  const std::set<std::uint8_t> used(found->clusters.begin(), found->clusters.end());
  EXPECT_LE(found->count, 9);
  EXPECT_EQ(used.size(), found->count);
  EXPECT_EQ(*used.rbegin() + 1, found->count);
}

/// A still mesh, a single vertex, and parts that are smaller than a cluster.
TEST(MotionClusters, OfDegenerateMeshesAreFinite) {
  const TriMesh rest = testing::sheet(3, 3);
  const std::vector<std::vector<float>> still(2, std::vector<float>(3 * rest.vertices.size()));
  ASSERT_TRUE(motion_clusters(rest, still, 64));
  const TriMesh point{.vertices = {{1, 2, 3}}, .triangles = {}};
  const auto one = motion_clusters(point, std::vector<std::vector<float>>{{1, 2, 3}}, 64);
  ASSERT_TRUE(one);
  EXPECT_EQ(one->count, 1);
  EXPECT_EQ(one->blend, 0);
  TriMesh dust;
  std::vector<float> shape;
  for (int v = 0; v < 100; ++v) {
    dust.vertices.push_back({0.01 * v, 0, 0});
    shape.insert(shape.end(), {0, v % 7 == 0 ? 1.0F : 0.0F, 0});
  }
  ASSERT_TRUE(motion_clusters(dust, std::vector<std::vector<float>>{shape}, 10));
}

TEST(MotionClusters, RefusesWhatDoesNotFit) {
  const TriMesh rest = testing::sheet(2, 2);
  const std::vector<std::vector<float>> good(1, std::vector<float>(27));
  EXPECT_STREQ(motion_clusters(rest, good, 0).error().rule, "R-API-4");
  EXPECT_STREQ(motion_clusters(rest, good, 65).error().rule, "R-API-4");
  EXPECT_STREQ(motion_clusters(rest, {}, 2).error().rule, "R-API-5");
  EXPECT_STREQ(motion_clusters(rest, std::vector<std::vector<float>>(1, std::vector<float>(26)), 2).error().rule, "R-API-5");
  auto bad = good;
  bad[0][5] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_STREQ(motion_clusters(rest, bad, 2).error().rule, "R-API-1");
}

}  // namespace
}  // namespace tactus
