// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/trace_scene.h>

#include <utility>

#include <tactus/base/rule.h>

namespace tactus {

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
    scene.rigid(info.objects[i].name, first.objects[i].pose, info.objects[i].dof);
  for (const TraceDeformable& mesh : info.meshes) TACTUS_CHECK(add_deformable(scene, mesh, coding));
  return scene;
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

Result<SceneBuilder> scene_builder(const TraceInfo& info, const TraceFrame& first, const TraceCoding& coding,
                                   const SenderOptions& sender) {
  TACTUS_TRY(SceneBuilder scene, scene_builder(info, first, coding));
  scene.promise(sender.triggers, sender.deformable.thresholds, sender.load);
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

}  // namespace tactus
