// SPDX-License-Identifier: Apache-2.0
/// Deformable objects: from metres to the grid and back. spec/60-mesh.md.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <tactus/base/geometry.h>
#include <tactus/base/result.h>
#include <tactus/base/tri_mesh.h>
#include <tactus/scene/deformable_object.h>

namespace tactus {

/// A mesh for a stream header: rest positions on the grid of 2^-position_exp m.
/// err  invalid_argument R-API-1 a coordinate is not finite; R-API-2 it leaves the grid's range.
Result<DeformableObject> make_deformable_object(std::string name, const TriMesh& mesh, unsigned position_exp);

/// Vectors (modes x vertices x 3, any scale) as a basis: entries scaled to the largest, quantiser steps so that a coefficient's
/// rounding moves the mesh by the same root mean square, `coarseness` visual bounds in the norm of the whole mesh.
/// err  invalid_argument R-API-1 an entry is not finite, or a vector is zero; R-API-9 more modes than ModeBasis::kMaxModes.
Result<ModeBasis> make_mode_basis(std::span<const double> vectors, std::size_t modes, double coarseness = 1.5);

/// Displacements to the grid.   time O(vertices), no allocation.
/// err  invalid_argument R-API-1 NaN or infinite; R-API-2 beyond +-2^27 grid units; R-API-5 counts differ. `out` is then undefined.
Result<void> to_grid(std::span<const Vec3> displacement, unsigned position_exp,
                     std::span<std::array<std::int32_t, 3>> out) noexcept;

/// Grid to metres.
Vec3 to_metres(const std::array<std::int32_t, 3>& v, unsigned position_exp) noexcept;

}  // namespace tactus
