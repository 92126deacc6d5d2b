// SPDX-License-Identifier: Apache-2.0
/// Fill a closed surface with tetrahedra by running the program `tetgen` (Debian package tetgen; AGPL, so it is never linked: only
/// .smesh, .node and .ele files are exchanged, in a private folder that is removed afterwards). No shell is involved.
///
/// rule      class             broken when
/// R-TGN-1   unsupported       the program is not there
/// R-TGN-2   invalid           an edge of the triangle named has no neighbour: the surface is not closed
/// R-TGN-3   invalid           the two triangles named cut or touch each other
/// R-TGN-4   invalid           the surface encloses no volume, or looks inward
/// R-TGN-5   limit_exceeded    the time limit passed; 2^22 tetrahedra of the largest volume are fewer than it takes, or more came out
/// R-TGN-6   io                the program failed otherwise, or a file could not be written; its last words
/// R-TGN-7   invalid_argument  an option is not finite or out of range
/// R-TGN-8   invalid           the vertex named belongs to no triangle, or stands where another one does
/// R-TGN-9   invalid           the tetrahedra's volume is not what the surface encloses (a cavity, or one part inside another)
/// R-SRF-8..14                 the mesh is broken, see codec/base/tri_mesh.h
#pragma once

#include <tactus/base/tri_mesh.h>
#include <tactus/sim/tets/tet_mesh.h>

namespace tactus::sim {

/// What becomes of the surface's triangles.
enum class Boundary {
  keep,   ///< they stay, and so may tetrahedra at them that are larger or worse than asked for: points are added inside only
  split,  ///< points are added on them too, and what is asked for holds everywhere
};

struct FillOptions {
  Boundary boundary = Boundary::keep;
  double max_volume = 0;           ///< [m^3] of a tetrahedron; 0: no limit
  double quality = 0;              ///< largest ratio of circumsphere radius to shortest edge, 1.1 or more; 0: none
  double time_limit = 60;          ///< [s]
  std::string program = "tetgen";  ///< looked up in PATH unless it holds a '/'
};

/// out  passed check(); the surface's vertices first, with the same bits
/// err  R-TGN-1..9, R-SRF-8..14
tl::expected<TetMesh, Diagnostic> fill(const TriMesh& surface, const FillOptions& options);

}  // namespace tactus::sim
