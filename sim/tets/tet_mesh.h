// SPDX-License-Identifier: Apache-2.0
/// Tetrahedral meshes: what a deformable object is made of.
///
/// rule      class           element  broken when
/// R-TET-1   invalid         vertex   a coordinate is NaN or infinite, or larger than 1e6 m
/// R-TET-2   invalid         tet      an index is not that of a vertex
/// R-TET-3   invalid         tet      two corners are the same vertex, or its volume is zero: below 1e-12 of its longest edge's cube
/// R-TET-4   invalid         tet      inside out: negative volume
/// R-TET-5   invalid         tet      a face belongs to a third tetrahedron, or two lie on the same side of it (as if listed twice)
/// R-TET-6   invalid         vertex   belongs to no tetrahedron: it would have no mass
/// R-TET-7   limit_exceeded  0        more than 2^20 vertices or 2^22 tetrahedra
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <tactus/base/geometry.h>
#include <tactus/base/tri_mesh.h>

namespace tactus::sim {

// ==== tet mesh ====

/// Corners a b c d with (b-a) x (c-a) . (d-a) > 0.
using Tet = std::array<std::uint32_t, 4>;

inline constexpr std::size_t kMaxTets = std::size_t{1} << 22;

struct TetMesh {
  std::vector<Vec3> vertices;  ///< [m]
  std::vector<Tet> tets;
};

/// (b-a) x (c-a) . (d-a) / 6 [m^3]
double volume(const TetMesh& mesh, std::size_t tet) noexcept;

/// The smallest box around points; both corners in the origin when there are none.
struct Bounds {
  Vec3 low, high;
};
Bounds bounds(std::span<const Vec3> points) noexcept;

/// Checks all rules above; reports the first broken one in element order.   time O(n log n); allocates.   err  R-TET-1..7
tl::expected<void, Diagnostic> check(const TetMesh& mesh);

/// The boundary faces, outward, and which vertex of the tetrahedral mesh each of its vertices is. Vertices keep their order, so a
/// mesh whose vertices all lie on the surface keeps their numbers.
struct TetSurface {
  TriMesh mesh;
  std::vector<std::uint32_t> vertex;  ///< surface vertex -> vertex of the tetrahedral mesh
};
TetSurface surface(const TetMesh& mesh);

/// nx x ny x nz cubes of edge `cell` [m] with a corner in the origin, six tetrahedra each around the diagonal (Kuhn). Vertex
/// (i, j, k) has number (k (ny+1) + j) (nx+1) + i. 16 x 20 x 1 is the thesis's membrane: 714 vertices, 1424 triangles, 1920 tets.
/// pre  nx, ny, nz >= 1; cell > 0
TetMesh make_slab(std::uint32_t nx, std::uint32_t ny, std::uint32_t nz, double cell);

// ==== tet quality ====
// How well shaped tetrahedra are: flat ones make a simulation inaccurate and its highest frequency large.

struct TetQuality {
  /// A figure and the tetrahedron it belongs to, the first of equals.
  struct Worst {
    double value = 0;
    std::uint32_t tet = 0;
  };
  Worst smallest_angle;  ///< [rad] between two faces; regular: 1.231 (70.5 degrees)
  Worst largest_angle;   ///< [rad]
  /// 12 (3 V)^(2/3) / (sum of the six squared edges): 1 regular, 0 flat. [Liu and Joe 1994, mean ratio]
  Worst shape;
  double mean_shape = 0;
};

/// pre  the mesh passed check() and is not empty.   time O(n)
TetQuality quality(const TetMesh& mesh);

}  // namespace tactus::sim
