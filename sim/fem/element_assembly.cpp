// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/fem/element_assembly.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>

namespace tactus::sim {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Gradients = std::array<Vector3d, 4>;

Matrix3d eigen(const Matrix3& m) { return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(&m.m[0][0]); }
Vector3d eigen(const Vec3& v) { return {v.x, v.y, v.z}; }

Gradients rotated(const std::array<Vec3, 4>& g, const Matrix3d& r) {
  Gradients out;
  for (std::size_t a = 0; a < 4; ++a) out[a] = r * eigen(g[a]);
  return out;
}

Matrix3 matrix3(const Matrix3d& m) {
  Matrix3 out;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) out.m[i][j] = m(i, j);
  return out;
}

Matrix3 transposed(const Matrix3& m) {
  Matrix3 out;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) out.m[i][j] = m.m[j][i];
  return out;
}

/// [g]x : [g]x y = g x y
Matrix3d cross_matrix(const Vector3d& g) {
  Matrix3d out;
  out << 0, -g.z(), g.y(), g.z(), 0, -g.x(), -g.y(), g.x(), 0;
  return out;
}

/// Sum over eigenvalues gamma of G of min(max(c / gamma, -63 mu), mu) v v^T, so that mu minus it lies in [0, 64 mu].
Matrix3d clamped(const Matrix3d& g, double c, double mu) {
  Eigen::SelfAdjointEigenSolver<Matrix3d> solver;
  solver.computeDirect(g);
  Vector3d h;
  for (int i = 0; i < 3; ++i) {
    const double gamma = std::max(solver.eigenvalues()[i], 1e-6);  // F and G are dimensionless, and 1 at rest
    h[i] = std::clamp(c / gamma, -63 * mu, mu);
  }
  return solver.eigenvectors() * h.asDiagonal() * solver.eigenvectors().transpose();
}

}  // namespace

ElementMatrix rotated_stiffness(const Elements& elements, std::size_t element, bool corotated) noexcept {
  const Lame v = elements.moduli(element);
  const Matrix3d r = corotated ? eigen(to_matrix(elements.rotation(element))) : Matrix3d(Matrix3d::Identity());
  const Gradients h = rotated(elements.gradients(element), r);
  ElementMatrix out;
  for (std::size_t a = 0; a < 4; ++a) {
    for (std::size_t b = a; b < 4; ++b) {
      Matrix3d block = (v.lambda * h[a]) * h[b].transpose() + (v.mu * h[b]) * h[a].transpose();
      block.diagonal().array() += v.mu * h[a].dot(h[b]);
      out[4 * a + b] = matrix3(block);
      out[4 * b + a] = transposed(out[4 * a + b]);
    }
  }
  return out;
}

ElementMatrix tangent(const Elements& elements, std::size_t element, const double* u) noexcept {
  const Lame v = elements.moduli(element);
  const std::array<Vec3, 4> g = elements.gradients(element);
  const Matrix3d r = eigen(to_matrix(elements.rotation(element)));
  const Matrix3d m = r.transpose() * eigen(elements.deformation(element, u));
  const Matrix3d s = 0.5 * (m + m.transpose());
  const Matrix3d curl = clamped(s.trace() * Matrix3d::Identity() - s, 2 * v.mu - v.lambda * (s.trace() - 3), v.mu);
  const Gradients h = rotated(g, r);
  std::array<Matrix3d, 4> w;  // axial(R^T dF) = w_a dx_a
  for (std::size_t a = 0; a < 4; ++a) w[a] = cross_matrix(eigen(g[a])) * r.transpose();

  ElementMatrix out;
  for (std::size_t a = 0; a < 4; ++a) {
    const Matrix3d left = w[a].transpose() * curl;
    for (std::size_t b = a; b < 4; ++b) {
      Matrix3d block = (v.lambda * h[a]) * h[b].transpose() - left * w[b];
      block.diagonal().array() += 2 * v.mu * h[a].dot(h[b]);
      out[4 * a + b] = matrix3(block);
      out[4 * b + a] = transposed(out[4 * a + b]);
    }
  }
  return out;
}

Assembly::Assembly(const Elements& elements, std::span<const int> free_vertex, int free_count) : slots_(elements.size()) {
  const auto vertex = [&](std::uint32_t corner) { return free_vertex[corner / 3]; };
  std::vector<std::vector<int>> neighbours(static_cast<std::size_t>(free_count));
  for (std::size_t e = 0; e < elements.size(); ++e) {
    const auto corners = elements.corners(e);
    for (const std::uint32_t a : corners)
      for (const std::uint32_t b : corners)
        if (vertex(a) >= 0 && vertex(b) >= 0) neighbours[static_cast<std::size_t>(vertex(a))].push_back(vertex(b));
  }
  Eigen::VectorXi row_sizes(3 * free_count);
  for (std::size_t a = 0; a < neighbours.size(); ++a) {
    auto& list = neighbours[a];
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    row_sizes.segment<3>(3 * static_cast<Eigen::Index>(a)).setConstant(3 * static_cast<int>(list.size()));
  }
  pattern_.resize(row_sizes.size(), row_sizes.size());
  if (free_count == 0) return;  // Eigen 3.4 reads past the end when it compresses a matrix without rows
  pattern_.reserve(row_sizes);
  for (int row = 0; row < 3 * free_count; ++row)
    for (const int b : neighbours[static_cast<std::size_t>(row / 3)])
      for (int c = 0; c < 3; ++c) pattern_.insert(row, 3 * b + c) = 0;
  pattern_.makeCompressed();

  for (std::size_t e = 0; e < elements.size(); ++e) {
    const auto corners = elements.corners(e);
    for (std::size_t i = 0; i < 16; ++i) {
      const int a = vertex(corners[i / 4]), b = vertex(corners[i % 4]);
      if (a < 0 || b < 0) continue;
      const auto& list = neighbours[static_cast<std::size_t>(a)];
      const auto column = std::lower_bound(list.begin(), list.end(), b) - list.begin();
      slots_[e][i] = {pattern_.outerIndexPtr()[3 * static_cast<Eigen::Index>(a)] + 3 * static_cast<std::int32_t>(column),
                      3 * static_cast<std::int32_t>(list.size())};
    }
  }
}

void Assembly::prepare(SparseMatrix& sum) const {
  if (sum.rows() != pattern_.rows() || sum.cols() != pattern_.cols() || sum.nonZeros() != pattern_.nonZeros() ||
      !sum.isCompressed())
    sum = pattern_;
  else sum.coeffs().setZero();
}

void Assembly::add(std::size_t element, const ElementMatrix& matrix, SparseMatrix& sum) const noexcept {
  double* values = sum.valuePtr();
  for (std::size_t i = 0; i < 16; ++i) {
    const Slot& slot = slots_[element][i];
    if (slot.first < 0) continue;
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) values[slot.first + r * slot.stride + c] += matrix[i].m[r][c];
  }
}

}  // namespace tactus::sim
