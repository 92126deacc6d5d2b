// SPDX-License-Identifier: Apache-2.0
#include <tactus/scene/scene.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include <tactus/packet/substream.h>
#include <tactus/scene/scene_syntax.h>
#include <tactus/thesis/if_built.h>

#include "bounds.h"
#include "handles.h"

namespace tactus::c {
namespace {

constexpr tactus_limits kLimits{.size = sizeof(tactus_limits),
                                .objects = DecodeLimits{}.objects,
                                .header_bytes = DecodeLimits{}.header_bytes,
                                .packet_bytes = DecodeLimits{}.packet_bytes,
                                .vertices = DecodeLimits{}.vertices,
                                .triangles = DecodeLimits{}.triangles,
                                .state_bytes = DecodeLimits{}.state_bytes,
                                .basis_work = DecodeLimits{}.basis_work};

Result<const Scene*> scene_of(const tactus_scene* scene) noexcept {
  if (scene == nullptr || !scene->shared) return refuse();
  return scene->shared.get();
}

Result<const RigidObject*> rigid_of(const tactus_scene* scene, std::uint32_t object) noexcept {
  TACTUS_TRY(const Scene* of, scene_of(scene));
  if (object >= of->objects.size()) return refuse();
  return &of->objects[object];
}

Result<const DeformableObject*> deformable_of(const tactus_scene* scene, std::uint32_t object) noexcept {
  TACTUS_TRY(const Scene* of, scene_of(scene));
  if (object >= of->deformables.size()) return refuse();
  return &of->deformables[object];
}

tactus_scene_info info_of(const Scene& scene) noexcept {
  return {.size = 0,
          .tick_rate = scene.tick_rate,
          .rigid = static_cast<std::uint32_t>(scene.objects.size()),
          .deformables = static_cast<std::uint32_t>(scene.deformables.size()),
          .substreams = static_cast<std::uint32_t>(substreams_of(scene)),
          .position_exp = scene.grid.position,
          .extrapolation = scene.max_extrapolation,
          .baselines = scene.baseline_span,
          .smoothed = scene.is_smoothed,
          .has_bounds = scene.bounds.has_value(),
          .has_loads = scene.loads.has_value(),
          .load_users = scene.loads ? scene.loads->users : 0u,
          .interest_full = scene.interest ? std::ldexp(scene.interest->full, -scene.grid.position) : 0,
          .interest_reach = scene.interest ? std::ldexp(scene.interest->reach, -scene.grid.position) : 0};
}

}  // namespace

template <>
tactus_limits defaults<tactus_limits>() noexcept {
  return kLimits;
}

Result<DecodeLimits> limits_of(const tactus_limits* limits) noexcept {
  TACTUS_TRY(const tactus_limits l, given_or(limits, kLimits));
  return DecodeLimits{.objects = l.objects,
                      .header_bytes = l.header_bytes,
                      .packet_bytes = l.packet_bytes,
                      .vertices = l.vertices,
                      .triangles = l.triangles,
                      .state_bytes = l.state_bytes,
                      .basis_work = l.basis_work,
                      .thesis = thesis_if_built()};
}

std::uint32_t kind_of(const Scene& scene, std::size_t substream) noexcept {
  if (substream == 0) return TACTUS_KIND_RIGID;
  return is_of_deformable(scene, substream) ? TACTUS_KIND_DEFORMABLE : TACTUS_KIND_LOAD;
}

}  // namespace tactus::c

using namespace tactus;
using namespace tactus::c;

tactus_status tactus_scene_parse(const uint8_t* bytes, size_t size, const tactus_limits* limits, tactus_scene** scene,
                                 size_t* used, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    if (scene == nullptr) return refuse();
    TACTUS_TRY(const auto input, span_of(bytes, size));
    TACTUS_TRY(const DecodeLimits most, limits_of(limits));
    TACTUS_TRY(ParsedScene parsed, parse_scene(input, most));
    *scene = new tactus_scene{std::move(parsed.scene)};
    if (used != nullptr) *used = parsed.size;
    return TACTUS_OK;
  });
}

tactus_status tactus_scene_write(const tactus_scene* scene, uint8_t* bytes, size_t capacity, size_t* size, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    TACTUS_TRY(const Scene* of, scene_of(scene));
    TACTUS_TRY(const std::vector<std::uint8_t> written, write_scene(*of));
    return copy_out(std::span(written), bytes, capacity, size);
  });
}

void tactus_scene_destroy(tactus_scene* scene) { delete scene; }

