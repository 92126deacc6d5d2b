// SPDX-License-Identifier: Apache-2.0
/// A strip of 24 vertices as a stream's only mesh.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include <tactus/deformable/displacement.h>
#include <tactus/deformable/encoder.h>
#include <tactus/deformable/graph.h>
#include <tactus/scene/scene_syntax.h>

namespace tactus {

/// in   choice  bits: 1 profile thesis, 2 models kept (thesis) or a basis (main), 4 several baselines, 128 halves (main)
inline StreamHeader strip(std::uint8_t choice) {
  TriMesh shape;
  for (std::uint32_t i = 0; i < 24; ++i) shape.vertices.push_back({0.01 * (i / 2), 0.01 * (i % 2), 0});
  for (std::uint32_t i = 0; i + 2 < 24; ++i)
    shape.triangles.push_back(i % 2 == 0 ? Triangle{i, i + 1, i + 2} : Triangle{i + 1, i, i + 2});
  StreamHeader header;
  header.tick_rate = 60;
  DeformableObject mesh = make_deformable_object("m", shape, header.grid.position).value();
  if (choice & 1) mesh.profile = DeformableProfile::thesis;
  mesh.models_kept = (choice & 2) != 0;
  if ((choice & 3) == 2) {
    std::vector<double> ramp(72);
    for (std::size_t i = 0; i < ramp.size(); ++i) ramp[i] = static_cast<double>(i) - 20;
    mesh.basis = make_mode_basis(ramp, 1).value();
  }
  if (choice & 4) header.baseline_span = 5;
  mesh.split = (choice & 129) == 128;
  header.meshes.push_back(mesh);
  return header;
}

/// What main promises for each vertex (mesh_encoder.h) [m].
inline std::vector<double> strip_bounds(const StreamHeader& header, const DeformableThresholds& t,
                                        const std::optional<SurfaceTouch>& touch) {
  const DeformableObject& mesh = header.meshes[0];
  const double rounding = 0.8660255 * std::ldexp(1.0, -int{header.grid.position});
  std::vector<double> bound(mesh.rest.size(), std::max(t.visual, rounding));
  if (!touch || !t.weber_fraction) return bound;
  const double h = *t.weber_fraction * std::max(touch->force / touch->stiffness, t.depth_floor);
  Rings rings(mesh);
  rings.triangles_around(touch->triangle, mesh.rings);
  for (const std::uint32_t v : rings.vertices()) bound[v] = std::max(std::min(t.visual, h), rounding);
  return bound;
}

}  // namespace tactus
