// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/fem/rotation.h>

#include <algorithm>
#include <cmath>

namespace tactus::sim {
namespace {

struct Eigen4 {
  double value[4][4];   // diagonal holds the eigenvalues when done
  double vector[4][4];  // columns
};

/// Turn rows and columns p and q so that value[p][q] becomes zero.
void rotate_pair(Eigen4& e, int p, int q) {
  const double apq = e.value[p][q];
  if (apq == 0) return;
  const double theta = (e.value[q][q] - e.value[p][p]) / (2 * apq);
  const double t = (theta < 0 ? -1.0 : 1.0) / (std::abs(theta) + std::sqrt(theta * theta + 1));
  const double c = 1 / std::sqrt(t * t + 1), s = t * c;
  for (auto& row : e.value) {
    const double a = row[p], b = row[q];
    row[p] = c * a - s * b;
    row[q] = s * a + c * b;
  }
  for (int k = 0; k < 4; ++k) {
    const double a = e.value[p][k], b = e.value[q][k];
    e.value[p][k] = c * a - s * b;
    e.value[q][k] = s * a + c * b;
  }
  for (auto& row : e.vector) {
    const double a = row[p], b = row[q];
    row[p] = c * a - s * b;
    row[q] = s * a + c * b;
  }
  e.value[p][q] = e.value[q][p] = 0;
}

/// Cyclic Jacobi. It converges quadratically: a 4 x 4 matrix takes five or six sweeps.
void diagonalise(Eigen4& e) {
  constexpr double kNegligible = 1e-34;  // square of the resolution of double precision, as K is of size 1
  for (int sweep = 0; sweep < 16; ++sweep) {
    double off = 0;
    for (int p = 0; p < 4; ++p)
      for (int q = p + 1; q < 4; ++q) off += e.value[p][q] * e.value[p][q];
    if (off < kNegligible) return;
    for (int p = 0; p < 4; ++p)
      for (int q = p + 1; q < 4; ++q) rotate_pair(e, p, q);
  }
}

Eigen4 davenport(const Matrix3& f, double scale) {
  const auto& m = f.m;
  const double s = 1 / scale;
  const double xx = s * m[0][0], yy = s * m[1][1], zz = s * m[2][2];
  const double wx = s * m[2][1] - s * m[1][2], wy = s * m[0][2] - s * m[2][0], wz = s * m[1][0] - s * m[0][1];
  const double xy = s * m[0][1] + s * m[1][0], xz = s * m[0][2] + s * m[2][0], yz = s * m[1][2] + s * m[2][1];
  return {{{xx + yy + zz, wx, wy, wz}, {wx, xx - yy - zz, xy, xz}, {wy, xy, yy - xx - zz, yz}, {wz, xz, yz, zz - xx - yy}},
          {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
}

}  // namespace

Quat nearest_rotation(const Matrix3& f, const Quat& start) noexcept {
  double scale = 0, sum = 0;
  for (const auto& row : f.m) {
    for (const double x : row) {
      scale = std::max(scale, std::abs(x));
      sum += x;
    }
  }
  constexpr double kSmallest = 1e-290, kLargest = 1e290;  // so that 1 / scale and the sums stay finite
  if (!(scale > kSmallest && scale < kLargest) || !std::isfinite(sum)) return start;

  Eigen4 e = davenport(f, scale);
  diagonalise(e);
  int top = 0;
  double size = 0;
  for (int i = 0; i < 4; ++i) {
    if (e.value[i][i] > e.value[top][top]) top = i;
    size = std::max(size, std::abs(e.value[i][i]));
  }
  // Eigenvalues this close are equal in double precision: every vector of their span is optimal.
  const double equal = e.value[top][top] - 1e-14 * size;
  const double from[4] = {start.w, start.x, start.y, start.z};
  double q[4] = {}, norm2 = 0;
  for (int i = 0; i < 4; ++i) {
    if (e.value[i][i] < equal) continue;
    double along = 0;
    for (int k = 0; k < 4; ++k) along += e.vector[k][i] * from[k];
    for (int k = 0; k < 4; ++k) q[k] += along * e.vector[k][i];
  }
  for (const double x : q) norm2 += x * x;
  if (norm2 < 1e-12) {  // `start` is a half turn away from all of them: any will do
    norm2 = 0;
    for (int k = 0; k < 4; ++k) {
      q[k] = e.vector[k][top];
      norm2 += q[k] * q[k];
    }
  }
  const double n = 1 / std::sqrt(norm2);
  return {n * q[0], n * q[1], n * q[2], n * q[3]};
}

Matrix3 to_matrix(const Quat& q) noexcept {
  const double x2 = q.x + q.x, y2 = q.y + q.y, z2 = q.z + q.z;
  const double xx = q.x * x2, xy = q.x * y2, xz = q.x * z2, yy = q.y * y2, yz = q.y * z2, zz = q.z * z2;
  const double wx = q.w * x2, wy = q.w * y2, wz = q.w * z2;
  return {{{1 - (yy + zz), xy - wz, xz + wy}, {xy + wz, 1 - (xx + zz), yz - wx}, {xz - wy, yz + wx, 1 - (xx + yy)}}};
}

}  // namespace tactus::sim
