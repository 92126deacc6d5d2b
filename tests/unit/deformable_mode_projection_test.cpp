// SPDX-License-Identifier: Apache-2.0
#include <tactus/deformable/encoder_fit.h>

#include <gtest/gtest.h>

#include <array>

namespace tactus {
namespace {

/// Two modes of two vertices that are not orthogonal.
const ModeBasis kBasis{.entries = {2047, 0, 0, 1000, 0, 0, 1000, 500, 0, -300, 0, 20}, .steps = {1, 1}};

TEST(ModeProjection, FindsWhatWasCombined) {
  std::array<Vec3i, 2> error{};
  for (std::size_t v = 0; v < 2; ++v)
    for (std::size_t axis = 0; axis < 3; ++axis)
      error[v][axis] = 3 * kBasis.entries[3 * v + axis] - 2 * kBasis.entries[6 + 3 * v + axis];
  std::array<float, 2> found{};
  ModeProjection(kBasis).project(error, found);
  EXPECT_NEAR(found[0], 3 * 2048, 0.01 * 2048);  // entries are x 2^-11; the Gram matrix has a ridge of 0.1 %
  EXPECT_NEAR(found[1], -2 * 2048, 0.02 * 2048);
}

TEST(ModeProjection, WhatNoModeReachesIsLeft) {
  const std::array<Vec3i, 2> across{Vec3i{0, 0, 1000}, Vec3i{0, 1000, 0}};
  std::array<float, 2> found{1, 1};
  ModeProjection(kBasis).project(across, found);
  EXPECT_NEAR(found[0], 0, 1e-3);
  EXPECT_NEAR(found[1], 0, 1e-3);
}

}  // namespace
}  // namespace tactus
