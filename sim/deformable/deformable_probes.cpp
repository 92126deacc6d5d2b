// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/deformable/deformable_probes.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <tactus/deformable/displacement.h>

namespace tactus::sim {

// ==== deformable probes ====

namespace {

constexpr unsigned kRings = 3;  // of a cut-out (thesis 3.3.1.1)

double extent(const TriMesh& mesh) {
  double largest = 0;
  for (const Vec3& v : mesh.vertices) largest = std::max({largest, std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  return largest;
}

}  // namespace

BodyTouch::BodyTouch(const TouchedSurface& surface)
    : object_([&] {
        DeformableObject out;
        out.rest.resize(surface.rest.vertices.size());
        out.triangles = surface.rest.triangles;
        out.body.emplace();
        out.body->coupling = surface.stiffness;
        out.body->friction = surface.friction;
        return out;
      }()),
      touch_(object_) {}

ProxyTouch BodyTouch::move(const Vec3& device, const SeenSurface& seen) noexcept {
  const auto push = touch_.move(device, seen.is_new, seen.vertices, state_);
  if (!push) return {};
  const auto& [a, b, c] = object_.triangles[push->triangle];
  const Vec3 &p = seen.vertices[a], &q = seen.vertices[b], &r = seen.vertices[c], n = cross(q - p, r - p);
  return {.touched = true,
          .triangle = push->triangle,
          .weights = push->weights,
          .proxy = push->weights[0] * p + push->weights[1] * q + push->weights[2] * r,
          .normal = (1 / norm(n)) * n};
}

DeformableProbes::DeformableProbes(std::span<const TouchedSurface> objects, std::size_t users, Following following)
    : users_(users) {
  for (const TouchedSurface& object : objects) {
    stiffness_.push_back(object.stiffness);
    const MeshProxyOptions proxy{.friction = object.friction};
    for (User& user : users_) {
      user.proxies.push_back({MeshProxy(proxy, extent(object.rest)), nullptr, nullptr});
      if (object.as_body) user.proxies.back().body = std::make_unique<BodyTouch>(object);
      if (following == Following::linearly && object.rate > 1)
        user.proxies.back().cut_out = std::make_unique<IntermediateModel>(object.rest, object.topology,
                                                                          IntermediateModelOptions{kRings, object.rate, proxy});
    }
  }
}

ProxyTouch DeformableProbes::move(User& user, std::uint32_t object, const SeenSurface& seen, const Vec3& device) noexcept {
  auto& [direct, cut_out, body] = user.proxies[object];
  if (body) return body->move(device, seen);
  if (cut_out) return user.placed ? cut_out->move(device) : cut_out->move_to(device, seen.vertices, seen.tree);
  return user.placed ? direct.move(device, seen.vertices, seen.tree)
                     : direct.move_to(device, seen.inside, seen.vertices, seen.tree);
}

Touch DeformableProbes::result(std::optional<std::uint32_t> object, const ProxyTouch& proxy_touch,
                               const Vec3& device) const noexcept {
  Touch out{.contact = {}, .proxy = device, .force = {}};
  if (!object) return out;
  out.surface = SurfaceContact{*object,           proxy_touch.triangle, proxy_touch.weights,
                               proxy_touch.proxy, proxy_touch.normal,   stiffness_[*object]};
  out.force = stiffness_[*object] * (proxy_touch.proxy - device);
  return out;
}

void DeformableProbes::expect(std::uint32_t object, double reach, std::span<const Vec3> vertices, std::span<const Vec3> next,
                              const AabbTree& tree) noexcept {
  for (User& user : users_)
    if (Proxy& proxy = user.proxies[object]; !proxy.cut_out && !proxy.body) proxy.direct.expect(reach, vertices, next, tree);
}

void DeformableProbes::update(std::uint32_t object, std::span<const Vec3> vertices, const AabbTree& tree) noexcept {
  for (User& user : users_)
    if (auto& cut_out = user.proxies[object].cut_out) cut_out->update(vertices, tree);
}

void DeformableProbes::update_at_rest(std::uint32_t object, std::span<const Vec3> vertices, const AabbTree& tree) noexcept {
  for (User& user : users_)
    if (auto& cut_out = user.proxies[object].cut_out) cut_out->update_at_rest(vertices, tree);
}

// ==== deformable view ====

namespace {

/// Largest distance between a point and its counterpart [m].
double farthest(std::span<const Vec3> from, std::span<const Vec3> to) {
  double square = 0;
  for (std::size_t i = 0; i < from.size(); ++i) square = std::max(square, dot(to[i] - from[i], to[i] - from[i]));
  return std::sqrt(square);
}

}  // namespace

std::vector<std::unique_ptr<DeformableView::Surface>> DeformableView::surfaces(std::span<const TraceDeformable> objects) {
  std::vector<std::unique_ptr<Surface>> out;
  for (const TraceDeformable& object : objects) out.push_back(std::make_unique<Surface>(object.rest));
  return out;
}

std::vector<TouchedSurface> DeformableView::touched(const Scene& scene) const {
  std::vector<TouchedSurface> out;
  for (std::size_t i = 0; i < surfaces_.size(); ++i) {
    const SceneDeformable& object = scene.deformables[i];
    out.push_back({surfaces_[i]->rest, surfaces_[i]->topology, object.stiffness, object.friction, object.rate});
  }
  return out;
}

DeformableView::DeformableView(const Scene& scene, std::span<const TraceDeformable> objects)
    : surfaces_(surfaces(objects)), probes_(touched(scene), scene.users.size(), Following::linearly) {}

void DeformableView::show(std::size_t object, std::span<const std::array<std::int32_t, 3>> displacements,
                          unsigned position_exp) noexcept {
  Surface& seen = *surfaces_[object];
  const auto number = static_cast<std::uint32_t>(object);
  const std::vector<Vec3>& rest = seen.rest.vertices;
  for (std::size_t v = 0; v < rest.size(); ++v) seen.next[v] = rest[v] + to_metres(displacements[v], position_exp);
  if (const double reach = farthest(seen.vertices, seen.next); reach > 0) {
    probes_.expect(number, reach, seen.vertices, seen.next, seen.tree);
    std::swap(seen.vertices, seen.next);
    seen.tree.refit(seen.vertices);
  }
  probes_.update(number, seen.vertices, seen.tree);
}

Touch DeformableView::touch(std::size_t user, const DeviceSample& device, bool) noexcept {
  return probes_.touch(user, device.position, [&](std::uint32_t i) {
    return SeenSurface{surfaces_[i]->vertices, surfaces_[i]->tree, surfaces_[i]->inside};
  });
}

}  // namespace tactus::sim
