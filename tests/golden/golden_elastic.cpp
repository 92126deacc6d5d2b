// SPDX-License-Identifier: Apache-2.0
/// An elastic body under a device that presses, slides and leaves: what both ends compute.
#include <array>
#include <cinttypes>
#include <cstdio>
#include <utility>
#include <vector>

#include <tactus/base/bytes.h>
#include <tactus/elastic/driven_shape.h>
#include <tactus/rigid/device_path.h>
#include <tactus/scene/scene_builder.h>
#include "tests/golden/golden.h"

namespace tactus::golden {
namespace {

constexpr std::uint32_t kSide = 5, kLayers = 3;  // vertices
constexpr double kCell = 1.0 / 128;              // [m]

std::uint32_t number(std::uint32_t i, std::uint32_t j, std::uint32_t k) { return (k * kSide + j) * kSide + i; }

/// Cubes of six tetrahedra around a diagonal.
std::vector<ElasticBody::Tet> tets() {
  constexpr std::array<std::array<std::uint32_t, 3>, 6> kOrders{
      {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {1, 0, 2}, {0, 2, 1}, {2, 1, 0}}};
  std::vector<ElasticBody::Tet> out;
  for (std::uint32_t k = 0; k + 1 < kLayers; ++k)
    for (std::uint32_t j = 0; j + 1 < kSide; ++j)
      for (std::uint32_t i = 0; i + 1 < kSide; ++i)
        for (std::size_t o = 0; o < kOrders.size(); ++o) {
          std::array<std::uint32_t, 3> at{i, j, k};
          ElasticBody::Tet tet{number(i, j, k)};
          for (std::size_t step = 0; step < 3; ++step) {
            ++at[kOrders[o][step]];
            tet[step + 1] = number(at[0], at[1], at[2]);
          }
          if (o >= 3) std::swap(tet[2], tet[3]);
          out.push_back(tet);
        }
  return out;
}

/// The upper side alone can be touched. All other vertices are on the surface, too, as far as the codec knows.
SharedScene scene_of(double friction, const Vec3& gravity, ElasticBody::Method method, std::uint8_t sub_steps) {
  TriMesh mesh;
  for (std::uint32_t k = 0; k < kLayers; ++k)
    for (std::uint32_t j = 0; j < kSide; ++j)
      for (std::uint32_t i = 0; i < kSide; ++i) mesh.vertices.push_back({kCell * i, kCell * j, kCell * k});
  for (std::uint32_t j = 0; j + 1 < kSide; ++j)
    for (std::uint32_t i = 0; i + 1 < kSide; ++i) {
      const std::uint32_t a = number(i, j, kLayers - 1), b = a + 1, c = a + kSide, d = c + 1;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
  ElasticPhysics physics;
  ElasticBody& body = physics.body;
  body.tets = tets();
  body.materials = {{9e3, 0.42, 1100}, {3e3, 0.3, 900}};
  for (std::size_t t = 0; t < body.tets.size(); ++t) body.material.push_back(t % 5 < 3 ? 0 : 1);
  for (std::uint32_t v = 0; v < kSide * kSide; ++v)
    if (v % kSide == 0 || v / kSide == 0) body.fixed.push_back(v);
  body.mass_damping = 0.7;
  body.stiffness_damping = 0.003;
  body.gravity = gravity;
  body.coupling = 6;
  body.friction = friction;
  body.method = method;
  body.sub_steps = sub_steps;
  return SceneBuilder()
      .deformable("block", std::move(mesh), {.frame_period = 8, .elastic = std::move(physics)})
      .baselines(64)
      .build()
      .value();
}

/// On squares, so that no function of the library takes part.
Vec3 position(std::int64_t tick) {
  const double t = static_cast<double>(tick % 256) / 256, along = t < 0.5 ? 2 * t : 2 - 2 * t;
  const double depth = tick % 700 < 60 || tick % 700 > 600 ? -0.5 : 0.75;
  return {kCell * (0.5 + 3 * along), kCell * (0.5 + 3 * along * along), kCell * (kLayers - 1 - depth)};
}

using Method = ElasticBody::Method;

bool run(const char* name, double friction, const Vec3& gravity, Method method = Method::backward_euler,
         std::uint8_t sub_steps = 1) {
  const SharedScene scene = scene_of(friction, gravity, method, sub_steps);
  DevicePath path(device_scene(*scene).value());
  path.shift(0, 0);
  DrivenShape shape(*scene, scene->deformables[0], path);
  std::vector<Vec3i> shown(scene->deformables[0].rest.size());
  Fnv1a hash;
  for (std::int64_t tick = 0; tick < 1600; ++tick) {
    const auto device = to_grid({{position(tick), {}}, {}, {}}, tick, scene->grid);
    if (!device) return false;
    path.add(static_cast<std::uint64_t>(tick) + 1, *device);
    if (tick % 8 != 0) continue;
    if (!shape.body_at(tick, shown)) return false;
    for (const Vec3i& u : shown)
      for (const std::int32_t c : u) hash.add32(c);
  }
  std::printf("%s shapes %016" PRIx64 "\n", name, hash.value());
  return true;
}

}  // namespace

bool run_bodies() {
  return run("elastic", 0, {}) && run("elastic-rough", 0.4, {1, 0, -9.81}) &&
         run("elastic-tr-bdf2", 0.4, {1, 0, -9.81}, Method::tr_bdf2) &&
         run("elastic-verlet", 0.4, {1, 0, -9.81}, Method::velocity_verlet, 40);
}

}  // namespace tactus::golden
