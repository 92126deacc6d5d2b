// SPDX-License-Identifier: Apache-2.0
/// A slab of elastic material on a frame, and a device that presses on it.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>

#include <tactus/elastic/driven_shape.h>
#include <tactus/rigid/device_path.h>
#include <tactus/scene/scene_builder.h>
#include <tactus/sim/tets/tet_mesh.h>

namespace tactus::testing {

inline constexpr double kCell = 0.01, kCoupling = 5, kYoung = 1e4;
inline constexpr std::uint32_t kCells = 6, kFrame = 10;  // 60 x 60 x 10 mm; ticks

/// Its upper side is z = 10 mm. All its vertices are on the surface, so that they keep their numbers; those of the rim are fixed.
inline sim::TetMesh slab_mesh() { return sim::make_slab(kCells, kCells, 1, kCell); }

inline ElasticPhysics slab_physics() {
  const sim::TetMesh mesh = slab_mesh();
  ElasticPhysics out;
  ElasticBody& body = out.body;
  body.tets = mesh.tets;
  body.materials = {{kYoung, 0.45, 1000}, {kYoung / 4, 0.4, 1000}};
  const double middle = kCell * kCells / 2;
  for (const ElasticBody::Tet& tet : body.tets) body.material.push_back(mesh.vertices[tet[0]].x < middle ? 0 : 1);
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
    const auto is_end = [](double x) { return x < kCell / 2 || x > kCell * (kCells - 0.5); };
    if (is_end(mesh.vertices[v].x) || is_end(mesh.vertices[v].y)) body.fixed.push_back(v);
  }
  body.mass_damping = 1;
  body.stiffness_damping = 0.004;
  body.coupling = kCoupling;
  return out;
}

inline SharedScene elastic_scene(ElasticPhysics physics = slab_physics(), std::uint32_t ticks = kFrame) {
  SceneBuilder builder;
  const auto frame = static_cast<double>(ticks);
  builder.deformable("slab", sim::surface(slab_mesh()).mesh, {.frame_period = frame, .elastic = std::move(physics)})
      .baselines(64);
  return builder.build().value();
}

inline RigidState device_at(const Scene& scene, std::int64_t tick, const Vec3& position, const Vec3& velocity = {}) {
  return to_grid({{position, {}}, velocity, {}}, tick, scene.grid).value();
}

/// From above it presses 6 mm deep, circles, and leaves.
inline Vec3 pressing(std::int64_t tick) {
  const double t = 1e-3 * static_cast<double>(tick), deep = t < 0.1 || t > 0.6 ? 0.004 : -0.006;
  return {0.03 + 0.01 * std::sin(9 * t), 0.03 + 0.008 * std::cos(7 * t), kCell + deep};
}

/// A packet of the device in every tick, which takes effect at once.
template <class Where>
std::shared_ptr<DevicePath> device_along(const SharedScene& scene, std::int64_t ticks, Where where) {
  auto path = std::make_shared<DevicePath>(device_scene(*scene).value());
  path->shift(0, 0);
  for (std::int64_t tick = 0; tick < ticks; ++tick)
    path->add(static_cast<std::uint64_t>(tick) + 1, device_at(*scene, tick, where(tick)));
  return path;
}

}  // namespace tactus::testing
