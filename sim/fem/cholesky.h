// SPDX-License-Identifier: Apache-2.0
/// Sparse Cholesky factorisation A = L L^T made for many solves with one factor.
///
/// The unknowns of a vertex stay together: ordering and structure work on blocks of 3 x 3. Columns of L with the same rows form a
/// panel (supernode), a dense matrix, so that a solve reads numbers one after the other and one index per row of a panel.
///   ordering   nested dissection: the vertices farthest from a border vertex by half are cut off by one layer of vertices, again
///              and again; minimum degree (Eigen's AMD) for what remains small
///   factor     left-looking: a panel collects the updates of all panels before it that have rows in its columns
///   solve      forward and backward over the panels; the widest vectors of the machine, the same bits with each of them
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <cstdint>
#include <vector>

#include "sim/fem/model.h"

namespace tactus {

class Cholesky {
 public:
  /// Find ordering and structure of L.
  /// pre  A is symmetric with both triangles stored; rows 3i, 3i+1, 3i+2 belong together.   time O(n log n + fill)
  void analyse(const SparseMatrix& A);
  /// pre  A has the pattern that was analysed.
  /// ret  false when A is not positive definite.   time O(n^2) for bodies, O(n^1.5) for sheets; no allocation
  bool factor(const SparseMatrix& A) noexcept;
  /// x = A^-1 b.   pre  factor() succeeded; b and x have the size of A and may be the same.   time O(fill); no allocation
  void solve(const Eigen::VectorXd& b, Eigen::VectorXd& x) noexcept;

  Eigen::Index size() const noexcept { return 3 * static_cast<Eigen::Index>(position_.size()); }
  std::int64_t fill() const noexcept;  ///< numbers stored for L, zeros inside panels included

 private:
  /// Columns begin .. begin+width of L: a dense lower triangle, then `rows` rows below it (a multiple of 4, filled up with rows
  /// of zeros whose index is that of an unused unknown). Both column by column.
  struct Panel {
    int begin = 0, width = 0;
    int rows = 0, used = 0;  // used: without those filled up
    std::size_t index = 0;   // of the first row below, in rows_
    std::size_t value = 0;   // of the triangle, in values_; the rows below follow
  };
  struct Pending {  // where a panel stands in updating later ones
    int next = -1;  // panel, a list
    int row = 0;    // first row not used yet
  };
  struct Entry {  // of A, in the lower triangle of L
    int from;     // in A's values
    std::size_t to;
  };

  void structure(const std::vector<std::vector<int>>& below, const std::vector<int>& parent);
  void map_entries(const SparseMatrix& A);
  void update(int target, int source) noexcept;
  bool factor_panel(const Panel& panel) noexcept;
  void queue(int panel, int row) noexcept;

  std::vector<int> position_;  // of a vertex in L's order
  std::vector<Panel> panels_;
  std::vector<int> panel_of_;  // column -> panel
  std::vector<int> rows_;
  std::vector<double> values_;
  std::vector<Entry> entries_;
  std::vector<Pending> pending_;
  std::vector<int> head_;   // first panel waiting to update this one
  std::vector<int> place_;  // row -> row within the panel at work
  std::vector<double> work_, update_;
};

}  // namespace tactus
