// SPDX-License-Identifier: Apache-2.0
#include <tactus/scene/scene.h>

#include <algorithm>
#include <string_view>
#include <unordered_set>
#include <utility>

#include <tactus/base/fixed.h>
#include <tactus/base/rule.h>
#include <tactus/base/shown.h>
#include <tactus/mesh/basis.h>
#include <tactus/mesh/elastic_elements.h>
#include <tactus/scene/elastic_syntax.h>
#include <tactus/scene/mesh_support.h>
#include <tactus/scene/scene_rules.h>

namespace tactus {
namespace {

/// Well-formed UTF-8 without control characters (RFC 3629).
bool is_plain_utf8(std::string_view text) noexcept {
  while (!text.empty()) {
    const auto lead = static_cast<std::uint8_t>(text[0]);
    const std::size_t length = utf8_length(text);
    if (length == 0 || lead < 0x20 || lead == 0x7f) return false;
    text.remove_prefix(length);
  }
  return true;
}

}  // namespace

bool is_name(std::string_view name) noexcept { return !name.empty() && name.size() <= 255 && is_plain_utf8(name); }

namespace {

/// Length within 2^-20 of 1: what a rounded unit quaternion and every product of them keep.
bool is_unit(const Quat30& q) noexcept {
  std::int64_t square = 0;
  for (const std::int32_t c : q) {
    if (c > kOne30 || c < -kOne30) return false;
    square += static_cast<std::int64_t>(c) * c;
  }
  constexpr std::int64_t one = std::int64_t{1} << 60;
  return square >= one - (one >> 19) && square <= one + (one >> 19);
}

bool are_exponents(const GridExponents& g) noexcept {
  return g.position >= 8 && g.position <= 30 && g.velocity <= g.position && g.position - g.velocity <= 12 && g.rotation >= 8 &&
         g.rotation <= 28 && g.angular_velocity <= g.rotation && g.angular_velocity <= 20 &&
         g.rotation - g.angular_velocity <= 12;
}

}  // namespace

RuleName broken_object_rule(const RigidObject& object) noexcept {
  if (!is_name(object.name)) return "R-STR-11";
  if (!Dof::is_valid(object.dof)) return "R-STR-12";
  if (!is_unit(object.initial.rotation)) return "R-STR-13";
  return {};
}

/// First rule that the stream parameters break; objects are checked one by one while they are read.
RuleName broken_parameter_rule(const SceneSpec& spec) noexcept {
  if (spec.tick_rate < 1 || spec.tick_rate > 1000000) return "R-STR-6";
  if (!are_exponents(spec.grid)) return "R-STR-7";
  if (spec.max_extrapolation < 1) return "R-STR-8";
  if (spec.baseline_span < 1 || spec.baseline_span > 64) return "R-STR-9";
  return {};
}

namespace {

/// in  meshes  null: there are no deformable objects
Result<void> find_broken_rule(const SceneSpec& spec, const MeshSupport* meshes, const DecodeLimits& limits) {
  if (const RuleName rule = broken_parameter_rule(spec)) return fail(Errc::invalid, rule);
  if (spec.deformables.size() > kMaxDeformables) return fail(Errc::invalid, "R-DEF-1");
  if (spec.objects.size() + spec.deformables.size() > limits.objects) return fail(Errc::limit_exceeded, "R-STR-14");
  std::unordered_set<std::string_view> names;
  for (const RigidObject& object : spec.objects) {
    if (const RuleName rule = broken_object_rule(object)) return fail(Errc::invalid, rule);
    if (!names.insert(object.name).second) return fail(Errc::invalid, "R-STR-11");
  }
  std::uint64_t vertices = 0, triangles = 0;
  for (const DeformableObject& object : spec.deformables) {
    if (!is_name(object.name) || !names.insert(object.name).second) return fail(Errc::invalid, "R-STR-11");
    if (object.profile == DeformableProfile::thesis && limits.thesis == nullptr) return fail(Errc::unsupported, "R-DEF-2");
    if (const RuleName rule = meshes->broken_rule(object)) return fail(Errc::invalid, rule);
    if (object.body && !meshes->is_solid(object, spec.grid.position)) return fail(Errc::invalid, "R-ELA-4");
    vertices += object.rest.size();
    triangles += object.triangles.size();
    if (vertices > limits.vertices || triangles > limits.triangles) return fail(Errc::limit_exceeded, "R-STR-14");
  }
  if (const RuleName rule = broken_part_rule(spec)) return fail(Errc::invalid, rule);
  if (spec.bounds && !are_bounds(spec)) return fail(Errc::invalid, "R-STR-17");
  if (state_bytes(spec) > limits.state_bytes) return fail(Errc::limit_exceeded, "R-STR-18");
  if (basis_work(spec) > limits.basis_work) return fail(Errc::limit_exceeded, "R-STR-21");
  if (meshes == nullptr) return {};
  if (meshes->elastic_work(spec) > limits.elastic_work) return fail(Errc::limit_exceeded, "R-STR-24");
  for (const DeformableObject& object : spec.deformables)
    if (object.body && !meshes->steps_stably(object, spec.grid.position, spec.tick_rate)) return fail(Errc::invalid, "R-ELA-5");
  return {};
}

}  // namespace

Result<void> check_scene(const SceneSpec& spec, const DecodeLimits& limits) try {
  return find_broken_rule(spec, &linked_mesh_support, limits);
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

Result<void> check_scene(const Scene& scene, const DecodeLimits& limits) try {
  DecodeLimits own = limits;
  if (scene.thesis()) own.thesis = scene.thesis();
  return find_broken_rule(scene, scene.mesh_support(), own);
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

Scene::Scene(SceneSpec&& spec, const MeshSupport* meshes, const ThesisComponent* thesis)
    : SceneSpec(std::move(spec)), mesh_support_(meshes), thesis_(thesis), has_paths_(driven || has_elastic_body(deformables)) {
  for (std::uint32_t i = 0; i < objects.size(); ++i)
    if (objects[i].dof != Dof::none) moving_.push_back(i);
  for (DeformableObject& object : deformables) {
    meshes->compute_basis(object);
    const bool is_main = object.profile == DeformableProfile::main;
    hierarchies_.push_back(is_main ? meshes->hierarchy(object) : nullptr);
  }
}

Result<SharedScene> Scene::create(SceneSpec spec, const DecodeLimits& limits) {
  return create(std::move(spec), &linked_mesh_support, limits);
}

Result<SharedScene> Scene::create(SceneSpec&& spec, const MeshSupport* meshes, const DecodeLimits& limits) try {
  TACTUS_CHECK(find_broken_rule(spec, meshes, limits));
  return SharedScene(new Scene(std::move(spec), meshes, limits.thesis));
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

std::optional<std::uint32_t> Scene::find(std::string_view name) const noexcept {
  const auto index_in = [name](const auto& all) -> std::optional<std::uint32_t> {
    for (std::uint32_t i = 0; i < all.size(); ++i)
      if (all[i].name == name) return i;
    return std::nullopt;
  };
  const auto rigid = index_in(objects);
  return rigid ? rigid : index_in(deformables);
}

std::uint64_t state_bytes(const SceneSpec& spec) noexcept {
  const std::uint64_t states = spec.baseline_span + 2u;  // the initial one and that of the packet at hand
  const std::uint64_t load = spec.loads ? 12 * (2 + std::uint64_t{spec.loads->users}) : 0;
  std::uint64_t sum = (64 + load) * states * spec.objects.size();
  for (const DeformableObject& object : spec.deformables) {
    const std::size_t modes = std::max({object.basis.steps.size(), std::size_t{object.spring_basis.modes},
                                        ModeBasis::kClusterModes * object.cluster_basis.count});
    const bool is_main = object.profile == DeformableProfile::main;
    const std::uint64_t vertex = 12u + (is_main && object.layered ? 12u : 0u) + (is_main && object.fade > 0 ? 12u : 0u);
    sum += states * (vertex * object.rest.size() + 48 * modes);
    if (object.profile == DeformableProfile::thesis)
      sum += (object.models_kept ? states + 2 : 2) * 4 * (254 + (std::uint64_t{1} << object.quant_bits));
  }
  return sum;
}

std::uint64_t basis_work(const SceneSpec& spec) noexcept {
  std::uint64_t sum = 0;
  for (const DeformableObject& object : spec.deformables) {
    const std::uint64_t vertices = object.rest.size();
    if (object.cluster_basis.count > 0) sum += vertices * (object.cluster_basis.blend + std::uint64_t{4}) / 4;
    if (object.spring_basis.modes == 0) continue;
    const std::uint64_t columns = object.spring_basis.modes + std::uint64_t{8};
    sum += columns * (vertices + 16 * std::min<std::uint64_t>(vertices, kBasisCore)) + columns * columns * columns / 4;
  }
  return sum;
}

std::uint64_t elastic_work(const SceneSpec& spec) {
  std::uint64_t sum = 0;
  for (const DeformableObject& object : spec.deformables)
    if (object.body) sum += elastic_work(*object.body, object.rest.size() + object.body->inner.size());
  return sum;
}

}  // namespace tactus
