// SPDX-License-Identifier: Apache-2.0
/// Basis vectors for the displacements of a mesh, made from its rest shape and fixed vertices alone.
///
/// A network of equal springs ties every vertex to those nearer than 2.3 mean edges, across the surface and through it:
///   K = sum over springs of n n^T between the blocks of its ends,  n its direction at rest
/// The vectors are its slowest modes of vibration under equal masses, K phi = lambda phi. A body without enough fixed vertices has
/// its rigid motions among them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <tactus/base/result.h>
#include <tactus/base/tri_mesh.h>

namespace tactus::sim {

/// out  modes x vertices x 3, each of unit length and orthogonal to the others, slowest first; 0 at fixed vertices.
///      Equal inputs give equal bits on one machine.
/// pre  the mesh passed check(); `fixed` ascends and names vertices of it
/// time 0.12 s for 714 vertices and 48 modes, half of it in one factorisation; sim/modes/slowest_modes.h
/// err  invalid_argument R-API-9: no modes, or not less than free components; internal R-SIM-5: no convergence
Result<std::vector<double>> spring_modes(const TriMesh& rest, std::span<const std::uint32_t> fixed, std::size_t modes);

}  // namespace tactus::sim
