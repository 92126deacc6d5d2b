// SPDX-License-Identifier: Apache-2.0
/// The eigenvectors of K in the space of a few columns: Rayleigh-Ritz. spec/50-deformable.md section 10.4. Internal to the library.
/// binary64 in the written order: both ends must agree on every bit.
#pragma once

#include <vector>

#include <tactus/deformable/spring_network.h>

namespace tactus {

/// Replace the columns of x by vectors of the same space that are orthonormal and diagonalise x^T K x, the smallest first.
/// in   product  K x
/// ret  the diagonal.   time O(rows * columns^2), allocates
std::vector<double> rotate_to_ritz_vectors(Columns& x, const Columns& product);

}  // namespace tactus
