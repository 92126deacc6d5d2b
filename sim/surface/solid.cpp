// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/surface/solid.h>

namespace tactus::sim {
namespace {

tl::unexpected<SurfaceError> broken(const char* rule, std::string place) {
  return tl::unexpected(SurfaceError{fail(Errc::invalid, rule).value(), {}, 0, std::move(place)});
}

}  // namespace

tl::expected<void, SurfaceError> check_closed(const TriMesh& mesh) {
  const MeshTopology topology(mesh);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (unsigned k = 0; k < 3; ++k)
      if (topology.across(t, k) == MeshTopology::kNone) return broken("R-TGN-2", "triangle " + std::to_string(t));
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v)
    if (topology.triangles_of(v).empty()) return broken("R-TGN-8", "vertex " + std::to_string(v));
  return {};
}

tl::expected<Solid, SurfaceError> solid_within(const TriMesh& mesh) {
  const Vec3 origin = mesh.vertices.empty() ? Vec3{} : mesh.vertices[0];
  Solid solid;
  Vec3 moment;  // about the origin [m^4]
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 x = mesh.vertices[a] - origin, y = mesh.vertices[b] - origin, z = mesh.vertices[c] - origin;
    const double volume = dot(cross(x, y), z) / 6;
    solid.volume += volume;
    moment = moment + (volume / 4) * (x + y + z);
  }
  if (!(solid.volume > 0)) return broken("R-TGN-4", "");
  solid.centroid = origin + (1 / solid.volume) * moment;
  return solid;
}

}  // namespace tactus::sim
