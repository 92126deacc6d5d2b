// SPDX-License-Identifier: Apache-2.0
/// The basis that both ends compute from the rest mesh and the fixed vertices: about the slowest modes of a network of springs.
/// spec/50-deformable.md section 10. Internal to the library.
///
/// The modes are found on at most kBasisCore vertices, from coarse to fine in the coding order, by subspace iteration with Chebyshev
/// polynomials. The other vertices get theirs from their parents.
#pragma once

#include <cstddef>

#include <tactus/scene/deformable_object.h>

namespace tactus {

inline constexpr std::size_t kBasisCore = 1024;   ///< vertices among which springs are laid
inline constexpr std::size_t kBasisAnchors = 64;  ///< fixed vertices that a network takes in beside its own

/// pre  the object breaks no rule, and asks for a computed basis
/// time 80 ms for 48 modes of 700 vertices, 160 ms of 50 000; allocates
ModeBasis spring_basis(const DeformableObject& object);

}  // namespace tactus
