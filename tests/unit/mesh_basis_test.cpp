// SPDX-License-Identifier: Apache-2.0
/// Bases that both ends compute.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <set>
#include <utility>

#include <tactus/deformable/motion_clusters.h>
#include <tactus/mesh/basis.h>
#include "tests/unit/deformable_fixture.h"

namespace tactus {
namespace {

// ==== deformable spring basis ====

/// Upper and lower side of a slab: springs reach through it.
TriMesh slab(std::uint32_t nx, std::uint32_t ny) {
  TriMesh mesh = testing::sheet(nx, ny);
  const std::size_t vertices = mesh.vertices.size(), triangles = mesh.triangles.size();
  for (std::size_t v = 0; v < vertices; ++v) mesh.vertices.push_back(mesh.vertices[v] - Vec3{0, 0, 0.004});
  for (std::size_t t = 0; t < triangles; ++t) {
    const Triangle up = mesh.triangles[t];
    const auto below = static_cast<std::uint32_t>(vertices);
    mesh.triangles.push_back({up[0] + below, up[2] + below, up[1] + below});
  }
  return mesh;
}

DeformableObject object_of(const TriMesh& mesh, std::uint8_t modes, std::vector<std::uint32_t> fixed = {}) {
  DeformableObject out = make_deformable_object("m", mesh, 22).value();
  out.spring_basis = {modes, std::move(fixed)};
  return out;
}

/// Fraction of a vector's square that lies outside the span of the modes.
double outside(const ModeBasis& basis, std::vector<double> vector) {
  const std::size_t size = vector.size();
  const auto product = [&](const auto& a, const auto& b) {
    double sum = 0;
    for (std::size_t i = 0; i < size; ++i) sum += a(i) * b(i);
    return sum;
  };
  const auto v = [&](std::size_t i) { return vector[i]; };
  const double whole = product(v, v);
  for (int pass = 0; pass < 3; ++pass) {  // rounded modes are not quite orthogonal
    for (std::size_t k = 0; k < basis.steps.size(); ++k) {
      const auto mode = [&](std::size_t i) { return static_cast<double>(basis.entries[k * size + i]); };
      const double coefficient = product(v, mode) / product(mode, mode);
      for (std::size_t i = 0; i < size; ++i) vector[i] -= coefficient * mode(i);
    }
  }
  return product(v, v) / whole;
}

TEST(SpringBasis, HasTheSameBitsAgainAndRestsWhereFixed) {
  const std::vector<std::uint32_t> fixed{0, 8, 45, 53};
  const DeformableObject object = object_of(slab(8, 5), 10, fixed);
  const ModeBasis basis = spring_basis(object);
  EXPECT_EQ(basis, spring_basis(object));
  ASSERT_EQ(basis.steps.size(), 10U);
  const std::size_t size = 3 * object.rest.size();
  ASSERT_EQ(basis.entries.size(), 10 * size);
  for (std::size_t k = 0; k < 10; ++k) {
    const auto mode = std::span(basis.entries).subspan(k * size, size);
    EXPECT_EQ(std::abs(*std::ranges::max_element(mode, {}, [](int e) { return std::abs(e); })), ModeBasis::kMaxEntry);
    for (const std::uint32_t v : fixed)
      for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_EQ(mode[3 * v + axis], 0);
  }
}

/// No spring changes its length under a rigid motion: what is free moves so before it deforms. Also beyond the core.
TEST(SpringBasis, OfAFreeBodyContainsItsRigidMotions) {
  for (const std::uint32_t squares : {8U, 40U}) {
    const TriMesh mesh = slab(squares, squares);
    const ModeBasis basis = spring_basis(object_of(mesh, 12));
    std::vector<double> shift, turn;
    for (const Vec3& x : mesh.vertices) {
      shift.insert(shift.end(), {0.6, 0, 0.8});
      turn.insert(turn.end(), {-x.y, x.x, 0});
    }
    EXPECT_LT(outside(basis, shift), 1e-3) << squares;
    EXPECT_LT(outside(basis, turn), 1e-2) << squares;
  }
}

/// A flat sheet gives way out of its plane first.
TEST(SpringBasis, OfASheetMovesOutOfItsPlane) {
  const TriMesh mesh = testing::sheet(60, 60);
  std::vector<std::uint32_t> rim;
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v)
    if (v % 61 == 0 || v % 61 == 60 || v / 61 == 0 || v / 61 == 60) rim.push_back(v);
  std::vector<double> bulge;
  for (const Vec3& x : mesh.vertices) {
    const double s = x.x / 0.24, t = x.y / 0.24;
    bulge.insert(bulge.end(), {0, 0, 16 * s * (1 - s) * t * (1 - t)});
  }
  EXPECT_LT(outside(spring_basis(object_of(mesh, 12, rim)), bulge), 0.05);
}

TEST(SpringBasis, OfVerticesAtOnePositionOrWithoutSpringsIsFinite) {
  const auto largest = [](const ModeBasis& basis) {
    int out = 0;
    for (const auto entry : basis.entries) out = std::max(out, std::abs(static_cast<int>(entry)));
    return out;
  };
  DeformableObject heap;
  heap.rest.resize(2000);
  heap.spring_basis = {8, {}};
  const ModeBasis loose = spring_basis(heap);
  EXPECT_EQ(loose.steps.size(), 8U);
  EXPECT_EQ(largest(loose), 2047);
  EXPECT_GE(*std::ranges::min_element(loose.steps), 1);
  for (std::uint32_t v = 0; v < 1999; ++v) heap.spring_basis.fixed.push_back(v);
  heap.spring_basis.modes = 3;
  const ModeBasis none = spring_basis(heap);  // the free vertex lies beyond every network
  EXPECT_EQ(none.steps.size(), 3U);
  EXPECT_EQ(largest(none), 0);
  EXPECT_GE(*std::ranges::min_element(none.steps), 1);
}

TEST(RitzVectors, AreOrthonormalAndDiagonaliseTheNetwork) {
  const DeformableObject object = object_of(slab(5, 5), 1);
  std::vector<std::uint32_t> members;
  for (std::uint32_t v = 0; v < object.rest.size(); ++v) members.push_back(v);
  std::vector<std::uint8_t> free(members.size(), 1);
  free[3] = 0;
  const SpringNetwork network(object.rest, members, free);
  std::mt19937 random(3);
  Columns x(3 * members.size(), 9), product(3 * members.size(), 9);
  for (std::size_t r = 0; r < x.rows; ++r)
    for (std::size_t c = 0; c < 9 && free[r / 3]; ++c) x.row(r)[c] = static_cast<double>(random()) / 4e9 - 0.5;
  network.multiply(x, product);
  const std::vector<double> values = rotate_to_ritz_vectors(x, product);
  network.multiply(x, product);
  for (std::size_t a = 0; a < 9; ++a) {
    for (std::size_t b = 0; b < 9; ++b) {
      double metric = 0, energy = 0;
      for (std::size_t r = 0; r < x.rows; ++r) {
        metric += x.row(r)[a] * x.row(r)[b];
        energy += x.row(r)[a] * product.row(r)[b];
      }
      EXPECT_NEAR(metric, a == b ? 1 : 0, 1e-12);
      EXPECT_NEAR(energy, a == b ? values[a] : 0, 1e-6 * network.bound());
    }
    EXPECT_LE(values[a], network.bound());
    if (a > 0) {
      EXPECT_LE(values[a - 1], values[a]);
    }
  }
}

// ==== deformable cluster basis ====

/// A sheet whose left and right halves are clusters.
DeformableObject halves(std::uint8_t blend, std::uint32_t squares = 8) {
  const TriMesh mesh = testing::sheet(squares, squares);
  DeformableObject out = make_deformable_object("m", mesh, 22).value();
  out.cluster_basis = {2, blend, {}};
  for (const Vec3& p : mesh.vertices) out.cluster_basis.clusters.push_back(p.x > mesh.vertices.back().x / 2 ? 1 : 0);
  return out;
}

/// Sum of the first function over the clusters, which is the weight [x 2^-11].
int whole(std::span<const ClusterEntry> entries) {
  int sum = 0;
  for (const ClusterEntry& entry : entries) sum += entry.values[0];
  return sum;
}

TEST(ClusterBasis, GivesEachVertexToItsClusterAlone) {
  const DeformableObject object = halves(0);
  const ModeBasis basis = cluster_basis(object);
  ASSERT_EQ(basis.cluster_entries.size(), object.rest.size());
  ASSERT_EQ(basis.steps.size(), 24U);
  for (std::size_t v = 0; v < object.rest.size(); ++v) {
    ASSERT_EQ(basis.cluster_entries[v].size(), 1U);
    EXPECT_EQ(basis.cluster_entries[v][0].cluster, object.cluster_basis.clusters[v]);
    EXPECT_EQ(basis.cluster_entries[v][0].values[0], ModeBasis::kMaxEntry);
  }
  EXPECT_GE(*std::ranges::min_element(basis.steps), 1);
}

TEST(ClusterBasis, WeightsAddToTheWholeAndReachAsFarAsTheyAreBlended) {
  for (const std::uint8_t blend : {std::uint8_t{1}, std::uint8_t{3}}) {
    const DeformableObject object = halves(blend, 30);
    const ModeBasis basis = cluster_basis(object);
    std::size_t mixed = 0;
    for (std::size_t v = 0; v < object.rest.size(); ++v) {
      EXPECT_NEAR(whole(basis.cluster_entries[v]), ModeBasis::kMaxEntry, 1) << v;
      mixed += basis.cluster_entries[v].size() > 1 ? 1u : 0u;
    }
    EXPECT_EQ(mixed, 2u * blend * 31u);  // so many columns of vertices on each side of the border
  }
}

/// What a cluster's functions span are affine maps: the fourth is 0 where the cluster is flat, and none repeats another.
TEST(ClusterBasis, FunctionsAreOrthogonalAndZeroWhereTheClusterIsFlat) {
  DeformableObject flat = halves(0);
  for (auto& p : flat.rest) p[2] = 1234;
  const ModeBasis basis = cluster_basis(flat);
  for (const ClusterEntry& entry : basis.cluster_entries.items) EXPECT_EQ(entry.values[3], 0);
  DeformableObject curved = halves(0);
  for (auto& p : curved.rest) p[2] = (p[0] >> 4) * (p[1] >> 10);
  const ModeBasis bent = cluster_basis(curved);
  std::array<std::array<double, 4>, 4> products{};
  for (const ClusterEntry& entry : bent.cluster_entries.items)
    for (std::size_t i = 0; entry.cluster == 1 && i < 4; ++i)
      for (std::size_t j = 0; j < 4; ++j) products[i][j] += double{1} * entry.values[i] * entry.values[j];
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_GT(products[i][i], 0);
    for (std::size_t j = 0; j < i; ++j) EXPECT_LT(std::abs(products[i][j]), 1e-3 * std::sqrt(products[i][i] * products[j][j]));
  }
}

