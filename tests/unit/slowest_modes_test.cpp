// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/modes/slowest_modes.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <tactus/sim/fem/cholesky.h>
#include "tests/unit/fem_fixture.h"

namespace tactus::sim {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// K at rest and M of an object.
struct Vibration {
  explicit Vibration(FemModel model) : M(model.mass_matrix()) { model.stiffness(VectorXd::Zero(model.size()), K); }

  Modes modes(int count) const { return slowest_modes(K, M, count).value(); }
  /// All of them, which a dense solver finds: as many that solve the equation and are orthonormal leave none out.
  VectorXd dense() const {
    const Modes all = slowest_modes(K, M, K.rows()).value();
    EXPECT_LT(residual(all), 1e-10);
    EXPECT_LT(skew(all), 1e-11);
    EXPECT_TRUE(std::ranges::is_sorted(all.squares));
    return all.squares;
  }
  /// Largest |K phi - lambda M phi| in the norm of M^-1, of the largest entry of the diagonal of M^-1 K.
  double residual(const Modes& modes) const {
    const MatrixXd rest = K * modes.shapes - M * modes.shapes * modes.squares.asDiagonal();
    Cholesky factor;
    factor.analyse(M);
    EXPECT_TRUE(factor.factor(M));
    double largest = 0;
    VectorXd weighted(M.rows());
    for (const VectorXd column : rest.colwise()) {
      factor.solve(column, weighted);
      largest = std::max(largest, std::sqrt(column.dot(weighted)));
    }
    return largest / K.diagonal().cwiseQuotient(M.diagonal()).maxCoeff();
  }
  double skew(const Modes& modes) const {
    const MatrixXd unity = modes.shapes.transpose() * (M * modes.shapes);
    return (unity - MatrixXd::Identity(unity.rows(), unity.cols())).cwiseAbs().maxCoeff();
  }

  SparseMatrix K, M;
};

Vibration beam(std::uint32_t length, MassMatrix mass) {
  FemOptions options;
  options.materials = {{1e5, 0.3, 1000}};
  options.mass = mass;
  TetMesh mesh = make_slab(length, 2, 2, 0.01);
  for (std::uint32_t i = 0; i < mesh.vertices.size(); ++i)
    if (mesh.vertices[i].x == 0) options.fixed.push_back(i);
  return Vibration(testing::make_model(std::move(mesh), options));
}

/// Equal parts, apart from each other, nothing fixed.
Vibration parts(std::uint32_t count) {
  TetMesh mesh;
  for (std::uint32_t part = 0; part < count; ++part) {
    const TetMesh one = make_slab(4, 4, 2, 0.01);
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Vec3& x : one.vertices) mesh.vertices.push_back(x + Vec3{static_cast<double>(part), 0, 0});
    for (const auto& t : one.tets) mesh.tets.push_back({t[0] + first, t[1] + first, t[2] + first, t[3] + first});
  }
  FemOptions options;
  options.materials = {{1e4, 0.3, 1000}};
  return Vibration(testing::make_model(std::move(mesh), options));
}

Vibration membrane(MassMatrix mass) {
  FemOptions options = testing::slab_options();
  options.mass = mass;
  return Vibration(testing::slab_model(options));
}

TEST(SlowestModes, AreThoseOfADenseSolve) {
  for (const MassMatrix mass : {MassMatrix::lumped, MassMatrix::consistent}) {
    for (const std::uint32_t length : {5U, 20U}) {  // 135 and 540 rows: solved whole, and by Lanczos' method
      const Vibration object = beam(length, mass);
      const VectorXd expected = object.dense();
      const Modes modes = object.modes(10);
      ASSERT_EQ(modes.squares.size(), 10);
      for (int i = 0; i < 10; ++i) EXPECT_NEAR(modes.squares[i] / expected[i], 1, 1e-8) << "mode " << i;
    }
  }
}

TEST(SlowestModes, SolveTheirEquationAndAreOrthonormalInTheMass) {
  for (const MassMatrix mass : {MassMatrix::lumped, MassMatrix::consistent}) {
    const Vibration object = membrane(mass);
    const Modes modes = object.modes(50);
    EXPECT_LT(object.residual(modes), 1e-10);
    EXPECT_LT(object.skew(modes), 1e-12);
  }
}

TEST(SlowestModes, OfAFreeBodyBeginWithSixWithoutFrequency) {
  const Vibration object = parts(2);
  const Vibration one = parts(1);
  const VectorXd expected = object.dense();
  const Modes modes = object.modes(15);
  for (int i = 0; i < 12; ++i) EXPECT_LT(modes.squares[i], 1e-8 * expected[12]) << i;
  EXPECT_NEAR(modes.squares[12] / one.modes(7).squares[6], 1, 1e-8);
  EXPECT_LT(object.residual(modes), 1e-10);
  EXPECT_LT(object.skew(modes), 1e-12);
}

/// Every frequency as often as there are parts. One start vector finds the copies by rounding alone, and must find all of them.
TEST(SlowestModes, OfEqualPartsAreAllThere) {
  const VectorXd one = parts(1).dense();
  for (const int count : {2, 4}) {
    const Vibration object = parts(static_cast<std::uint32_t>(count));
    const Modes modes = object.modes(40);
    for (int i = 6 * count; i < 40; ++i) EXPECT_NEAR(modes.squares[i] / one[i / count], 1, 1e-8) << i << " of " << count;
    EXPECT_LT(object.residual(modes), 1e-10) << count;
    EXPECT_LT(object.skew(modes), 1e-12) << count;
  }
}

TEST(SlowestModes, AreTheSameBitsAgainWithADefinedSign) {
  const Vibration object = membrane(MassMatrix::lumped);
  const Modes modes = object.modes(20);
  const Modes again = object.modes(20);
  EXPECT_EQ(modes.squares, again.squares);
  EXPECT_EQ(modes.shapes, again.shapes);
  for (Eigen::Index k = 0; k < 20; ++k) {
    const auto shape = modes.shapes.col(k);
    Eigen::Index first = 0;
    while (std::abs(shape[first]) < shape.cwiseAbs().maxCoeff() / 2) ++first;
    EXPECT_GT(shape[first], 0) << "mode " << k;
  }
}

TEST(SlowestModes, AreNoneOfAnUnstableObject) {
  const Vibration object = membrane(MassMatrix::lumped);
  EXPECT_FALSE(slowest_modes(-object.K, object.M, 5));
}

}  // namespace
}  // namespace tactus::sim
