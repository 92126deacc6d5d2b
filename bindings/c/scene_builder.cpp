// SPDX-License-Identifier: Apache-2.0
#include <tactus/deformable/motion_clusters.h>
#include <tactus/scene/scene_builder.h>
#include <tactus/thesis/if_built.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "bounds.h"
#include "handles.h"

struct tactus_scene_builder {
  tactus::SceneBuilder builder;
  std::string culprit{}, detail{};
  tactus::DecodeLimits limits{.thesis = tactus::thesis_if_built()};
};

namespace tactus::c {
namespace {

static_assert(TACTUS_DOF_X == Dof::x && TACTUS_DOF_Y == Dof::y && TACTUS_DOF_Z == Dof::z && TACTUS_DOF_RX == Dof::rx &&
              TACTUS_DOF_RY == Dof::ry && TACTUS_DOF_RZ == Dof::rz && TACTUS_DOF_ALL == Dof::all);

static_assert(TACTUS_PROFILE_THESIS == static_cast<int>(RigidProfile::thesis) &&
              TACTUS_PROFILE_MAIN == static_cast<int>(RigidProfile::main) &&
              TACTUS_PROFILE_THESIS == static_cast<int>(DeformableProfile::thesis) &&
              TACTUS_PROFILE_MAIN == static_cast<int>(DeformableProfile::main));

constexpr tactus_rigid_options kRigidOptions{
    .size = sizeof(tactus_rigid_options), .dof = TACTUS_DOF_ALL, .initial = {{0, 0, 0}, {1, 0, 0, 0}}, .driven = nullptr};

constexpr tactus_scene_options kSceneOptions{.size = sizeof(tactus_scene_options),
                                             .tick_rate = 1000,
                                             .position_exp = GridExponents{}.position,
                                             .velocity_exp = GridExponents{}.velocity,
                                             .rotation_exp = GridExponents{}.rotation,
                                             .angular_velocity_exp = GridExponents{}.angular_velocity,
                                             .baselines = 1,
                                             .rigid_profile = TACTUS_PROFILE_MAIN,
                                             .has_loads = 0,
                                             .load_users = LoadSpec{}.users,
                                             .force_exp = LoadSpec{}.force_exp,
                                             .reserved = 0,
                                             .extrapolation = 2,
                                             .gravity = {},
                                             .friction = 0,
                                             .interest_full = 0,
                                             .interest_reach = 0,
                                             .world_size = 0,
                                             .limits = nullptr};

constexpr double kChosen = -1;
constexpr std::size_t kMostShapes = 1 << 16;  ///< to find clusters on

tactus_deformable_options deformable_options() noexcept {
  const DeformableCoding coding;
  return {.size = sizeof(tactus_deformable_options),
          .profile = static_cast<std::uint32_t>(coding.profile),
          .rings = coding.rings,
          .quant_bits = coding.quant_bits,
          .models_kept = coding.models_kept,
          .layered = coding.layered,
          .weight_sets = coding.weight_sets,
          .spring_modes = coding.spring_basis.modes,
          .frame_period = coding.frame_period,
          .fade = kChosen,
          .fixed = nullptr,
          .fixed_count = 0,
          .vectors = nullptr,
          .modes = 0,
          .stiffness = nullptr,
          .stiffness_count = 0,
          .clusters = nullptr,
          .cluster_count = 0,
          .blend = 0,
          .elastic = nullptr};
}

constexpr tactus_driven_physics kDrivenPhysics{.size = sizeof(tactus_driven_physics),
                                               .reserved = 0,
                                               .mass = 0,
                                               .inertia = {},
                                               .stiffness = 0,
                                               .hold = 0,
                                               .friction = 0,
                                               .damping = 0};

constexpr tactus_elastic_physics kElasticPhysics{.size = sizeof(tactus_elastic_physics),
                                                 .material_count = 0,
                                                 .materials = nullptr,
                                                 .inner = nullptr,
                                                 .inner_count = 0,
                                                 .tets = nullptr,
                                                 .tet_count = 0,
                                                 .material = nullptr,
                                                 .fixed = nullptr,
                                                 .fixed_count = 0,
                                                 .mass_damping = 0,
                                                 .stiffness_damping = 0,
                                                 .gravity = {},
                                                 .coupling = 0,
                                                 .friction = 0,
                                                 .method = TACTUS_METHOD_BACKWARD_EULER,
                                                 .sub_steps = 1};

bool are_bytes(std::initializer_list<std::uint32_t> values) noexcept {
  return std::ranges::all_of(values, [](std::uint32_t value) { return value <= 0xff; });
}

/// Options that the builder takes as they are; it checks them.
void apply(const tactus_scene_options& o, SceneBuilder& builder) {
  builder
      .grid({.position = static_cast<std::uint8_t>(o.position_exp),
             .velocity = static_cast<std::uint8_t>(o.velocity_exp),
             .rotation = static_cast<std::uint8_t>(o.rotation_exp),
             .angular_velocity = static_cast<std::uint8_t>(o.angular_velocity_exp)})
      .extrapolate(o.extrapolation)
      .baselines(static_cast<std::uint8_t>(o.baselines))
      .rigid_profile(static_cast<RigidProfile>(o.rigid_profile))
      .motion({.gravity = vec_of(o.gravity), .friction = o.friction});
  if (o.world_size != 0) builder.world_size(o.world_size);
  if (o.interest_full != 0 || o.interest_reach != 0) builder.interest(o.interest_full, o.interest_reach);
  if (o.has_loads != 0)
    builder.loads({.force_exp = static_cast<std::uint8_t>(o.force_exp), .users = static_cast<std::uint8_t>(o.load_users)});
}

/// err  R-SRF-14 too large; R-API-12 null; the other R-SRF rules
Result<TriMesh> mesh_of(const double* points, std::size_t point_count, const std::uint32_t* triangles,
                        std::size_t triangle_count) {
  if (point_count > kMaxMeshVertices || triangle_count > kMaxMeshTriangles) return fail(Errc::limit_exceeded, "R-SRF-14");
  TACTUS_TRY(const auto vertices, span_of(points, 3 * point_count));
  TACTUS_TRY(const auto corners, span_of(triangles, 3 * triangle_count));
  TriMesh mesh;
  mesh.vertices.reserve(vertices.size() / 3);
  for (std::size_t i = 0; i < vertices.size(); i += 3) mesh.vertices.push_back({vertices[i], vertices[i + 1], vertices[i + 2]});
  mesh.triangles.reserve(corners.size() / 3);
  for (std::size_t i = 0; i < corners.size(); i += 3) mesh.triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
  if (const auto sound = check(mesh); !sound) return tl::make_unexpected(sound.error().error);
  return mesh;
}

/// err  R-SRF rules; R-API-4 an option is out of range; R-API-1, 9 the basis
Result<DeformableCoding> coding_of(const tactus_deformable_options& o, std::size_t vertices) {
  if (o.profile > TACTUS_PROFILE_MAIN || !are_bytes({o.rings, o.quant_bits, o.weight_sets, o.spring_modes, o.blend}) ||
      !std::isfinite(o.frame_period) || !(o.frame_period > 0))
    return fail(Errc::invalid_argument, "R-API-4");
  TACTUS_TRY(const auto fixed, span_of(o.fixed, o.fixed_count));
  TACTUS_TRY(const auto stiffness, span_of(o.stiffness, o.stiffness_count));
  if (stiffness.size() > vertices || fixed.size() > vertices) return fail(Errc::invalid_argument, "R-API-5");
  if (o.modes > ModeBasis::kMaxModes) return fail(Errc::invalid_argument, "R-API-9");
  if (o.cluster_count > ClusterBasis::kMaxClusters) return fail(Errc::invalid_argument, "R-API-4");
  TACTUS_TRY(const auto vectors, span_of(o.vectors, o.modes * vertices * 3));
  DeformableCoding out{
      .profile = static_cast<DeformableProfile>(o.profile),
      .rings = static_cast<std::uint8_t>(o.rings),
      .quant_bits = static_cast<std::uint8_t>(o.quant_bits),
      .models_kept = o.models_kept != 0,
      .frame_period = o.frame_period,
      .layered = o.layered != 0,
      .fade = o.fade == kChosen ? std::nullopt : std::optional(o.fade),
      .weight_sets = static_cast<std::uint8_t>(o.weight_sets),
      .basis = {},
      .spring_basis = {.modes = static_cast<std::uint8_t>(o.spring_modes), .fixed = {fixed.begin(), fixed.end()}},
      .stiffness = {stiffness.begin(), stiffness.end()}};
  if (o.modes > 0) {
    TACTUS_TRY(out.basis, make_mode_basis(vectors, o.modes));
  }
  if (o.cluster_count > 0) {
    TACTUS_TRY(const auto clusters, span_of(o.clusters, vertices));
    out.cluster_basis = {.count = static_cast<std::uint8_t>(o.cluster_count),
                         .blend = static_cast<std::uint8_t>(o.blend),
                         .clusters = {clusters.begin(), clusters.end()}};
  }
  return out;
}

/// err  R-ELA-1, 5 an unknown method, sub-steps; R-ELA-2, 3 there is too much of it; R-API-12 null
Result<ElasticPhysics> physics_of(const tactus_elastic_physics& p) {
  if (p.method < TACTUS_METHOD_BACKWARD_EULER || p.method > TACTUS_METHOD_VELOCITY_VERLET) return fail(Errc::invalid, "R-ELA-1");
  if (p.sub_steps > ElasticBody::kMostSubSteps) return fail(Errc::invalid, "R-ELA-5");
  if (p.material_count > ElasticBody::kMaxMaterials) return fail(Errc::invalid, "R-ELA-2");
  if (p.inner_count > kMaxMeshVertices || p.fixed_count > kMaxMeshVertices || p.tet_count > kMaxMeshTriangles)
    return fail(Errc::invalid, "R-ELA-3");
  TACTUS_TRY(const auto materials, span_of(p.materials, std::size_t{3} * p.material_count));
  TACTUS_TRY(const auto inner, span_of(p.inner, 3 * p.inner_count));
  TACTUS_TRY(const auto corners, span_of(p.tets, 4 * p.tet_count));
  TACTUS_TRY(const auto fixed, span_of(p.fixed, p.fixed_count));
  ElasticPhysics out{.body = {.inner = {},
                              .tets = {},
                              .materials = {},
                              .material = std::vector<std::uint8_t>(p.tet_count),
                              .fixed = {fixed.begin(), fixed.end()},
                              .mass_damping = p.mass_damping,
                              .stiffness_damping = p.stiffness_damping,
                              .gravity = vec_of(p.gravity),
                              .coupling = p.coupling,
                              .friction = p.friction,
                              .method = static_cast<ElasticBody::Method>(p.method),
                              .sub_steps = static_cast<std::uint8_t>(p.sub_steps)}};
  if (p.material != nullptr) std::copy_n(p.material, p.tet_count, out.body.material.begin());
  for (std::size_t i = 0; i < materials.size(); i += 3)
    out.body.materials.push_back({materials[i], materials[i + 1], materials[i + 2]});
  for (std::size_t i = 0; i < inner.size(); i += 3) out.inner.push_back({inner[i], inner[i + 1], inner[i + 2]});
  out.body.tets.reserve(p.tet_count);
  for (std::size_t i = 0; i < corners.size(); i += 4)
    out.body.tets.push_back({corners[i], corners[i + 1], corners[i + 2], corners[i + 3]});
  return out;
}

}  // namespace

template <>
tactus_scene_options defaults<tactus_scene_options>() noexcept {
  return kSceneOptions;
}
template <>
tactus_rigid_options defaults<tactus_rigid_options>() noexcept {
  return kRigidOptions;
}
template <>
tactus_deformable_options defaults<tactus_deformable_options>() noexcept {
  return deformable_options();
}
template <>
tactus_driven_physics defaults<tactus_driven_physics>() noexcept {
  return kDrivenPhysics;
}
template <>
tactus_elastic_physics defaults<tactus_elastic_physics>() noexcept {
  return kElasticPhysics;
}

}  // namespace tactus::c

