// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/trace_replica.h>

#include <utility>

#include <tactus/deformable/displacement.h>

namespace tactus {
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
