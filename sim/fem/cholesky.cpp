// SPDX-License-Identifier: Apache-2.0
#include "sim/fem/cholesky.h"

#include <Eigen/OrderingMethods>
#include <algorithm>
#include <cmath>
#include <utility>

namespace tactus {
namespace {

using Block = std::array<double, 9>;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// d = l diag(1/f0, 1/f4, 1/f8) l^T with l = [1 0 0; f3 1 0; f6 f7 1].   ret  false when d is not positive definite
bool invert(const Block& d, Block& f) noexcept {
  const auto reciprocal = [](double pivot, double& out) {
    out = 1 / pivot;
    return pivot > 0 && std::isfinite(pivot);
  };
  if (!reciprocal(d[0], f[0])) return false;
  f[3] = d[3] * f[0];
  f[6] = d[6] * f[0];
  const double below = d[7] - f[3] * d[6];
  if (!reciprocal(d[4] - f[3] * d[3], f[4])) return false;
  f[7] = below * f[4];
  return reciprocal(d[8] - f[6] * d[6] - f[7] * below, f[8]);
}

/// x = d^-1 x for an inverted d.
void substitute(const Block& f, double* x) noexcept {
  x[1] -= f[3] * x[0];
  x[2] = (x[2] - f[6] * x[0] - f[7] * x[1]) * f[8];
  x[1] = x[1] * f[4] - f[7] * x[2];
  x[0] = x[0] * f[0] - f[3] * x[1] - f[6] * x[2];
}

/// z -= a b^T
void subtract_product(const Block& a, const Block& b, Block& z) noexcept {
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      z[3 * i + j] -= a[3 * i] * b[3 * j] + a[3 * i + 1] * b[3 * j + 1] + a[3 * i + 2] * b[3 * j + 2];
}

}  // namespace

void BlockCholesky::analyse(const SparseMatrix& A) {
  order(A);
  take_lower_triangle(A);
  find_columns();
}

void BlockCholesky::order(const SparseMatrix& A) {
  const auto vertices = static_cast<int>(A.rows() / 3);
  std::vector<Eigen::Triplet<double>> edges;
  for (int row = 0; row < A.rows(); ++row)
    for (SparseMatrix::InnerIterator it(A, row); it; ++it) edges.emplace_back(row / 3, static_cast<int>(it.col() / 3), 1.0);
  Eigen::SparseMatrix<double> graph(vertices, vertices);
  graph.setFromTriplets(edges.begin(), edges.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> found(vertices);
  if (vertices > 0) Eigen::AMDOrdering<int>()(graph, found);
  order_.assign(found.indices().begin(), found.indices().end());
}

void BlockCholesky::take_lower_triangle(const SparseMatrix& A) {
  const std::size_t n = order_.size();
  std::vector<int> place(n), entry(n, -1);  // of a vertex; of a column in the row at hand
  for (std::size_t k = 0; k < n; ++k) place[at(order_[k])] = static_cast<int>(k);
  entries_.clear();
  row_begin_.assign(1, 0);
  for (std::size_t k = 0; k < n; ++k) {
    for (int i = 0; i < 3; ++i) {
      for (SparseMatrix::InnerIterator it(A, 3 * order_[k] + i); it; ++it) {
        const int column = place[at(static_cast<int>(it.col() / 3))];
        if (column > static_cast<int>(k)) continue;
        if (entry[at(column)] < row_begin_.back()) {
          entry[at(column)] = static_cast<int>(entries_.size());
          entries_.push_back({column, {-1, -1, -1, -1, -1, -1, -1, -1, -1}});
        }
        entries_[at(entry[at(column)])].from[at(3 * i + static_cast<int>(it.col() % 3))] =
            static_cast<int>(&it.value() - A.valuePtr());
      }
    }
    row_begin_.push_back(static_cast<int>(entries_.size()));
  }
}

/// The elimination tree, and how many blocks each column of L has.
void BlockCholesky::find_columns() {
  const std::size_t n = order_.size();
  parent_.assign(n, -1);
  count_.assign(n, 0);
  seen_.assign(n, -1);
  for (int k = 0; k < static_cast<int>(n); ++k) {
    seen_[at(k)] = k;
    for (int e = row_begin_[at(k)]; e < row_begin_[at(k) + 1]; ++e) {
      for (int i = entries_[at(e)].column; seen_[at(i)] != k; i = parent_[at(i)]) {
        if (parent_[at(i)] < 0) parent_[at(i)] = k;
        ++count_[at(i)];
        seen_[at(i)] = k;
      }
    }
  }
  column_begin_.assign(1, 0);
  for (const int count : count_) column_begin_.push_back(column_begin_.back() + count);
  row_.resize(at(column_begin_.back()));
  L_.resize(row_.size());
  D_.resize(n);
  path_.resize(n);
  pattern_.resize(n);
  y_.assign(n, Block{});
  x_.resize(n);
}

Block BlockCholesky::gather(const Entry& entry, const double* values) const noexcept {
  Block out;
  for (std::size_t i = 0; i < 9; ++i) out[i] = entry.from[i] < 0 ? 0 : values[entry.from[i]];
  return out;
}

/// Put the row's blocks of A into y and `diagonal`.
/// ret  where in `pattern_` the columns of this row of L begin, each before those that depend on it
int BlockCholesky::reach(int row, const double* values, Block& diagonal) noexcept {
  auto top = static_cast<int>(order_.size());
  seen_[at(row)] = row;
  for (int e = row_begin_[at(row)]; e < row_begin_[at(row) + 1]; ++e) {
    const Entry& entry = entries_[at(e)];
    (entry.column == row ? diagonal : y_[at(entry.column)]) = gather(entry, values);
    int length = 0;
    for (int i = entry.column; seen_[at(i)] != row; i = parent_[at(i)]) {
      path_[at(length++)] = i;
      seen_[at(i)] = row;
    }
    while (length > 0) pattern_[at(--top)] = path_[at(--length)];
  }
  return top;
}

/// One block of L's row: what it adds to the row's other blocks and to the diagonal.
void BlockCholesky::eliminate(int row, int column, Block& diagonal) noexcept {
  const Block y = std::exchange(y_[at(column)], Block{});
  const int end = column_begin_[at(column)] + count_[at(column)]++;
  for (int i = column_begin_[at(column)]; i < end; ++i) subtract_product(y, L_[at(i)], y_[at(row_[at(i)])]);
  Block& l = L_[at(end)];
  l = y;
  for (std::size_t i = 0; i < 3; ++i) substitute(D_[at(column)], &l[3 * i]);
  row_[at(end)] = row;
  subtract_product(l, y, diagonal);
}

bool BlockCholesky::factor(const SparseMatrix& A) noexcept {
  std::fill(seen_.begin(), seen_.end(), -1);
  std::fill(count_.begin(), count_.end(), 0);
  const auto n = static_cast<int>(order_.size());
  for (int row = 0; row < n; ++row) {
    Block diagonal{};
    for (int i = reach(row, A.valuePtr(), diagonal); i < n; ++i) eliminate(row, pattern_[at(i)], diagonal);
    if (!invert(diagonal, D_[at(row)])) return false;
  }
  return true;
}

void BlockCholesky::solve(const Eigen::VectorXd& b, Eigen::VectorXd& x) noexcept {
  const auto n = static_cast<int>(order_.size());
  for (int k = 0; k < n; ++k) x_[at(k)] = b.segment<3>(3 * order_[at(k)]);
  for (int k = 0; k < n; ++k) {
    const double p = x_[at(k)][0], q = x_[at(k)][1], r = x_[at(k)][2];
    for (int i = column_begin_[at(k)]; i < column_begin_[at(k) + 1]; ++i) {
      const Block& l = L_[at(i)];
      Eigen::Vector3d& z = x_[at(row_[at(i)])];
      z[0] -= l[0] * p + l[1] * q + l[2] * r;
      z[1] -= l[3] * p + l[4] * q + l[5] * r;
      z[2] -= l[6] * p + l[7] * q + l[8] * r;
    }
  }
  for (int k = n - 1; k >= 0; --k) {
    substitute(D_[at(k)], x_[at(k)].data());
    double p = 0, q = 0, r = 0;
    for (int i = column_begin_[at(k)]; i < column_begin_[at(k) + 1]; ++i) {
      const Block& l = L_[at(i)];
      const Eigen::Vector3d& z = x_[at(row_[at(i)])];
      p += l[0] * z[0] + l[3] * z[1] + l[6] * z[2];
      q += l[1] * z[0] + l[4] * z[1] + l[7] * z[2];
      r += l[2] * z[0] + l[5] * z[1] + l[8] * z[2];
    }
    x_[at(k)] -= Eigen::Vector3d(p, q, r);
  }
  for (int k = 0; k < n; ++k) x.segment<3>(3 * order_[at(k)]) = x_[at(k)];
}

std::int64_t BlockCholesky::fill() const noexcept {
  return 9 * static_cast<std::int64_t>(L_.size()) + 6 * static_cast<std::int64_t>(D_.size());
}

}  // namespace tactus
