// SPDX-License-Identifier: Apache-2.0
#include <tactus/deformable/basis.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "tests/unit/deformable_fixture.h"

namespace tactus {
namespace {

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

/// Share of a vector's square that lies outside the span of the modes.
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

TEST(SpringBasis, OfVerticesInOnePlaceOrWithoutSpringsIsFinite) {
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

}  // namespace
}  // namespace tactus
