// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/local_stiffness.h>

#include <utility>

namespace tactus::sim {

Result<LocalStiffness> LocalStiffness::create(const Scene& scene) {
  LocalStiffness out(scene);
  for (const SceneDeformable& object : scene.deformables) {
    TACTUS_TRY(auto map, stiffness_map(object));
    out.maps_.push_back(std::move(map));
  }
  return out;
}

std::optional<double> LocalStiffness::at(const Contact& contact) const noexcept {
  const std::size_t rigid = scene_->objects.size();
  if (contact.object < rigid) return std::nullopt;
  return scene_->msds[contact.object - rigid].object.stiffness;
}

}  // namespace tactus::sim
