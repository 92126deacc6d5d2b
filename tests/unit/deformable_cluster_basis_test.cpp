// SPDX-License-Identifier: Apache-2.0
#include <tactus/deformable/basis.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "tests/unit/deformable_fixture.h"

namespace tactus {
namespace {

/// A sheet whose left and right halves are clusters.
DeformableObject halves(std::uint8_t blend, std::uint32_t squares = 8) {
  const TriMesh mesh = testing::sheet(squares, squares);
  DeformableObject out = make_deformable_object("m", mesh, 22).value();
  out.cluster_basis = {2, blend, {}};
  for (const Vec3& p : mesh.vertices) out.cluster_basis.clusters.push_back(p.x > mesh.vertices.back().x / 2 ? 1 : 0);
  return out;
}

/// Sum of the first function over the clusters, which is the share [x 2^-11].
int whole(std::span<const ClusterShare> shares) {
  int sum = 0;
  for (const ClusterShare& share : shares) sum += share.values[0];
  return sum;
}

TEST(ClusterBasis, GivesEachVertexToItsClusterAlone) {
  const DeformableObject object = halves(0);
  const ModeBasis basis = cluster_basis(object);
  ASSERT_EQ(basis.shares.size(), object.rest.size());
  ASSERT_EQ(basis.steps.size(), 24U);
  for (std::size_t v = 0; v < object.rest.size(); ++v) {
    ASSERT_EQ(basis.shares[v].size(), 1U);
    EXPECT_EQ(basis.shares[v][0].cluster, object.cluster_basis.clusters[v]);
    EXPECT_EQ(basis.shares[v][0].values[0], ModeBasis::kMaxEntry);
  }
  EXPECT_GE(*std::ranges::min_element(basis.steps), 1);
}

TEST(ClusterBasis, SharesAddToTheWholeAndReachAsFarAsTheyAreBlended) {
  for (const std::uint8_t blend : {std::uint8_t{1}, std::uint8_t{3}}) {
    const DeformableObject object = halves(blend, 30);
    const ModeBasis basis = cluster_basis(object);
    std::size_t mixed = 0;
    for (std::size_t v = 0; v < object.rest.size(); ++v) {
      EXPECT_NEAR(whole(basis.shares[v]), ModeBasis::kMaxEntry, 1) << v;
      mixed += basis.shares[v].size() > 1 ? 1u : 0u;
    }
    EXPECT_EQ(mixed, 2u * blend * 31u);  // so many columns of vertices on each side of the border
  }
}

/// What a cluster's functions span are affine maps: the fourth is 0 where the cluster is flat, and none repeats another.
TEST(ClusterBasis, FunctionsAreOrthogonalAndZeroWhereTheClusterIsFlat) {
  DeformableObject flat = halves(0);
  for (auto& p : flat.rest) p[2] = 1234;
  const ModeBasis basis = cluster_basis(flat);
  for (const ClusterShare& share : basis.shares.items) EXPECT_EQ(share.values[3], 0);
  DeformableObject curved = halves(0);
  for (auto& p : curved.rest) p[2] = (p[0] >> 4) * (p[1] >> 10);
  const ModeBasis bent = cluster_basis(curved);
  std::array<std::array<double, 4>, 4> products{};
  for (const ClusterShare& share : bent.shares.items)
    for (std::size_t i = 0; share.cluster == 1 && i < 4; ++i)
      for (std::size_t j = 0; j < 4; ++j) products[i][j] += double{1} * share.values[i] * share.values[j];
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

TEST(ClusterBasis, OfVerticesInOnePlaceOrAloneIsFinite) {
  DeformableObject heap;
  heap.rest.resize(300);
  heap.cluster_basis = {64, 32, {}};
  for (std::size_t v = 0; v < 300; ++v) heap.cluster_basis.clusters.push_back(static_cast<std::uint8_t>(v % 3));
  const ModeBasis basis = cluster_basis(heap);
  EXPECT_EQ(basis.steps.size(), 768U);
  EXPECT_GE(*std::ranges::min_element(basis.steps), 1);
  for (std::size_t v = 0; v < 300; ++v)
    for (const ClusterShare& share : basis.shares[v]) EXPECT_EQ(share.values[1], 0);
}

}  // namespace
}  // namespace tactus
