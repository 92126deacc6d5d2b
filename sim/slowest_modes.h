// SPDX-License-Identifier: Apache-2.0
/// The slowest modes of vibration, of finite elements as of networks of springs.
///   K phi = lambda M phi,  phi^T M phi = 1,  lambda = omega^2
///
/// Lanczos' method on (K + shift M)^-1 M in the inner product of M, which finds the slowest first; one factorisation, about two solves
/// per mode. The shift makes the matrix definite where a body is free to move as a whole: lambda is zero there, six times for each
/// part. One Rayleigh-Ritz step takes what rounding has left. Many modes of a small problem: the dense solver.
///
/// The start is seeded and the first large component of each mode is positive, so that equal inputs give equal bits on one machine.
/// Of equal lambda any basis is as good as another.
#pragma once

#include <Spectra/SymGEigsShiftSolver.h>
#include <Eigen/Dense>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "sim/random.h"

namespace tactus {

/// Slowest first.
struct Modes {
  Eigen::VectorXd squares;  ///< lambda [1/s^2], at least 0
  Eigen::MatrixXd shapes;   ///< phi, rows of K x modes [kg^-1/2]
};

namespace detail {

using SymmetricMatrix = Eigen::SparseMatrix<double, Eigen::RowMajor, int>;  // both triangles stored

/// (K + shift M)^-1 as Spectra calls it.
template <class Factor>
struct ShiftedInverse {
  using Scalar = double;
  Factor* factor;
  Eigen::Index size;
  mutable Eigen::VectorXd column = Eigen::VectorXd::Zero(size);

  Eigen::Index rows() const { return size; }
  Eigen::Index cols() const { return size; }
  void set_shift(double /*factored already*/) const {}
  void perform_op(const double* in, double* out) const {
    column = Eigen::Map<const Eigen::VectorXd>(in, size);
    factor->solve(column, column);
    Eigen::Map<Eigen::VectorXd>(out, size) = column;
  }
};

/// Products with M.
struct MassProduct {
  using Scalar = double;
  const SymmetricMatrix* mass;

  Eigen::Index rows() const { return mass->rows(); }
  Eigen::Index cols() const { return mass->cols(); }
  void perform_op(const double* in, double* out) const {
    Eigen::Map<Eigen::VectorXd>(out, rows()).noalias() = *mass * Eigen::Map<const Eigen::VectorXd>(in, rows());
  }
};

/// Rayleigh-Ritz in the space of X: the dense problem when X is the identity.
template <class Basis>
Modes best_modes(const SymmetricMatrix& K, const SymmetricMatrix& M, const Basis& X, Eigen::Index count) {
  const Eigen::MatrixXd KX = K * X, MX = M * X;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> ritz(X.transpose() * KX, X.transpose() * MX);
  Modes out{ritz.eigenvalues().head(count).cwiseMax(0.0), X * ritz.eigenvectors().leftCols(count)};
  for (auto shape : out.shapes.colwise()) {
    const double large = shape.cwiseAbs().maxCoeff() / 2;  // not the largest: in a symmetric body that is one of several
    if (*std::ranges::find_if(shape, [large](double x) { return std::abs(x) >= large; }) < 0) shape = -shape;
  }
  return out;
}

}  // namespace detail

/// Factor: analyse(A), factor(A) and solve(b, x) as Cholesky has them (sim/fem/cholesky.h).
/// pre  K positive semidefinite, M positive definite, both with both triangles stored; 1 <= count <= rows
/// ret  none when rounding leaves nothing positive definite, or Lanczos' method does not converge
/// out  |K phi - lambda M phi| <= 1e-10 of the largest entry of M^-1 K's diagonal, in the norm of M^-1; orthonormal to 1e-12
/// time one factorisation and about 2 count + 20 solves for count below a quarter of the rows: 0.04 s for the 50 slowest of 2118;
///      else O(rows^3). Allocates.
template <class Factor>
std::optional<Modes> slowest_modes(const detail::SymmetricMatrix& K, const detail::SymmetricMatrix& M, Eigen::Index count) {
  constexpr Eigen::Index kDense = 300;  // problems this small are solved whole
  constexpr double kShift = 1e-6;       // rounding of a free body's modes grows with less, the number of solves with more
  constexpr double kAccuracy = 1e-10;   // of 1 / (lambda + shift)
  constexpr int kMostRestarts = 300;
  const Eigen::Index rows = K.rows(), space = 2 * count + 20;
  if (rows <= kDense || 2 * space > rows) {
    detail::SymmetricMatrix whole(rows, rows);
    whole.setIdentity();
    return detail::best_modes(K, M, whole, count);
  }

  const double shift = kShift * K.diagonal().cwiseQuotient(M.diagonal()).maxCoeff();
  const detail::SymmetricMatrix shifted = K + shift * M;
  Factor factor;
  factor.analyse(shifted);
  if (!factor.factor(shifted)) return std::nullopt;
  detail::ShiftedInverse<Factor> inverse{&factor, rows};
  detail::MassProduct product{&M};
  Spectra::SymGEigsShiftSolver<decltype(inverse), decltype(product), Spectra::GEigsMode::ShiftInvert> lanczos(
      inverse, product, count, space, -shift);
  Random random(1);
  Eigen::VectorXd start(rows);
  for (double& x : start) x = random.uniform(-1, 1);
  try {
    lanczos.init(start.data());
    lanczos.compute(Spectra::SortRule::LargestMagn, kMostRestarts, kAccuracy, Spectra::SortRule::SmallestAlge);
  } catch (const std::runtime_error&) {  // of its tridiagonal eigenproblem
    return std::nullopt;
  }
  if (lanczos.info() != Spectra::CompInfo::Successful) return std::nullopt;
  return detail::best_modes(K, M, lanczos.eigenvectors(), count);
}

}  // namespace tactus