TEST(ClusterBasis, ExpectsTheClusterOfTheLowestNeighbour) {
  const std::vector<std::uint8_t> clusters{3, 1, 2};
  EXPECT_EQ(expected_cluster(std::vector<std::uint32_t>{7, 1}, clusters, 3), 1);
  EXPECT_EQ(expected_cluster(std::vector<std::uint32_t>{7, 9}, clusters, 3), 2);
  EXPECT_EQ(expected_cluster({}, clusters, 1), 3);
  EXPECT_EQ(expected_cluster(std::vector<std::uint32_t>{1}, {}, 0), 0);
}

TEST(ClusterBasis, OfVerticesAtOnePositionOrAloneIsFinite) {
  DeformableObject heap;
  heap.rest.resize(300);
  heap.cluster_basis = {64, 32, {}};
  for (std::size_t v = 0; v < 300; ++v) heap.cluster_basis.clusters.push_back(static_cast<std::uint8_t>(v % 3));
  const ModeBasis basis = cluster_basis(heap);
  EXPECT_EQ(basis.steps.size(), 768U);
  EXPECT_GE(*std::ranges::min_element(basis.steps), 1);
  for (std::size_t v = 0; v < 300; ++v)
    for (const ClusterEntry& entry : basis.cluster_entries[v]) EXPECT_EQ(entry.values[1], 0);
}

// ==== deformable motion clusters ====

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
