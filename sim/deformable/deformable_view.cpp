// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/deformable/deformable_view.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <tactus/deformable/displacement.h>

namespace tactus::sim {
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
