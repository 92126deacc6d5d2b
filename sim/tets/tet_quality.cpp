// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/tets/tet_quality.h>

#include <cmath>
#include <numbers>

namespace tactus::sim {
namespace {

/// Outward normals of the faces opposite to corners a, b, c, d; as long as twice the face's area.
std::array<Vec3, 4> face_normals(const TetMesh& mesh, const Tet& tet) {
  const Vec3 &a = mesh.vertices[tet[0]], &b = mesh.vertices[tet[1]], &c = mesh.vertices[tet[2]], &d = mesh.vertices[tet[3]];
  return {cross(c - b, d - b), cross(d - a, c - a), cross(b - a, d - a), cross(c - a, b - a)};
}

double shape(const TetMesh& mesh, std::size_t t) {
  double squares = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      const Vec3 edge = mesh.vertices[mesh.tets[t][i]] - mesh.vertices[mesh.tets[t][k]];
      squares += dot(edge, edge);
    }
  }
  return 12 * std::cbrt(std::pow(3 * volume(mesh, t), 2)) / squares;
}

}  // namespace

TetQuality quality(const TetMesh& mesh) {
  TetQuality out{{std::numbers::pi, 0}, {0, 0}, {2, 0}, 0};
  for (std::uint32_t t = 0; t < mesh.tets.size(); ++t) {
    const std::array<Vec3, 4> normals = face_normals(mesh, mesh.tets[t]);
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t k = 0; k < i; ++k) {
        const double angle = std::numbers::pi - std::atan2(norm(cross(normals[i], normals[k])), dot(normals[i], normals[k]));
        if (angle < out.smallest_angle.value) out.smallest_angle = {angle, t};
        if (angle > out.largest_angle.value) out.largest_angle = {angle, t};
      }
    }
    const double value = shape(mesh, t);
    out.mean_shape += value / static_cast<double>(mesh.tets.size());
    if (value < out.shape.value) out.shape = {value, t};
  }
  return out;
}

}  // namespace tactus::sim
