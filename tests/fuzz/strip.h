// SPDX-License-Identifier: Apache-2.0
/// A strip of 24 vertices as a scene's only deformable object.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include <tactus/deformable/displacement.h>
#include <tactus/mesh/graph.h>
#include <tactus/scene/scene.h>
#include <tactus/thesis/thesis.h>

namespace tactus {

/// Limits of those who make a scene of it, or decode one.
inline constexpr DecodeLimits kStripLimits{.thesis = &thesis_component};

/// in   choice  bits: 1 profile thesis, 2 models kept (thesis) or a basis (main), 4 several baselines, 8 clusters (main, in place of a basis), 128 layered (main)
inline SceneSpec strip(std::uint8_t choice) {
  TriMesh shape;
  for (std::uint32_t i = 0; i < 24; ++i) shape.vertices.push_back({0.01 * (i / 2), 0.01 * (i % 2), 0});
  for (std::uint32_t i = 0; i + 2 < 24; ++i)
    shape.triangles.push_back(i % 2 == 0 ? Triangle{i, i + 1, i + 2} : Triangle{i + 1, i, i + 2});
  SceneSpec spec;
  spec.tick_rate = 60;
  DeformableObject object = make_deformable_object("m", shape, spec.grid.position).value();
  if (choice & 1) object.profile = DeformableProfile::thesis;
  object.models_kept = (choice & 2) != 0;
  if ((choice & 9) == 8) {
    object.cluster_basis = {3, 2, {}};
    for (std::uint8_t v = 0; v < 24; ++v) object.cluster_basis.clusters.push_back(v / 8);
    object.fade = 7000;
  } else if ((choice & 3) == 2) {
    std::vector<double> ramp(72);
    for (std::size_t i = 0; i < ramp.size(); ++i) ramp[i] = static_cast<double>(i) - 20;
    object.basis = make_mode_basis(ramp, 1).value();
  }
  if (choice & 4) spec.baseline_span = 5;
  object.layered = (choice & 129) == 128;
  spec.deformables.push_back(std::move(object));
  return spec;
}

/// What main guarantees for each vertex (main_encoder.h) [m].
inline std::vector<double> strip_bounds(const SceneSpec& spec, const DeformableThresholds& t,
                                        const std::optional<SurfaceTouch>& touch) {
  const DeformableObject& object = spec.deformables[0];
  const double rounding = 0.8660255 * std::ldexp(1.0, -int{spec.grid.position});
  std::vector<double> bound(object.rest.size(), std::max(t.visual, rounding));
  if (!touch || !t.weber_fraction) return bound;
  const double h = haptic_threshold(t, *touch);
  Rings rings(object);
  rings.triangles_around(touch->triangle, object.rings);
  for (const std::uint32_t v : rings.vertices()) bound[v] = std::max(std::min(t.visual, h), rounding);
  return bound;
}

}  // namespace tactus
