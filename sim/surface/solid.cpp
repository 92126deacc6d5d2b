// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/surface/solid.h>

#include <tactus/base/rule.h>

namespace tactus::sim {
namespace {

tl::unexpected<Diagnostic> refused(RuleName rule, const char* kind, std::size_t element) {
  return tl::unexpected(Diagnostic{.error = fail(Errc::invalid, rule).value(), .kind = kind, .element = element});
}

}  // namespace

tl::expected<void, Diagnostic> check_closed(const TriMesh& mesh) {
  const MeshTopology topology(mesh);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (unsigned k = 0; k < 3; ++k)
      if (topology.across(t, k) == MeshTopology::kNone) return refused("R-TGN-2", "triangle", t);
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v)
    if (topology.triangles_of(v).empty()) return refused("R-TGN-8", "vertex", v);
  return {};
}

tl::expected<Solid, Diagnostic> solid_within(const TriMesh& mesh) {
  const Vec3 origin = mesh.vertices.empty() ? Vec3{} : mesh.vertices[0];
  Solid solid;
  Vec3 moment;  // about the origin [m^4]
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 x = mesh.vertices[a] - origin, y = mesh.vertices[b] - origin, z = mesh.vertices[c] - origin;
    const double volume = dot(cross(x, y), z) / 6;
    solid.volume += volume;
    moment = moment + (volume / 4) * (x + y + z);
  }
  if (!(solid.volume > 0)) return tl::unexpected(Diagnostic{fail(Errc::invalid, "R-TGN-4").value()});
  solid.centroid = origin + (1 / solid.volume) * moment;
  return solid;
}

}  // namespace tactus::sim
