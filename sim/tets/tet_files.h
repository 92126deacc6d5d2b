// SPDX-License-Identifier: Apache-2.0
/// Tetrahedral meshes in files: TetGen's .node with .ele, and Gmsh's .msh (versions 2 to 2.2, 4.0 and 4.1 as
/// text, 2 to 2.2 and 4.1 as bytes of either order). Files are not trusted:
/// numbers are whole and finite, and counts fit the remaining bytes before memory is reserved for them. What does not matter: in .msh other
/// sections than $Nodes and $Elements, the lowest and highest number, entities and their dimensions, numbers and tags of elements, and what
/// elements of other kinds hold, which are counted.
///
/// rule      class           broken when
/// R-TET-8   io              the file cannot be opened, read or written
/// R-TET-9   limit_exceeded  it is larger than 512 MiB, or announces more than 2^20 vertices or 2^22 tetrahedra
/// R-TET-10  truncated       it ends before everything announced was there
/// R-TET-11  malformed       a number is expected, and the word is none or does not fit its type
/// R-TET-12  invalid         a number is NaN or infinite
/// R-TET-13  malformed       a line has more or fewer words than its position asks for, or a section is missing or occurs twice
/// R-TET-14  unsupported     not three dimensions, not linear tetrahedra, a binary .msh of version 4.0, or another version
/// R-TET-15  invalid         vertices or tetrahedra are not numbered one by one from 0 or 1 (.node, .ele), a vertex number occurs
///                           twice, or a tetrahedron names a vertex that does not exist
/// R-TET-16  invalid         it holds no tetrahedron
/// R-TET-17  unsupported     the name does not end in .node, .ele or .msh
#pragma once

#include <iosfwd>
#include <string>
#include <string_view>

#include <tactus/sim/tets/tet_mesh.h>

namespace tactus::sim {

/// A mesh as stored in a file; check() validates it.
struct TetFile {
  TetMesh mesh;
  std::vector<double> vertex_attributes;     ///< .node: those of vertex 0, of vertex 1, ...; as many for each
  std::vector<double> tet_attributes;        ///< .ele: likewise
  std::vector<std::int32_t> vertex_markers;  ///< .node: boundary marker of each vertex; empty when there are none
  std::vector<std::int32_t> regions;         ///< .msh: tag of the volume that each tetrahedron belongs to
  std::size_t ignored_elements = 0;          ///< .msh: points, lines, triangles, ...
  std::size_t ignored_vertices = 0;          ///< vertices of no tetrahedron, left out
};

/// Read .msh, or .node and .ele beside one another (either may be named).   err  R-TET-8..17
tl::expected<TetFile, Diagnostic> read_tet_mesh(const std::string& path);

/// The same from memory; the error's file is empty, ".node" or ".ele".   err  R-TET-9..16
tl::expected<TetFile, Diagnostic> parse_node_ele(std::string_view node, std::string_view ele);
tl::expected<TetFile, Diagnostic> parse_msh(std::string_view bytes);

/// Numbered from 0, with the shortest digits that read back as the same bits.
void write_node(std::ostream& out, const TetMesh& mesh);
void write_ele(std::ostream& out, const TetMesh& mesh);
void write_msh(std::ostream& out, const TetMesh& mesh);  ///< Gmsh 4.1 ASCII, one volume
/// A closed surface for TetGen to fill.
void write_smesh(std::ostream& out, const TriMesh& mesh);

}  // namespace tactus::sim