using namespace tactus;
using namespace tactus::c;

tactus_status tactus_scene_builder_create(const tactus_scene_options* options, tactus_scene_builder** builder,
                                          tactus_error* error) {
  return call(error, [&]() -> Outcome {
    if (builder == nullptr) return refuse();
    TACTUS_TRY(const tactus_scene_options o, given_or(options, kSceneOptions));
    if (o.rigid_profile > TACTUS_PROFILE_MAIN) return fail(Errc::invalid_argument, "R-API-4");
    if (!are_bytes(
            {o.position_exp, o.velocity_exp, o.rotation_exp, o.angular_velocity_exp, o.baselines, o.load_users, o.force_exp}))
      return fail(Errc::invalid_argument, "R-API-4");
    auto made = std::make_unique<tactus_scene_builder>(tactus_scene_builder{SceneBuilder(o.tick_rate)});
    apply(o, made->builder);
    TACTUS_TRY(made->limits, limits_of(o.limits));
    *builder = made.release();
    return TACTUS_OK;
  });
}

void tactus_scene_builder_destroy(tactus_scene_builder* builder) { delete builder; }

tactus_status tactus_scene_builder_rigid(tactus_scene_builder* builder, const char* name, const tactus_rigid_options* options,
                                         tactus_error* error) {
  return call(error, [&]() -> Outcome {
    if (builder == nullptr || name == nullptr) return refuse();
    TACTUS_TRY(const tactus_rigid_options o, given_or(options, kRigidOptions));
    if (o.dof > Dof::all) return fail(Errc::invalid_argument, "R-API-4");
    RigidOptions chosen{.dof = static_cast<std::uint8_t>(o.dof)};
    if (o.driven != nullptr) {
      TACTUS_TRY(const tactus_driven_physics p, given_or(o.driven, kDrivenPhysics));
      chosen.driven = DrivenPhysics{.mass = p.mass,
                                    .inertia = vec_of(p.inertia),
                                    .stiffness = p.stiffness,
                                    .hold = p.hold,
                                    .friction = p.friction,
                                    .damping = p.damping};
    }
    builder->builder.rigid(name, pose_of(o.initial), chosen);
    return TACTUS_OK;
  });
}

