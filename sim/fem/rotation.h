// SPDX-License-Identifier: Apache-2.0
/// The rotation nearest to a matrix, for any matrix: inside out, flat, a line, a point, zero.
#pragma once

#include <tactus/base/geometry.h>

namespace tactus::sim {

struct Matrix3 {
  double m[3][3] = {};  ///< rows
};

/// Unit quaternion of the rotation R that maximises trace(R^T F), equivalently minimises |F - R|: the orthogonal polar factor
/// when det F > 0, the closest proper rotation when not. By Davenport's method: q^T K(F) q is largest at the top eigenvector
/// of a symmetric 4 x 4 matrix, found by Jacobi sweeps. Where several rotations are equally good (F a line or a point, or its
/// two smallest signed singular values opposite) the one closest to `start` is taken, so that a sequence does not jump.
/// The scale of F does not matter: F and 1e6 F have the same result. For F zero or not finite the result is `start`.
/// pre  start is a unit quaternion.   time 1 us, no allocation.
Quat nearest_rotation(const Matrix3& f, const Quat& start) noexcept;

/// R(q) of a unit quaternion.
Matrix3 to_matrix(const Quat& q) noexcept;

}  // namespace tactus::sim
