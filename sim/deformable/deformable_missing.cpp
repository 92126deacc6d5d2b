// SPDX-License-Identifier: Apache-2.0
// In place of deformable_objects.cpp, elastic_physics.cpp and stiffness_map.cpp when the component FEM is left out.
#include <tactus/base/rule.h>
#include <tactus/sim/deformable/deformable_objects.h>
#include <tactus/sim/deformable/elastic_physics.h>
#include <tactus/sim/deformable/stiffness_map.h>

namespace tactus::sim {

Result<std::unique_ptr<DeformableObjects>> make_deformable_objects(const Scene&, const DeformableOptions&) {
  return fail(Errc::unsupported, "R-SIM-2");
}

std::optional<ElasticPhysics> elastic_physics(const SceneDeformable&, const Vec3&, const ElasticStep&, double) {
  return std::nullopt;
}

Result<StiffnessMap> stiffness_map(const SceneDeformable&) { return fail(Errc::unsupported, "R-SIM-2"); }

Result<double> critical_stiffness(const SceneDeformable&, const SurfaceContact&) { return fail(Errc::unsupported, "R-SIM-2"); }

}  // namespace tactus::sim