tactus_status tactus_scene_get(const tactus_scene* scene, tactus_scene_info* info, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    TACTUS_TRY(const Scene* of, scene_of(scene));
    TACTUS_CHECK(check_answer(info));
    answer(info, info_of(*of));
    return TACTUS_OK;
  });
}

tactus_status tactus_scene_get_rigid(const tactus_scene* scene, uint32_t object, tactus_rigid_info* info, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    TACTUS_TRY(const RigidObject* of, rigid_of(scene, object));
    TACTUS_CHECK(check_answer(info));
    answer(info, {.size = 0,
                  .dof = of->dof,
                  .name = of->name.c_str(),
                  .initial = pose_of(to_pose(of->initial, scene->shared->grid.position))});
    return TACTUS_OK;
  });
}

tactus_status tactus_scene_get_deformable(const tactus_scene* scene, uint32_t object, tactus_deformable_info* info,
                                          tactus_error* error) {
  return call(error, [&]() -> Outcome {
    TACTUS_TRY(const DeformableObject* of, deformable_of(scene, object));
    TACTUS_CHECK(check_answer(info));
    const std::size_t modes = of->spring_basis.modes > 0 ? of->spring_basis.modes : of->basis.steps.size();
    answer(info, {.size = 0,
                  .vertices = static_cast<std::uint32_t>(of->rest.size()),
                  .triangles = static_cast<std::uint32_t>(of->triangles.size()),
                  .profile = static_cast<std::uint32_t>(of->profile),
                  .layered = of->layered,
                  .modes = static_cast<std::uint32_t>(modes),
                  .frame_period = of->frame_period / 256.0,
                  .name = of->name.c_str(),
                  .rings = of->rings,
                  .clusters = of->cluster_basis.count,
                  .blend = of->cluster_basis.blend,
                  .has_stiffness = !of->stiffness.empty()});
    return TACTUS_OK;
  });
}

tactus_status tactus_scene_get_mesh(const tactus_scene* scene, uint32_t object, const tactus_mesh_arrays* arrays,
                                    tactus_error* error) {
  return call(error, [&]() -> Outcome {
    TACTUS_TRY(const DeformableObject* of, deformable_of(scene, object));
    if (arrays == nullptr) return refuse();
    TACTUS_TRY(const tactus_mesh_arrays to, given_or(arrays, tactus_mesh_arrays{}));
    const std::vector<std::uint8_t>& clusters = of->cluster_basis.clusters;
    if ((to.stiffness != nullptr && of->stiffness.empty()) || (to.clusters != nullptr && clusters.empty())) return TACTUS_NOTHING;
    const bool wants_vertices = to.rest != nullptr || to.stiffness != nullptr || to.clusters != nullptr;
    if ((wants_vertices && to.vertices < of->rest.size()) || (to.corners != nullptr && to.triangles < of->triangles.size()))
      return TACTUS_BUFFER_TOO_SMALL;
    if (to.rest != nullptr) metres_of(of->rest, scene->shared->grid.position, to.rest);
    if (std::uint32_t* out = to.corners; out != nullptr)
      for (const Triangle& triangle : of->triangles) out = std::ranges::copy(triangle, out).out;
    if (double* out = to.stiffness; out != nullptr)
      for (const std::uint8_t level : of->stiffness)
        *out++ = level == 0 ? std::numeric_limits<double>::infinity() : stiffness_of_level(level);
    if (to.clusters != nullptr) std::ranges::copy(clusters, to.clusters);
    return TACTUS_OK;
  });
}

tactus_status tactus_scene_get_bounds(const tactus_scene* scene, tactus_rigid_bounds* rigid, uint32_t object,
                                      tactus_deformable_bounds* deformable, tactus_load_bounds* load, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    TACTUS_TRY(const Scene* of, scene_of(scene));
    if (rigid != nullptr) TACTUS_CHECK(check_answer(rigid));
    if (deformable != nullptr) {
      TACTUS_CHECK(deformable_of(scene, object));
      TACTUS_CHECK(check_answer(deformable));
    }
    if (load != nullptr) TACTUS_CHECK(check_answer(load));
    const auto& bounds = of->bounds;
    if (!bounds || (rigid != nullptr && !bounds->rigid) || (load != nullptr && !bounds->loads)) return TACTUS_NOTHING;
    if (rigid != nullptr) answer(rigid, bounds_of(*bounds->rigid));
    if (deformable != nullptr) answer(deformable, bounds_of(bounds->deformables[object]));
    if (load != nullptr) answer(load, bounds_of(*bounds->loads));
    return TACTUS_OK;
  });
}
