// SPDX-License-Identifier: Apache-2.0
/// Triangle meshes in OBJ, PLY, STL, OFF and glTF 2.0 files, read and written in double precision (STL holds single).
///
/// What is used: coordinates and the corners of faces. What is reported (notes): a number of facets that the size contradicts, bytes and lines behind
/// the last element, solids read as one, lines of other kinds than faces, a last line without its end. What does not matter: normals, colours,
/// textures, materials, groups, names, other elements and properties of a PLY, the number of edges of an OFF, weights of vertices (reported),
/// cameras and lights of a glTF, its extras, names of nodes but for the one that is asked for, and bounds. A glTF may name files in its own folder and below, no others.
///
/// rule      class           broken when
/// R-SRF-1   io              the file cannot be opened, read or written
/// R-SRF-2   limit_exceeded  it is larger than 512 MiB, or announces more than 2^20 vertices or 2^21 faces
/// R-SRF-3   unsupported     the name ends in none of .obj, .ply, .stl, .off, .gltf and .glb; an OFF is binary or not in three dimensions;
///                           a PLY lacks vertices with x, y and z, or lists of corners; a glTF is not of version 2, needs an extension
///                           that is not read, or names a file that does not lie beside it
/// R-SRF-4   malformed       a line is not one of the format
/// R-SRF-5   malformed       the file ends before everything announced was there
/// R-SRF-6   invalid         a polygon has fewer than 3 or more than 1024 corners, or crosses itself
/// R-SRF-7   invalid         it holds no face
/// R-SEQ-6   invalid         no mesh hangs on a node of the name that is given (glTF)
/// R-SEQ-7   limit_exceeded  it uses more than 2^25 numbers (glTF)
/// R-SRF-8..14               the mesh is broken, see codec/base/tri_mesh.h
#pragma once

#include <string_view>

#include <tactus/base/tri_mesh.h>
#include <tactus/trace/read_notes.h>

namespace tactus::sim {

struct SurfaceFile {
  TriMesh mesh;                       ///< passed check(); STL: vertices with the same coordinates are one;
                                      ///< a vertex of several fans is one for each
  std::size_t polygons = 0;           ///< faces of more than three corners, cut into triangles
  std::size_t unused_vertices = 0;    ///< of no face, left out
  std::size_t dropped_faces = 0;      ///< without area, left out because the options say so
  std::vector<std::uint32_t> vertex;  ///< which of the file's vertices, from 0, each of the mesh's is
  ReadNotes notes;                    ///< what was decided about the file
};

/// Which way is up in a file. Up in a mesh is z: y up is turned, x, y, z become x, -z, y.
enum class Axes { as_the_format_says, z_up, y_up };  ///< only glTF says something: y

struct SurfaceOptions {
  bool drop_degenerate = false;  ///< leave out faces without area instead of refusing them (R-SRF-10)
  Axes axes = Axes::as_the_format_says;
  std::string node{};  ///< of a glTF scene: what hangs on it; empty: all
};

/// err  R-SRF-1..14
tl::expected<SurfaceFile, Diagnostic> read_surface(const std::string& path, const SurfaceOptions& options = {});
/// The same from memory; format is the name's ending, ".obj". The error names no file.
tl::expected<SurfaceFile, Diagnostic> parse_surface(std::string_view bytes, std::string_view format,
                                                    const SurfaceOptions& options = {});

/// The format follows from the name: OBJ, PLY and OFF as text, STL binary.
/// pre  the mesh passed check().   err  R-SRF-1, R-SRF-3
tl::expected<void, Diagnostic> write_surface(const std::string& path, const TriMesh& mesh);

}  // namespace tactus::sim
