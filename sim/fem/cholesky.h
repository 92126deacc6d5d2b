// SPDX-License-Identifier: Apache-2.0
/// Sparse Cholesky factorisation P A P^T = L D L^T by SuiteSparse's LDL, for many solves with one factor and for factoring again in
/// place. Ordered by approximate minimum degree of the graph of vertices (Eigen's AMD).
///
/// LDL works row by row along the elimination tree, in memory of ours and without BLAS, so that its bits do not depend on which one a
/// machine has installed.
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <vector>

#include <tactus/sim/fem/model.h>
#ifdef TACTUS_FEM_CHOLMOD
#include <tactus/sim/fem/cholesky_cholmod.h>
#endif

namespace tactus::sim {

class LdlCholesky {
 public:
  /// Find the ordering and the pattern of L.
  /// pre  A is symmetric with both triangles stored, its size a multiple of 3.   time O(n log n + fill)
  void analyse(const SparseMatrix& A);
  /// pre  A has the pattern that was analysed.
  /// ret  false when A is not positive definite.   time O(n^2) for bodies, O(n^1.5) for sheets; no allocation
  bool factor(const SparseMatrix& A) noexcept;
  /// x = A^-1 b.   pre  factor() succeeded; b and x have the size of A and may be the same.   time O(fill); no allocation
  void solve(const Eigen::VectorXd& b, Eigen::VectorXd& x) noexcept;

  std::int64_t fill() const noexcept;  ///< numbers in L and D

 private:
  void order(const SparseMatrix& A);

  std::vector<int> row_, inverse_;  // row_[k]: row of A that is row k of P A P^T; its inverse
  std::vector<int> parent_, column_begin_, row_of_entry_;
  std::vector<double> L_, D_;
  std::vector<int> count_, seen_, pattern_;  // scratch
  std::vector<double> y_, x_;
};

#ifdef TACTUS_FEM_CHOLMOD
using Cholesky = CholmodCholesky;
#else
using Cholesky = LdlCholesky;
#endif

}  // namespace tactus::sim
