// SPDX-License-Identifier: Apache-2.0
/// What a closed surface encloses.
#pragma once

#include <tactus/base/tri_mesh.h>

namespace tactus::sim {

/// err  R-TGN-2: an edge of the triangle named has no neighbour; R-TGN-8: the vertex named belongs to no triangle
/// pre  the mesh passed check()
tl::expected<void, Diagnostic> check_closed(const TriMesh& mesh);

struct Solid {
  double volume = 0;  ///< [m^3]
  Vec3 centroid;      ///< [m] centre of mass at constant density
};

/// By the divergence theorem: tetrahedra from one vertex to every triangle.   pre  closed
/// err  R-TGN-4: it encloses no volume, or looks inward
tl::expected<Solid, Diagnostic> solid_within(const TriMesh& mesh);

}  // namespace tactus::sim
