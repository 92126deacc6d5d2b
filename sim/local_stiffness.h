// SPDX-License-Identifier: Apache-2.0
/// k_o, the stiffness with which an object answers where a probe touches it, and the share of the probe's way that it follows.
/// Thesis 4.3.3.2, eq. 4.54.
#pragma once

#include <optional>
#include <vector>

#include <tactus/rigid/contact.h>
#include <tactus/sim/deformable/stiffness_map.h>
#include <tactus/sim/scene/scene.h>
#include <tactus/trace/frame.h>

namespace tactus::sim {

/// Of all objects of a scene.
class LocalStiffness {
 public:
  /// pre  the scene outlives this.   time one stiffness_map() for each deformable object   err  of stiffness_map()
  static Result<LocalStiffness> create(const Scene& scene);

  /// [N/m] of a deformable object; infinite where it is fixed.   time O(1), no allocation, as below
  double at(const SurfaceContact& contact) const noexcept { return maps_[contact.mesh].at(contact.triangle, contact.weights); }
  /// [N/m] of a one-dimensional object; none: it is rigid.
  std::optional<double> at(const Contact& contact) const noexcept;

 private:
  explicit LocalStiffness(const Scene& scene) : scene_(&scene) {}

  const Scene* scene_;
  std::vector<StiffnessMap> maps_;  // one per deformable object
};

/// K: share of the device's way that an object of k_o follows behind a coupling k, both in N/m.
constexpr double share_followed(double object, double coupling) noexcept { return coupling / (object + coupling); }

}  // namespace tactus::sim
