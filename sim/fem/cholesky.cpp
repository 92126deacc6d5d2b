// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/fem/cholesky.h>

extern "C" {  // missing in its header
#include <ldl.h>
}

#include <Eigen/OrderingMethods>
#include <algorithm>
#include <cmath>

namespace tactus::sim {
namespace {

int size_of(const std::vector<int>& rows) { return static_cast<int>(rows.size()); }

/// LDL takes pointers without const, but only reads what these point to.
int* indices(const int* values) { return const_cast<int*>(values); }

}  // namespace

void LdlCholesky::analyse(const SparseMatrix& A) {
  order(A);
  const std::size_t n = row_.size();
  parent_.resize(n);
  count_.resize(n);
  seen_.resize(n);
  pattern_.resize(n);
  column_begin_.assign(n + 1, 0);
  // A is symmetric: its rows are the columns that LDL asks for.
  ldl_symbolic(size_of(row_), indices(A.outerIndexPtr()), indices(A.innerIndexPtr()), column_begin_.data(), parent_.data(),
               count_.data(), seen_.data(), row_.data(), inverse_.data());
  row_of_entry_.resize(static_cast<std::size_t>(column_begin_[n]));
  L_.resize(row_of_entry_.size());
  D_.resize(n);
  y_.resize(n);
  x_.resize(n);
}

void LdlCholesky::order(const SparseMatrix& A) {
  const auto vertices = static_cast<int>(A.rows() / 3);
  std::vector<Eigen::Triplet<double>> edges;
  for (int row = 0; row < A.rows(); ++row)
    for (SparseMatrix::InnerIterator it(A, row); it; ++it) edges.emplace_back(row / 3, static_cast<int>(it.col() / 3), 1.0);
  Eigen::SparseMatrix<double> graph(vertices, vertices);
  graph.setFromTriplets(edges.begin(), edges.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> found(vertices);
  if (vertices > 0) Eigen::AMDOrdering<int>()(graph, found);
  row_.clear();
  for (int k = 0; k < vertices; ++k)
    for (int axis = 0; axis < 3; ++axis) row_.push_back(3 * found.indices()[k] + axis);
  inverse_.resize(row_.size());
}

bool LdlCholesky::factor(const SparseMatrix& A) noexcept {
  const int n = size_of(row_);
  const int done = ldl_numeric(n, indices(A.outerIndexPtr()), indices(A.innerIndexPtr()), const_cast<double*>(A.valuePtr()),
                               column_begin_.data(), parent_.data(), count_.data(), row_of_entry_.data(), L_.data(), D_.data(),
                               y_.data(), pattern_.data(), seen_.data(), row_.data(), inverse_.data());
  return done == n && std::all_of(D_.begin(), D_.end(), [](double pivot) { return pivot > 0 && std::isfinite(pivot); });
}

void LdlCholesky::solve(const Eigen::VectorXd& b, Eigen::VectorXd& x) noexcept {
  const int n = size_of(row_);
  ldl_perm(n, x_.data(), const_cast<double*>(b.data()), row_.data());
  ldl_lsolve(n, x_.data(), column_begin_.data(), row_of_entry_.data(), L_.data());
  ldl_dsolve(n, x_.data(), D_.data());
  ldl_ltsolve(n, x_.data(), column_begin_.data(), row_of_entry_.data(), L_.data());
  ldl_permt(n, x.data(), x_.data(), row_.data());
}

std::int64_t LdlCholesky::fill() const noexcept { return static_cast<std::int64_t>(L_.size() + D_.size()); }

}  // namespace tactus::sim
