// SPDX-License-Identifier: Apache-2.0
/// Sparse Cholesky factorisation P A P^T = L D L^T in 3 x 3 blocks, one for each pair of vertices, for many solves with one factor and
/// for factoring again in place.
///
/// Ordered by approximate minimum degree of the graph of vertices (Eigen's), then row by row along the elimination tree (Davis, LDL,
/// ACM TOMS 31(4) 2005, with blocks where that has numbers). One index for nine numbers makes it faster than CHOLMOD's simplicial
/// method; it calls no BLAS and sums in one written order, so that its bits do not depend on the machine.
#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <vector>

#include "sim/fem/model.h"
#ifdef TACTUS_FEM_CHOLMOD
#include "sim/fem/cholesky_cholmod.h"
#endif

namespace tactus {

class BlockCholesky {
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
  using Block = std::array<double, 9>;  // rows
  struct Entry {
    int column;
    std::array<int, 9> from;  // where its numbers are among the values of A, -1: zero
  };

  void order(const SparseMatrix& A);
  void take_lower_triangle(const SparseMatrix& A);
  void find_columns();
  Block gather(const Entry& entry, const double* values) const noexcept;
  int reach(int row, const double* values, Block& diagonal) noexcept;
  void eliminate(int row, int column, Block& diagonal) noexcept;

  std::vector<int> order_;      // order_[k]: vertex that is row k
  std::vector<int> row_begin_;  // of the lower triangle of P A P^T, in entries_
  std::vector<Entry> entries_;
  std::vector<int> parent_;              // elimination tree, -1: root
  std::vector<int> column_begin_, row_;  // L below its diagonal, column after column
  std::vector<Block> L_;
  std::vector<Block> D_;  // as invert() leaves them
  std::vector<int> count_, seen_, path_,
      pattern_;                     // of factor(): blocks in each column, last row that saw it, columns to eliminate
  std::vector<Block> y_;            // and their blocks of the row at work
  std::vector<Eigen::Vector3d> x_;  // of solve()
};

#ifdef TACTUS_FEM_CHOLMOD
using Cholesky = CholmodCholesky;
#else
using Cholesky = BlockCholesky;
#endif

}  // namespace tactus
