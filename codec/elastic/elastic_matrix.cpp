// SPDX-License-Identifier: Apache-2.0
#include <tactus/elastic/elastic_matrix.h>

#include <algorithm>
#include <array>

namespace tactus {

ElasticMatrix::ElasticMatrix(const ElasticBody& body, const Elimination& elimination, const ElasticElements& elements,
                             double mass_share, double stiffness_share) {
  std::size_t numbers = 0;
  for (std::size_t i = 0; i < 3 * elimination.order.size(); ++i) {
    first_.push_back(3 * std::size_t{elimination.first[i / 3]});
    start_.push_back(numbers);
    numbers += i - first_.back();
  }
  lower_.resize(numbers);
  diagonal_.resize(first_.size());
  add(body, elimination, elements, stiffness_share);
  for (std::size_t i = 0; i < diagonal_.size(); ++i) diagonal_[i] += mass_share * elements.mass()[elimination.order[i / 3]];
  factor();
}

void ElasticMatrix::add(const ElasticBody& body, const Elimination& elimination, const ElasticElements& elements,
                        double share) noexcept {
  for (std::size_t e = 0; e < body.tets.size(); ++e) {
    for (std::size_t r = 0; r < 4; ++r) {
      for (std::size_t q = 0; q < 4; ++q) {
        const std::uint32_t i = elimination.place[body.tets[e][r]], j = elimination.place[body.tets[e][q]];
        if (i == Elimination::kFixed || j == Elimination::kFixed || j > i) continue;
        const Rotation k = elements.stiffness(e, r, q);
        for (std::size_t a = 0; a < 3; ++a) {
          const std::size_t at = 3 * std::size_t{i} + a;
          for (std::size_t c = 0; c < 3 && 3 * std::size_t{j} + c <= at; ++c) {
            const std::size_t column = 3 * std::size_t{j} + c;
            (column == at ? diagonal_[at] : row(at)[column - first_[at]]) += share * k[3 * a + c];
          }
        }
      }
    }
  }
}

void ElasticMatrix::factor() noexcept {
  for (std::size_t i = 0; i < diagonal_.size(); ++i) {
    double* own = row(i);
    for (std::size_t j = first_[i]; j < i; ++j) {
      const double* other = row(j);
      double sum = own[j - first_[i]];
      for (std::size_t k = std::max(first_[i], first_[j]); k < j; ++k) sum -= own[k - first_[i]] * other[k - first_[j]];
      own[j - first_[i]] = sum;
    }
    for (std::size_t j = first_[i]; j < i; ++j) {
      double& entry = own[j - first_[i]];
      const double before = entry;
      entry = before / diagonal_[j];
      diagonal_[i] -= before * entry;
    }
  }
}

void ElasticMatrix::solve(std::span<double> b) const noexcept {
  for (std::size_t i = 0; i < b.size(); i += 3) {  // the rows of a vertex begin alike
    const std::size_t from = first_[i];
    const std::array<const double*, 3> rows{row(i), row(i + 1), row(i + 2)};
    std::array<double, 3> sum{b[i], b[i + 1], b[i + 2]};
    for (std::size_t j = from; j < i; ++j)
      for (std::size_t a = 0; a < 3; ++a) sum[a] -= rows[a][j - from] * b[j];
    b[i] = sum[0];
    b[i + 1] = sum[1] - rows[1][i - from] * b[i];
    b[i + 2] = sum[2] - rows[2][i - from] * b[i] - rows[2][i + 1 - from] * b[i + 1];
  }
  for (std::size_t i = 0; i < b.size(); ++i) b[i] /= diagonal_[i];
  for (std::size_t i = b.size(); i > 0;) {
    i -= 3;
    const std::size_t width = i - first_[i];
    const double *x = row(i), *y = row(i + 1), *z = row(i + 2);
    const double at_z = b[i + 2];
    const double at_y = b[i + 1] -= z[width + 1] * at_z;
    const double at_x = b[i] = b[i] - z[width] * at_z - y[width] * at_y;
    double* out = b.data() + first_[i];
    for (std::size_t j = 0; j < width; ++j) out[j] = out[j] - z[j] * at_z - y[j] * at_y - x[j] * at_x;
  }
}

}  // namespace tactus
