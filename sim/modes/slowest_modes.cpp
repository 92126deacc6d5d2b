// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/modes/slowest_modes.h>

#include <Spectra/SymGEigsShiftSolver.h>
#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <tactus/sim/random.h>

namespace tactus::sim {
namespace {

using Factor = Eigen::SimplicialLDLT<SymmetricMatrix>;

/// (K + shift M)^-1 as Spectra calls it.
struct ShiftedInverse {
  using Scalar = double;
  const Factor* factor;
  Eigen::Index size;

  Eigen::Index rows() const { return size; }
  Eigen::Index cols() const { return size; }
  void set_shift(double /*factored already*/) const {}
  void perform_op(const double* in, double* out) const {
    Eigen::Map<Eigen::VectorXd>(out, size) = factor->solve(Eigen::Map<const Eigen::VectorXd>(in, size));
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
    const double large = shape.cwiseAbs().maxCoeff() / 2;  // not the largest: a symmetric body has several equal ones
    if (*std::ranges::find_if(shape, [large](double x) { return std::abs(x) >= large; }) < 0) shape = -shape;
  }
  return out;
}

}  // namespace

std::optional<Modes> slowest_modes(const SymmetricMatrix& K, const SymmetricMatrix& M, Eigen::Index count) {
  constexpr Eigen::Index kDense = 300;  // up to this size the dense problem is solved
  constexpr double kShift = 1e-6;       // less: more rounding in a free body's modes; more: more solves
  constexpr double kAccuracy = 1e-10;   // of 1 / (lambda + shift)
  constexpr int kMostRestarts = 300;
  const Eigen::Index rows = K.rows(), space = 2 * count + 20;
  if (rows <= kDense || 2 * space > rows) {
    SymmetricMatrix whole(rows, rows);
    whole.setIdentity();
    return best_modes(K, M, whole, count);
  }

  const double shift = kShift * K.diagonal().cwiseQuotient(M.diagonal()).maxCoeff();
  const SymmetricMatrix shifted = K + shift * M;
  const Factor factor(shifted);
  if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > 0)) return std::nullopt;
  ShiftedInverse inverse{&factor, rows};
  MassProduct product{&M};
  Spectra::SymGEigsShiftSolver<decltype(inverse), decltype(product), Spectra::GEigsMode::ShiftInvert> lanczos(
      inverse, product, count, space, -shift);
  Random random(1);
  Eigen::VectorXd start(rows);
  for (double& x : start) x = random.uniform(-1, 1);
  try {
    lanczos.init(start.data());
    lanczos.compute(Spectra::SortRule::LargestMagn, kMostRestarts, kAccuracy, Spectra::SortRule::SmallestAlge);
  } catch (const std::runtime_error&) {  // Spectra's tridiagonal eigenproblem did not converge
    return std::nullopt;
  }
  if (lanczos.info() != Spectra::CompInfo::Successful) return std::nullopt;
  return best_modes(K, M, lanczos.eigenvectors(), count);
}

}  // namespace tactus::sim
