// SPDX-License-Identifier: Apache-2.0
/// When is a vertex worth sending? Visual and haptic thresholds (thesis eqs. 3.10 to 3.12). Informative: an encoder's choice.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>

#include <tactus/scene/bounds.h>

namespace tactus {

/// Where and how hard a user touches a deformable object at one tick.
struct SurfaceTouch {
  std::uint32_t triangle = 0;  ///< nearest to the virtual proxy: the middle of the area of interest
  double force = 0;            ///< [N] |f_s|, rendered at the server
  double stiffness = 500;      ///< [N/m] k_c of the client's rendering, > 0
};

/// h = p |f_s| / k_c [m], thesis eq. 3.12.   pre  t.weber_fraction is set
inline double haptic_threshold(const DeformableThresholds& t, const SurfaceTouch& touch) noexcept {
  return *t.weber_fraction * std::max(touch.force / touch.stiffness, t.depth_floor);
}

/// A deformable object at one frame.
struct DeformableTruth {
  std::span<const float> displacements{};  ///< V x 3 [m] from the rest shape, x y z of vertex 0 first; empty: no new shape
  std::optional<SurfaceTouch> touch{};
};

struct DeformableOptions {
  DeformableThresholds thresholds{};
  /// main: an error of v calls for a packet, which then corrects all errors above this share of v. Less error and fewer packets, but
  /// more bits. 0.001 <= share <= 1; not set: 1, but 0.7 for shapes that follow each other within 10 ms
  std::optional<double> visual_share{};
  std::optional<double> haptic_share{};  ///< main: the same of h
  bool layered = false;  ///< thesis: separate packets for the haptic and the visual layer. main: the scene declares it
};

}  // namespace tactus
