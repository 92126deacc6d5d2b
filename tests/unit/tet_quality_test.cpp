// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/tets/tet_mesh.h>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace tactus::sim {
namespace {

TEST(TetQuality, RegularTetrahedronIsOneAtAnySize) {
  for (const double s : {1e-3, 1.0, 1e3}) {
    const TetQuality q = quality({{{s, s, s}, {s, -s, -s}, {-s, s, -s}, {-s, -s, s}}, {{0, 2, 1, 3}}});
    EXPECT_NEAR(q.shape.value, 1, 1e-14);
    EXPECT_NEAR(q.mean_shape, 1, 1e-14);
    EXPECT_NEAR(q.smallest_angle.value, std::acos(1.0 / 3), 1e-14);
    EXPECT_NEAR(q.largest_angle.value, std::acos(1.0 / 3), 1e-14);
  }
}

TEST(TetQuality, SlabHasTheAnglesOfACubesSixths) {
  const TetQuality q = quality(make_slab(3, 2, 1, 0.01));
  EXPECT_NEAR(q.smallest_angle.value, std::numbers::pi / 4, 1e-12);
  EXPECT_NEAR(q.largest_angle.value, std::numbers::pi / 2, 1e-12);
  // V = 1/6, squared edges 1 1 1 2 2 3: the same for all
  EXPECT_NEAR(q.shape.value, 12 * std::cbrt(0.25) / 10, 1e-12);
  EXPECT_NEAR(q.mean_shape, q.shape.value, 1e-12);
}

TEST(TetQuality, WorstTetrahedronIsNamed) {
  TetMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.3, 0.3, -1e-3}}, {{0, 1, 2, 3}, {0, 2, 1, 4}}};
  ASSERT_TRUE(check(mesh));
  const TetQuality q = quality(mesh);
  EXPECT_EQ(q.shape.tet, 1U);
  EXPECT_EQ(q.smallest_angle.tet, 1U);
  EXPECT_EQ(q.largest_angle.tet, 1U);
  EXPECT_LT(q.shape.value, 0.05);
  EXPECT_GT(q.largest_angle.value, 0.98 * std::numbers::pi);
  EXPECT_GT(q.mean_shape, 0.4);
}

}  // namespace
}  // namespace tactus::sim
