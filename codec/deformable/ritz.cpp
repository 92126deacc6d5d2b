// SPDX-License-Identifier: Apache-2.0
#include <tactus/deformable/ritz.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <numeric>

static_assert(FLT_EVAL_METHOD == 0, "both ends compute the same bits only if no operation has more");

namespace tactus {
namespace {

class Square {
 public:
  explicit Square(std::size_t size) : size_(size), values_(size * size) {}
  double* operator[](std::size_t i) noexcept { return values_.data() + i * size_; }
  const double* operator[](std::size_t i) const noexcept { return values_.data() + i * size_; }
  std::size_t size() const noexcept { return size_; }

 private:
  std::size_t size_;
  std::vector<double> values_;
};

constexpr double kLeastPivot = 0x1p-40;  // of the diagonal: columns that depend on those before them do no harm
constexpr double kLeastSquare = 0x1p-200;
constexpr int kSweeps = 4;

/// The lower triangle of x^T y.
Square product_of(const Columns& x, const Columns& y) {
  Square out(x.columns);
  for (std::size_t r = 0; r < x.rows; ++r) {
    const double *a = x.row(r), *b = y.row(r);
    for (std::size_t i = 0; i < x.columns; ++i)
      for (std::size_t k = 0; k <= i; ++k) out[i][k] += a[i] * b[k];
  }
  return out;
}

/// The inverse of L in L L^T = gram, both lower triangles.
Square inverse_factor(Square l) {
  const std::size_t n = l.size();
  for (std::size_t j = 0; j < n; ++j) {
    double pivot = l[j][j];
    for (std::size_t k = 0; k < j; ++k) pivot -= l[j][k] * l[j][k];
    l[j][j] = std::sqrt(std::max(std::max(pivot, kLeastPivot * l[j][j]), kLeastSquare));
    for (std::size_t i = j + 1; i < n; ++i) {
      for (std::size_t k = 0; k < j; ++k) l[i][j] -= l[i][k] * l[j][k];
      l[i][j] /= l[j][j];
    }
  }
  Square out(n);
  for (std::size_t j = 0; j < n; ++j) {
    out[j][j] = 1 / l[j][j];
    for (std::size_t i = j + 1; i < n; ++i) {
      for (std::size_t k = j; k < i; ++k) out[i][j] -= l[i][k] * out[k][j];
      out[i][j] /= l[i][i];
    }
  }
  return out;
}

/// m a m^T of a lower triangle m and a symmetric a, of which the lower triangle is given.
Square congruent(const Square& m, const Square& a) {
  const std::size_t n = m.size();
  Square half(n), out(n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k <= i; ++k)
      for (std::size_t j = 0; j < n; ++j) half[i][j] += m[i][k] * (j <= k ? a[k][j] : a[j][k]);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      for (std::size_t k = 0; k <= j; ++k) out[i][j] += half[i][k] * m[j][k];
      out[j][i] = out[i][j];
    }
  }
  return out;
}

/// Rotate the rows p and q of m by the angle of cosine c and sine s.
void rotate_rows(Square& m, std::size_t p, std::size_t q, double c, double s) noexcept {
  for (std::size_t k = 0; k < m.size(); ++k) {
    const double x = m[p][k], y = m[q][k];
    m[p][k] = c * x - s * y;
    m[q][k] = s * x + c * y;
  }
}

/// Jacobi's method by rows: a becomes nearly diagonal, and the rows of `rotation` take part.
void diagonalise(Square& a, Square& rotation) noexcept {
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (std::size_t p = 0; p + 1 < a.size(); ++p) {
      for (std::size_t q = p + 1; q < a.size(); ++q) {
        if (a[p][q] == 0) continue;
        const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
        const double t = (theta < 0 ? -1.0 : 1.0) / (std::abs(theta) + std::sqrt(theta * theta + 1));
        const double c = 1 / std::sqrt(t * t + 1), s = t * c;
        rotate_rows(a, p, q, c, s);
        for (std::size_t k = 0; k < a.size(); ++k) {
          const double x = a[k][p], y = a[k][q];
          a[k][p] = c * x - s * y;
          a[k][q] = s * x + c * y;
        }
        rotate_rows(rotation, p, q, c, s);
      }
    }
  }
}

}  // namespace

std::vector<double> rotate_to_ritz_vectors(Columns& x, const Columns& product) {
  const std::size_t n = x.columns;
  Square combination = inverse_factor(product_of(x, x));
  Square a = congruent(combination, product_of(x, product));
  diagonalise(a, combination);
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t i, std::size_t k) { return a[i][i] != a[k][k] ? a[i][i] < a[k][k] : i < k; });
  Square columns(n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < n; ++k) columns[k][i] = combination[order[i]][k];
  std::vector<double> sums(n);
  for (std::size_t r = 0; r < x.rows; ++r) {
    std::fill(sums.begin(), sums.end(), 0.0);
    double* row = x.row(r);
    for (std::size_t k = 0; k < n; ++k)
      for (std::size_t i = 0; i < n; ++i) sums[i] += row[k] * columns[k][i];
    std::copy(sums.begin(), sums.end(), row);
  }
  std::vector<double> values(n);
  for (std::size_t i = 0; i < n; ++i) values[i] = a[order[i]][order[i]];
  return values;
}

}  // namespace tactus
