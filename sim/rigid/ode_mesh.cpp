// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/rigid/ode_mesh.h>

#include <algorithm>
#include <limits>

namespace tactus::sim {
namespace {

double distance2(const dContact& a, const dContact& b) noexcept {
  double sum = 0;
  for (int k = 0; k < 3; ++k) sum += (a.geom.pos[k] - b.geom.pos[k]) * (a.geom.pos[k] - b.geom.pos[k]);
  return sum;
}

}  // namespace

OdeMesh make_ode_mesh(const TriMesh& mesh) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(Triangle) == 3 * sizeof(dTriIndex));
  OdeMesh data(dGeomTriMeshDataCreate());
  dGeomTriMeshDataBuildDouble(data.get(), mesh.vertices.data(), sizeof(Vec3), static_cast<int>(mesh.vertices.size()),
                              mesh.triangles.data(), static_cast<int>(3 * mesh.triangles.size()), sizeof(Triangle));
  return data;
}

dMass mass_of_mesh(dGeomID geom, double mass) {
  dMass out;
  dMassSetTrimeshTotal(&out, mass, geom);
  dMassTranslate(&out, -out.c[0], -out.c[1], -out.c[2]);  // rounding error of the centre
  return out;
}

int keep_outermost(std::span<dContact> contacts, int most) noexcept {
  const auto count = std::min(contacts.size(), static_cast<std::size_t>(most));
  if (count == contacts.size()) return static_cast<int>(count);
  std::iter_swap(contacts.begin(), std::max_element(contacts.begin(), contacts.end(),
                                                    [](auto& a, auto& b) { return a.geom.depth < b.geom.depth; }));
  for (std::size_t kept = 1; kept < count; ++kept) {
    std::size_t farthest = kept;
    double largest = -1;
    for (std::size_t i = kept; i < contacts.size(); ++i) {
      double nearest = std::numeric_limits<double>::infinity();
      for (std::size_t k = 0; k < kept; ++k) nearest = std::min(nearest, distance2(contacts[i], contacts[k]));
      if (nearest > largest) largest = nearest, farthest = i;
    }
    std::swap(contacts[kept], contacts[farthest]);
  }
  return static_cast<int>(count);
}

}  // namespace tactus::sim
