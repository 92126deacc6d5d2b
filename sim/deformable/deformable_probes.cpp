// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/deformable/deformable_probes.h>

#include <algorithm>
#include <cmath>

namespace tactus::sim {
namespace {

constexpr unsigned kRings = 3;  // of a cut-out (thesis 3.3.1.1)

double extent(const TriMesh& mesh) {
  double largest = 0;
  for (const Vec3& v : mesh.vertices) largest = std::max({largest, std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  return largest;
}

}  // namespace

DeformableProbes::DeformableProbes(std::span<const TouchedSurface> objects, std::size_t users, Following following)
    : users_(users) {
  for (const TouchedSurface& object : objects) {
    stiffness_.push_back(object.stiffness);
    const MeshProxyOptions proxy{.friction = object.friction};
    for (User& user : users_) {
      user.proxies.push_back({MeshProxy(proxy, extent(object.rest)), nullptr});
      if (following == Following::linearly && object.rate > 1)
        user.proxies.back().cut_out = std::make_unique<IntermediateModel>(object.rest, object.topology,
                                                                          IntermediateModelOptions{kRings, object.rate, proxy});
    }
  }
}

ProxyTouch DeformableProbes::move(User& user, std::uint32_t object, const SeenSurface& seen, const Vec3& device) noexcept {
  auto& [direct, cut_out] = user.proxies[object];
  if (cut_out) return user.placed ? cut_out->move(device) : cut_out->place(device, seen.vertices, seen.tree);
  return user.placed ? direct.move(device, seen.vertices, seen.tree)
                     : direct.place(device, seen.inside, seen.vertices, seen.tree);
}

Touch DeformableProbes::result(std::optional<std::uint32_t> object, const ProxyTouch& felt, const Vec3& device) const noexcept {
  Touch out{.contact = {}, .proxy = device, .force = {}};
  if (!object) return out;
  out.surface = SurfaceContact{*object, felt.triangle, felt.weights, felt.proxy, felt.normal, stiffness_[*object]};
  out.force = stiffness_[*object] * (felt.proxy - device);
  return out;
}

void DeformableProbes::expect(std::uint32_t object, double reach, std::span<const Vec3> vertices, std::span<const Vec3> next,
                              const AabbTree& tree) noexcept {
  for (User& user : users_)
    if (Proxy& proxy = user.proxies[object]; !proxy.cut_out) proxy.direct.expect(reach, vertices, next, tree);
}

void DeformableProbes::update(std::uint32_t object, std::span<const Vec3> vertices, const AabbTree& tree) noexcept {
  for (User& user : users_)
    if (auto& cut_out = user.proxies[object].cut_out) cut_out->update(vertices, tree);
}

void DeformableProbes::update_at_rest(std::uint32_t object, std::span<const Vec3> vertices, const AabbTree& tree) noexcept {
  for (User& user : users_)
    if (auto& cut_out = user.proxies[object].cut_out) cut_out->update_at_rest(vertices, tree);
}

}  // namespace tactus::sim
