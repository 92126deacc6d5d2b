// SPDX-License-Identifier: Apache-2.0
/// Sparse Cholesky factorisation P A P^T = L D L^T by CHOLMOD, for many solves with one factor and for factoring again in place.
///
/// CHOLMOD's simplicial method, ordered by minimum degree: it calls no BLAS, so that its bits do not depend on which one a machine
/// has installed, and its solves are as fast at the sizes of a haptic scene as those of the supernodal one with the fastest BLAS.
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <memory>

#include "sim/fem/model.h"

namespace tactus {

class Cholesky {
 public:
  Cholesky();
  ~Cholesky();
  Cholesky(Cholesky&&) noexcept;
  Cholesky& operator=(Cholesky&&) noexcept;

  /// Find the ordering and the pattern of L.
  /// pre  A is symmetric with both triangles stored.   time O(n log n + fill)
  void analyse(const SparseMatrix& A);
  /// pre  A has the pattern that was analysed.
  /// ret  false when A is not positive definite.   time O(n^2) for bodies, O(n^1.5) for sheets; no allocation
  bool factor(const SparseMatrix& A) noexcept;
  /// x = A^-1 b.   pre  factor() succeeded; b and x have the size of A and may be the same.   time O(fill); no allocation
  void solve(const Eigen::VectorXd& b, Eigen::VectorXd& x) noexcept;

  std::int64_t fill() const noexcept;  ///< numbers in L and D

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;  // none: nothing to solve for
};

}  // namespace tactus
