// SPDX-License-Identifier: Apache-2.0
#include "sim/mesh/tet_mesh.h"

#include <algorithm>

namespace tactus {
namespace {

using Face = std::array<std::uint32_t, 3>;

/// Faces of a tetrahedron, counter-clockwise seen from outside.
std::array<Face, 4> faces(const Tet& t) {
  return {{{t[0], t[2], t[1]}, {t[0], t[1], t[3]}, {t[1], t[2], t[3]}, {t[0], t[3], t[2]}}};
}

}  // namespace

double volume(const TetMesh& mesh, std::size_t tet) noexcept {
  const auto& [a, b, c, d] = mesh.tets[tet];
  const Vec3& origin = mesh.vertices[a];
  return dot(cross(mesh.vertices[b] - origin, mesh.vertices[c] - origin), mesh.vertices[d] - origin) / 6;
}

TetSurface surface(const TetMesh& mesh) {
  struct Side {
    Face key, face;  // sorted, as seen from outside
  };
  std::vector<Side> sides;
  sides.reserve(4 * mesh.tets.size());
  for (const Tet& tet : mesh.tets) {
    for (const Face& face : faces(tet)) {
      Face key = face;
      std::sort(key.begin(), key.end());
      sides.push_back({key, face});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) { return a.key < b.key; });

  TetSurface out;
  std::vector<std::uint32_t> number(mesh.vertices.size(), 0);
  for (std::size_t i = 0; i < sides.size(); ++i) {
    if (i + 1 < sides.size() && sides[i].key == sides[i + 1].key) {
      ++i;
      continue;
    }
    out.mesh.triangles.push_back(sides[i].face);
    for (const std::uint32_t v : sides[i].face) number[v] = 1;
  }
  for (std::uint32_t v = 0; v < number.size(); ++v) {
    if (number[v] == 0) continue;
    number[v] = static_cast<std::uint32_t>(out.vertex.size());
    out.vertex.push_back(v);
    out.mesh.vertices.push_back(mesh.vertices[v]);
  }
  for (Triangle& triangle : out.mesh.triangles)
    for (std::uint32_t& v : triangle) v = number[v];
  return out;
}

TetMesh make_slab(std::uint32_t nx, std::uint32_t ny, std::uint32_t nz, double cell) {
  TetMesh mesh;
  for (std::uint32_t k = 0; k <= nz; ++k)
    for (std::uint32_t j = 0; j <= ny; ++j)
      for (std::uint32_t i = 0; i <= nx; ++i) mesh.vertices.push_back({cell * i, cell * j, cell * k});

  const std::uint32_t x = 1, y = nx + 1, z = (nx + 1) * (ny + 1);
  for (std::uint32_t k = 0; k < nz; ++k) {
    for (std::uint32_t j = 0; j < ny; ++j) {
      for (std::uint32_t i = 0; i < nx; ++i) {
        const std::uint32_t o = i * x + j * y + k * z, far = o + x + y + z;
        // One tetrahedron for each order in which the diagonal can be walked along the axes; odd orders are mirrored.
        mesh.tets.push_back({o, o + x, o + x + y, far});
        mesh.tets.push_back({o, o + x, far, o + x + z});
        mesh.tets.push_back({o, o + y, far, o + x + y});
        mesh.tets.push_back({o, o + y, o + y + z, far});
        mesh.tets.push_back({o, o + z, o + x + z, far});
        mesh.tets.push_back({o, o + z, far, o + y + z});
      }
    }
  }
  return mesh;
}

}  // namespace tactus
