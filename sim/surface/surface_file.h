// SPDX-License-Identifier: Apache-2.0
/// Triangle meshes in OBJ, PLY, STL and OFF files, read and written by OpenMesh.
///
/// OpenMesh keeps coordinates in single precision (6e-8 of their size), trusts the counts that a file announces, and silently
/// drops what it cannot use. Therefore sizes are checked before it reads the file, and its result is counted against the file's
/// content.
///
/// rule      class           broken when
/// R-SRF-1   io              the file cannot be opened, read or written
/// R-SRF-2   limit_exceeded  it is larger than 512 MiB, or announces more than 2^20 vertices or 2^21 faces
/// R-SRF-3   unsupported     the name ends in none of .obj, .ply, .stl and .off; a binary OFF; a PLY that does not begin with vertices
///                           and faces, whose coordinates are neither float nor double, or with other lists than the faces' corners,
///                           counted by one byte
/// R-SRF-4   malformed       a line is not one of the format, the header announces more than the file's size allows, or OpenMesh
///                           refuses it
/// R-SRF-5   malformed       it holds more faces or vertices than could be read
/// R-SRF-6   invalid         a polygon has fewer than 3 or more than 1024 corners, or no corner from which all of it is seen
/// R-SRF-7   invalid         it holds no face
/// R-SRF-8..14               the mesh is broken, see codec/base/tri_mesh.h
#pragma once

#include <string_view>

#include <tactus/base/tri_mesh.h>

namespace tactus::sim {

struct SurfaceFile {
  TriMesh mesh;                     ///< passed check(); STL: vertices with the same coordinates are one
  std::size_t polygons = 0;         ///< faces of more than three corners, cut into triangles
  std::size_t unused_vertices = 0;  ///< of no face, left out
};

/// err  R-SRF-1..14
tl::expected<SurfaceFile, Diagnostic> read_surface(const std::string& path);
/// The same from memory; format is the name's ending, ".obj". The error names no file.
tl::expected<SurfaceFile, Diagnostic> parse_surface(std::string_view text, std::string_view format);

/// The format follows from the name: OBJ, PLY and OFF as text, STL binary.
/// pre  the mesh passed check().   err  R-SRF-1, R-SRF-3
tl::expected<void, Diagnostic> write_surface(const std::string& path, const TriMesh& mesh);

}  // namespace tactus::sim