tactus_status tactus_scene_builder_deformable(tactus_scene_builder* builder, const char* name, const double* vertices,
                                              size_t vertex_count, const uint32_t* triangles, size_t triangle_count,
                                              const tactus_deformable_options* options, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    if (builder == nullptr || name == nullptr) return refuse();
    TACTUS_TRY(TriMesh mesh, mesh_of(vertices, vertex_count, triangles, triangle_count));
    TACTUS_TRY(const tactus_deformable_options o, given_or(options, deformable_options()));
    TACTUS_TRY(DeformableCoding coding, coding_of(o, vertex_count));
    if (o.elastic != nullptr) {
      TACTUS_TRY(const tactus_elastic_physics p, given_or(o.elastic, kElasticPhysics));
      TACTUS_TRY(coding.elastic, physics_of(p));
    }
    builder->builder.deformable(name, std::move(mesh), std::move(coding));
    return TACTUS_OK;
  });
}

tactus_status tactus_find_clusters(const double* vertices, size_t vertex_count, const uint32_t* triangles, size_t triangle_count,
                                   const float* shapes, size_t shape_count, uint32_t most, uint8_t* clusters, uint32_t* count,
                                   uint32_t* blend, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    if (clusters == nullptr || count == nullptr || blend == nullptr) return refuse();
    TACTUS_TRY(const TriMesh mesh, mesh_of(vertices, vertex_count, triangles, triangle_count));
    if (shape_count > kMostShapes) return fail(Errc::invalid_argument, "R-API-5");
    const std::size_t width = 3 * vertex_count;
    TACTUS_TRY(const auto numbers, span_of(shapes, shape_count * width));
    std::vector<std::vector<float>> given;
    for (std::size_t i = 0; i < shape_count; ++i) {
      const auto shape = numbers.subspan(i * width, width);
      given.emplace_back(shape.begin(), shape.end());
    }
    TACTUS_TRY(const ClusterBasis found, motion_clusters(mesh, given, most));
    std::ranges::copy(found.clusters, clusters);
    *count = found.count;
    *blend = found.blend;
    return TACTUS_OK;
  });
}

