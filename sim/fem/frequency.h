// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/sim/fem/model.h>

namespace tactus::sim {

/// Largest omega [rad/s] with K x = omega^2 M x, by Lanczos in the inner product of M. Returns the Ritz value plus its residual,
/// which bounds the distance to the eigenvalue: the result is never too small, and accurate to 1e-3 relative. 0 when there is no
/// row.
/// pre  both symmetric, K positive semidefinite, M positive definite
double largest_frequency(const SparseMatrix& stiffness, const SparseMatrix& mass);

}  // namespace tactus::sim
