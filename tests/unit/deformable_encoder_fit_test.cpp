// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include <tactus/deformable/encoder_fit.h>

namespace tactus {
namespace {

// ==== deformable area fit ====

/// Two modes that four vertices share, with motion along two axes.
ModeBasis two_modes() {
  return {.entries = {2047, 0, 0, 1500, 0, 0, 800, 300, 0, 100, 0, 0, 0, 0, 0, 700, 0, 0, 1600, -200, 0, 2047, 0, 0},
          .steps = {1, 1}};
}

std::vector<Vec3i> uneven_error() { return {Vec3i{900, 40, 0}, Vec3i{-300, 0, 0}, Vec3i{700, 10, 5}, Vec3i{-200, 0, 90}}; }

float entry(const ModeBasis& basis, std::size_t mode, std::size_t component) {
  return static_cast<float>(basis.entries[12 * mode + component]) / 2048;
}

/// Square of what the coefficients leave at one vertex.
float left_at(const ModeBasis& basis, const std::vector<Vec3i>& error, std::span<const float> c, std::size_t v) {
  float sum = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t i = 3 * v + axis;
    const float left = static_cast<float>(error[v][axis]) - c[0] * entry(basis, 0, i) - c[1] * entry(basis, 1, i);
    sum += left * left;
  }
  return sum;
}

struct Fits {
  std::vector<float> plain, improved;
};

Fits fit(const ModeBasis& basis, const std::vector<Vec3i>& error, const BoundedArea& area) {
  ModeProjection projection(basis);
  Fits out{std::vector<float>(basis.steps.size()), {}};
  projection.project(error, out.plain);
  out.improved = out.plain;
  AreaFit(basis, projection.gram()).improve(error, area, out.improved);
  return out;
}

TEST(AreaFit, IsTheLeastOfTheWeightedSquares) {
  const ModeBasis basis = two_modes();
  const std::vector<Vec3i> error = uneven_error();
  const std::array<std::uint32_t, 1> touched{2};
  const Fits fits = fit(basis, error, {touched, 100, 800});
  const float weight = 800.0F * 800 / (100 * 100 + left_at(basis, error, fits.plain, 2));
  ASSERT_GT(weight, 2);
  ASSERT_LT(weight, 64);
  const auto weighted = [&](float a, float b) {
    const std::array<float, 2> c{a, b};
    float sum = 0;
    for (std::size_t v = 0; v < 4; ++v) sum += (v == 2 ? weight : 1) * left_at(basis, error, c, v);
    return sum;
  };
  const float a = fits.improved[0], b = fits.improved[1];
  const float least = weighted(a, b);
  EXPECT_LT(least, weighted(fits.plain[0], fits.plain[1]));
  for (const float step : {-20.0F, 20.0F}) {
    EXPECT_GT(weighted(a + step, b), least);
    EXPECT_GT(weighted(a, b + step), least);
    EXPECT_GT(weighted(a + step, b - step), least);
  }
  EXPECT_LT(left_at(basis, error, fits.improved, 2), 0.6F * left_at(basis, error, fits.plain, 2));
}

TEST(AreaFit, AVertexCountsAtMost64Times) {
  const ModeBasis basis = two_modes();
  const std::array<std::uint32_t, 1> touched{0};
  std::vector<Vec3i> error = uneven_error();
  const float reach = std::sqrt(1 + left_at(basis, error, fit(basis, error, {}).plain, 0));
  const auto weighed = [&](float weight) { return fit(basis, error, {touched, 1, std::sqrt(weight) * reach}).improved[0]; };
  EXPECT_NEAR(weighed(64), weighed(1e6F), 0.01);
  EXPECT_GT(std::abs(weighed(60) - weighed(64)), 0.1);
}

TEST(AreaFit, WhereTheBoundIsNotSmallerThePlainFitStays) {
  const ModeBasis basis = two_modes();
  const std::array<std::uint32_t, 2> touched{1, 2};
  const Fits fits = fit(basis, uneven_error(), {touched, 50, 50});
  EXPECT_EQ(fits.improved, fits.plain);
  const Fits nobody = fit(basis, uneven_error(), {{}, 1, 50});
  EXPECT_EQ(nobody.improved, nobody.plain);
}

/// An error that is far beyond the bound outside, too, will need a residual whatever the modes do.
TEST(AreaFit, WhatIsFarFromItsBoundCountsNoMore) {
  const ModeBasis basis = two_modes();
  std::vector<Vec3i> error = uneven_error();
  error[2] = {0, 0, 50000};
  const std::array<std::uint32_t, 1> touched{2};
  const Fits fits = fit(basis, error, {touched, 100, 800});
  EXPECT_EQ(fits.improved, fits.plain);
}

TEST(AreaFit, AModeThatIsZeroEverywhereStaysOut) {
  ModeBasis basis = two_modes();
  for (std::size_t i = 12; i < 24; ++i) basis.entries[i] = 0;
  const std::array<std::uint32_t, 1> touched{2};
  const Fits fits = fit(basis, uneven_error(), {touched, 100, 800});
  EXPECT_NE(fits.improved[0], fits.plain[0]);
  EXPECT_EQ(fits.improved[1], 0);
}

/// Of a large area the vertices that the touch comes first to.
TEST(AreaFit, ALargeAreaIsWeighedByItsFirstVertices) {
  constexpr std::size_t kVertices = 100;
  ModeBasis basis{.entries = {}, .steps = {1}};
  std::vector<Vec3i> error(kVertices);
  std::vector<std::uint32_t> all;
  for (std::uint32_t v = 0; v < kVertices; ++v) {
    basis.entries.insert(basis.entries.end(), {1000, 0, 0});
    error[v][0] = v < 64 ? 100 : 90;
    all.push_back(v);
  }
  const std::span<const std::uint32_t> area(all);
  EXPECT_EQ(fit(basis, error, {area, 1, 100}).improved, fit(basis, error, {area.first(64), 1, 100}).improved);
}

TEST(AreaFit, ClustersKeepThePlainFit) {
  const ModeBasis basis{.entries = {}, .steps = {1, 1, 1}};
  std::vector<float> coefficients{1, 2, 3};
  const std::array<std::uint32_t, 1> touched{0};
  const std::vector<Vec3i> error{{100, 0, 0}};
  AreaFit(basis, {}).improve(error, {touched, 1, 100}, coefficients);
  EXPECT_EQ(coefficients, (std::vector<float>{1, 2, 3}));
}

// ==== deformable mode projection ====

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
