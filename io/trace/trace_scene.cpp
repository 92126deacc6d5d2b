// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/trace_scene.h>

#include <algorithm>
#include <utility>
#include <vector>

#include <tactus/base/rule.h>
#include <tactus/deformable/displacement.h>
#include <tactus/deformable/motion_clusters.h>

namespace tactus {

// ==== trace scene ====

Result<void> add_deformable(SceneBuilder& scene, const TraceDeformable& mesh, const TraceCoding& coding) {
  DeformableCoding of = coding.deformable;
  of.frame_period = mesh.period;
  if (of.profile == DeformableProfile::main && coding.basis) {
    TACTUS_TRY(of.basis, coding.basis(mesh));
  }
  if (of.profile == DeformableProfile::main && coding.spring_modes > 0) {
    if (coding.spring_modes >= 3 * (mesh.rest.vertices.size() - mesh.fixed.size()))
      return fail(Errc::invalid_argument, "R-API-9");
    of.spring_basis = {coding.spring_modes, mesh.fixed};
  }
  if (const auto found = coding.clusters.find(mesh.name); of.profile == DeformableProfile::main && found != coding.clusters.end())
    of.cluster_basis = found->second;
  scene.deformable(mesh.name, mesh.rest, std::move(of));
  return {};
}

Result<SceneBuilder> scene_builder(const TraceInfo& info, const TraceFrame& first, const TraceCoding& coding) try {
  if (first.objects.size() != info.objects.size()) return fail(Errc::invalid_argument, "R-API-5");
  SceneBuilder scene(info.tick_rate);
  scene.rigid_profile(coding.rigid);
  for (std::size_t i = 0; i < info.objects.size(); ++i)
    scene.rigid(info.objects[i].name, first.objects[i].pose, {.dof = info.objects[i].dof});
  for (const TraceDeformable& mesh : info.meshes) TACTUS_CHECK(add_deformable(scene, mesh, coding));
  return scene;
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

Result<SceneBuilder> scene_builder(const TraceInfo& info, const TraceFrame& first, const TraceCoding& coding,
                                   const SenderOptions& sender) {
  TACTUS_TRY(SceneBuilder scene, scene_builder(info, first, coding));
  scene.declare_bounds(sender.triggers, sender.deformable.thresholds, sender.load);
  return scene;
}

std::optional<SurfaceTouch> touch_of(const TraceFrame& frame, std::size_t deformable) noexcept {
  std::optional<SurfaceTouch> lightest;
  for (const UserSample& user : frame.users) {
    if (!user.surface_contact || user.surface_contact->mesh != deformable) continue;
    const SurfaceContact& contact = *user.surface_contact;
    const double depth = norm(contact.proxy - user.device.position);
    if (lightest && lightest->force / lightest->stiffness <= depth) continue;
    lightest = SurfaceTouch{contact.triangle, contact.stiffness * depth, contact.stiffness};
  }
  return lightest;
}

Truth FrameTruth::of(const TraceFrame& frame) noexcept {
  for (std::size_t i = 0; i < contacts_.size(); ++i) contacts_[i] = frame.users[i].contact;
  for (std::size_t i = 0; i < deformables_.size(); ++i) {
    deformables_[i] = {};
    if (!frame.meshes[i].updated) continue;
    deformables_[i] = {frame.meshes[i].displacements, touch_of(frame, i)};
  }
  return {frame.objects, contacts_, deformables_};
}

// ==== trace clusters ====

namespace {

/// So many shapes, or up to twice as many; fewer of large meshes, which would take long.
std::size_t shapes_of(const TraceDeformable& mesh) noexcept {
  constexpr std::size_t kLeast = 4, kMostVertices = 1 << 22;
  return std::clamp(kMostVertices / mesh.rest.vertices.size(), kLeast, kClusterShapes);
}

/// Every n-th shape, n doubled as often as it must be.
class EvenShapes {
 public:
  explicit EvenShapes(std::size_t least) : least_(least) {}
  void add(const std::vector<float>& shape) {
    if (seen_++ % stride_ != 0) return;
    if (shapes_.size() == 2 * least_) {
      for (std::size_t i = 1; i < least_; ++i) shapes_[i] = std::move(shapes_[2 * i]);
      shapes_.resize(least_);
      stride_ *= 2;
    }
    shapes_.push_back(shape);
  }
  const std::vector<std::vector<float>>& shapes() const noexcept { return shapes_; }

 private:
  std::vector<std::vector<float>> shapes_;
  std::size_t least_, seen_ = 0, stride_ = 1;
};

}  // namespace

Result<std::map<std::string, ClusterBasis>> find_clusters(TraceReader& reader, std::size_t count) try {
  const std::vector<TraceDeformable>& meshes = reader.info().meshes;
  std::vector<EvenShapes> shapes;
  shapes.reserve(meshes.size());
  for (const TraceDeformable& mesh : meshes) shapes.emplace_back(shapes_of(mesh));
  TraceFrame frame;
  while (true) {
    TACTUS_TRY(const bool more, reader.next(frame));
    if (!more) break;
    for (std::size_t i = 0; i < meshes.size(); ++i)
      if (frame.meshes[i].updated) shapes[i].add(frame.meshes[i].displacements);
  }
  std::map<std::string, ClusterBasis> out;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    if (shapes[i].shapes().empty()) continue;
    TACTUS_TRY(out[meshes[i].name], motion_clusters(meshes[i].rest, shapes[i].shapes(), count));
  }
  return out;
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

// ==== trace replica ====

namespace {

void take_shape(Replica& replica, std::size_t mesh, const Scene& scene, std::int64_t tick, DeformableSample& sample) {
  sample.updated = false;
  auto out = sample.displacements.begin();
  const auto put = [&](double metres) {
    const auto value = static_cast<float>(metres);
    sample.updated = sample.updated || *out != value;
    *out++ = value;
  };
  for (const auto& displacement : replica.displacements(mesh, tick)) {
    const Vec3 u = to_metres(displacement, scene.grid.position);
    put(u.x), put(u.y), put(u.z);
  }
}

}  // namespace

TraceInfo replica_info(const Scene& scene, std::string source) {
  TraceInfo info;
  info.tick_rate = scene.tick_rate;
  info.source = std::move(source);
  for (const RigidObject& object : scene.objects) info.objects.push_back({object.name, object.dof});
  for (const DeformableObject& object : scene.deformables) {
    TraceDeformable& out = info.meshes.emplace_back(TraceDeformable{.name = object.name, .rest = {{}, object.triangles}});
    for (const auto& vertex : object.rest) out.rest.vertices.push_back(to_metres(vertex, scene.grid.position));
    out.period = object.frame_period / 256.0;
  }
  if (scene.bounds) {
    info.bounds = TraceBounds{*scene.bounds, scene.grid.position, {}};
    for (const DeformableObject& object : scene.deformables) info.bounds->rings.push_back(object.rings);
  }
  return info;
}

TraceFrame replica_frame(const Scene& scene) {
  TraceFrame frame;
  frame.objects.resize(scene.objects.size());
  for (const DeformableObject& mesh : scene.deformables)
    frame.meshes.push_back({false, std::vector<float>(3 * mesh.rest.size())});
  return frame;
}

void take_shown(Replica& replica, const Scene& scene, std::int64_t tick, TraceFrame& frame) {
  for (std::uint32_t i = 0; i < frame.objects.size(); ++i)
    frame.objects[i].pose = to_pose(replica.pose(i, tick), scene.grid.position);
  for (std::size_t i = 0; i < frame.meshes.size(); ++i) take_shape(replica, i, scene, tick, frame.meshes[i]);
}

}  // namespace tactus
