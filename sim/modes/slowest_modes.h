// SPDX-License-Identifier: Apache-2.0
/// The slowest modes of vibration, of finite elements as of networks of springs.
///   K phi = lambda M phi,  phi^T M phi = 1,  lambda = omega^2
///
/// Lanczos' method on (K + shift M)^-1 M in the inner product of M, which finds the slowest first; one factorisation, about two solves
/// per mode. The shift makes the matrix definite if a body is free to move as a whole, where lambda is zero six times for each
/// part. One Rayleigh-Ritz step removes the remaining rounding error. Many modes of a small problem use the dense solver.
///
/// The start is seeded and the first large component of each mode is positive, so that equal inputs give equal bits on one machine.
/// Among equal lambda the choice of basis is arbitrary.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <optional>

namespace tactus::sim {

/// Slowest first.
struct Modes {
  Eigen::VectorXd squares;  ///< lambda [1/s^2], at least 0
  Eigen::MatrixXd shapes;   ///< phi, rows of K x modes [kg^-1/2]
};

using SymmetricMatrix = Eigen::SparseMatrix<double, Eigen::RowMajor, int>;  ///< both triangles stored

/// pre  K positive semidefinite, M positive definite; 1 <= count <= rows
/// ret  none when rounding makes the matrix indefinite, or Lanczos' method does not converge
/// out  |K phi - lambda M phi| <= 1e-10 of the largest entry of M^-1 K's diagonal, in the norm of M^-1; orthonormal to 1e-12
/// time one factorisation and about 2 count + 20 solves for count below a quarter of the rows: 0.04 s for the 50 slowest of 2118;
///      else O(rows^3). Allocates.
std::optional<Modes> slowest_modes(const SymmetricMatrix& K, const SymmetricMatrix& M, Eigen::Index count);

}  // namespace tactus::sim
