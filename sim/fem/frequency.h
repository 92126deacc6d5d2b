// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/sim/fem/model.h>

namespace tactus::sim {

/// Largest omega [rad/s] with K x = omega^2 M x, by Lanczos in the inner product of M. The Ritz value plus its residual, which
/// bounds how far the eigenvalue is from it, so that the answer errs upwards; relative 1e-3. 0 when there is no row.
/// pre  both symmetric, K positive semidefinite, M positive definite
double largest_frequency(const SparseMatrix& stiffness, const SparseMatrix& mass);

}  // namespace tactus::sim