tactus_status tactus_scene_builder_declare_bounds(tactus_scene_builder* builder, const tactus_rigid_bounds* rigid,
                                                  const tactus_deformable_bounds* deformable, const tactus_load_bounds* load,
                                                  tactus_error* error) {
  return call(error, [&]() -> Outcome {
    if (builder == nullptr) return refuse();
    TACTUS_TRY(const RigidTriggers triggers, bounds_of(rigid));
    TACTUS_TRY(const DeformableThresholds thresholds, bounds_of(deformable));
    TACTUS_TRY(const LoadThresholds loads, bounds_of(load));
    builder->builder.declare_bounds(triggers, thresholds, loads);
    return TACTUS_OK;
  });
}

tactus_status tactus_scene_builder_build(tactus_scene_builder* builder, tactus_scene** scene, tactus_error* error) {
  const tactus_status status = call(error, [&]() -> Outcome {
    if (builder == nullptr || scene == nullptr) return refuse();
    auto built = builder->builder.build(builder->limits);
    builder->culprit.clear();
    builder->detail.clear();
    if (!built) {
      builder->culprit = std::move(built.error().object);
      builder->detail = std::move(built.error().detail);
      return tl::make_unexpected(built.error().error);
    }
    *scene = new tactus_scene{*std::move(built)};
    return TACTUS_OK;
  });
  if (status != TACTUS_OK && builder != nullptr && error != nullptr) {
    error->object = builder->culprit.c_str();
    error->detail = builder->detail.c_str();
  }
  return status;
}
