// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/deformable/elastic_physics.h>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace tactus::sim {
namespace {

constexpr std::uint32_t kInside = 0xffffffff;

/// Numbers of the vertices as the client has them: those of the surface first.
std::vector<std::uint32_t> numbers(const TetMesh& mesh, const TetSurface& surface, std::vector<Vec3>& inner) {
  std::vector<std::uint32_t> out(mesh.vertices.size(), kInside);
  for (std::uint32_t i = 0; i < surface.vertex.size(); ++i) out[surface.vertex[i]] = i;
  for (std::size_t v = 0; v < out.size(); ++v) {
    if (out[v] != kInside) continue;
    out[v] = static_cast<std::uint32_t>(surface.vertex.size() + inner.size());
    inner.push_back(mesh.vertices[v]);
  }
  return out;
}

/// Each material once.   out  false: there are too many
bool add_materials(const SceneDeformable& object, double model_scale, ElasticBody& body) {
  for (std::size_t t = 0; t < object.mesh.tets.size(); ++t) {
    const SceneMaterial& m = object.materials[object.materials.size() == 1 ? 0 : t];
    const ElasticMaterial material{model_scale * m.young, m.poisson, m.density};
    const auto known = std::ranges::find(body.materials, material);
    if (known == body.materials.end() && body.materials.size() == ElasticBody::kMaxMaterials) return false;
    body.material.push_back(static_cast<std::uint8_t>(known - body.materials.begin()));
    if (known == body.materials.end()) body.materials.push_back(material);
  }
  return true;
}

/// So many sub-steps that velocity Verlet is stable, `least` or more.   out  false: there is no such number
bool choose_sub_steps(const SceneDeformable& object, const TriMesh& surface, int least, ElasticPhysics& physics) {
  for (int n = least; n <= ElasticBody::kMostSubSteps; ++n) {
    physics.body.sub_steps = static_cast<std::uint8_t>(n);
    if (SceneBuilder::steps_stably(physics, surface.vertices, object.rate * kTick)) return true;
  }
  return false;
}

}  // namespace

std::optional<ElasticPhysics> elastic_physics(const SceneDeformable& object, const Vec3& gravity, const ElasticStep& step,
                                              double model_scale) {
  if (!object.corotated || model_scale == 0) return std::nullopt;
  const TetSurface surface = tactus::sim::surface(object.mesh);
  ElasticPhysics out{.body = {.inner = {},
                              .tets = object.mesh.tets,
                              .materials = {},
                              .material = {},
                              .fixed = {},
                              .mass_damping = object.mass_damping,
                              .stiffness_damping = object.stiffness_damping,
                              .gravity = gravity,
                              .coupling = object.stiffness,
                              .friction = object.friction,
                              .method = step.method}};
  if (!add_materials(object, model_scale, out.body)) return std::nullopt;
  const std::vector<std::uint32_t> number = numbers(object.mesh, surface, out.inner);
  for (Tet& tet : out.body.tets)
    for (std::uint32_t& corner : tet) corner = number[corner];
  for (const std::uint32_t v : object.fixed) out.body.fixed.push_back(number[v]);
  std::ranges::sort(out.body.fixed);
  out.body.fixed.erase(std::unique(out.body.fixed.begin(), out.body.fixed.end()), out.body.fixed.end());
  if (step.method == ElasticBody::Method::velocity_verlet && !choose_sub_steps(object, surface.mesh, step.sub_steps, out))
    return std::nullopt;
  if (!SceneBuilder::can_compute(out, surface.vertex.size())) return std::nullopt;
  return out;
}

}  // namespace tactus::sim
