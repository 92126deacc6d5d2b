// SPDX-License-Identifier: Apache-2.0
/// OpenMesh behind two functions: no exception leaves it and nothing of it reaches the terminal.
#pragma once

#include <string>
#include <vector>

#include <tactus/base/tri_mesh.h>

namespace tactus::sim {

using Polygon = std::vector<std::uint32_t>;

/// Vertices and faces as stored in a file, without connectivity.
struct PolygonSoup {
  std::vector<Vec3> vertices;
  std::vector<Polygon> polygons;
};

/// in   format  ".obj", ".ply", ".off", ".stl" to write, ".stla" (text) or ".stlb" (binary) to read
/// err  the reason, in a few words
tl::expected<PolygonSoup, std::string> openmesh_read(const std::string& text, const std::string& format);
tl::expected<std::string, std::string> openmesh_write(const TriMesh& mesh, const std::string& format);

}  // namespace tactus::sim
