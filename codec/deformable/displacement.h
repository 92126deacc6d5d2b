// SPDX-License-Identifier: Apache-2.0
/// Displacements of a deformable object's vertices, and when they are worth sending.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include <tactus/base/geometry.h>
#include <tactus/base/result.h>
#include <tactus/scene/scene_objects.h>

namespace tactus {

// ==== trigger ====
// When is a vertex worth sending? Visual and haptic thresholds (thesis eqs. 3.10 to 3.12). Informative: an encoder's choice.

/// Where and how hard a user touches a deformable object at one tick.
struct SurfaceTouch {
  std::uint32_t triangle = 0;  ///< nearest to the virtual proxy: the middle of the area of interest
  double force = 0;            ///< [N] |f_s|, rendered at the server
  double stiffness = 500;      ///< [N/m] k_c of the client's rendering, > 0
};

/// h = p |f_s| / k_c [m], thesis eq. 3.12.   pre  t.weber_fraction is set
inline double haptic_threshold(const DeformableThresholds& t, const SurfaceTouch& touch) noexcept {
  const double depth = touch.force / touch.stiffness;
  return *t.weber_fraction * (depth < t.depth_floor ? t.depth_floor : depth);
}

/// A deformable object at one frame.
struct DeformableTruth {
  std::span<const float> displacements{};  ///< V x 3 [m] from the rest shape, x y z of vertex 0 first; empty: no new shape
  std::optional<SurfaceTouch> touch{};
};

struct DeformableOptions {
  DeformableThresholds thresholds{};
  /// main: an error of v calls for a packet, which then corrects all errors above this fraction of v. Less error and fewer packets, but
  /// more bits. 0.001 <= fraction <= 1; not set: 1, but 0.7 for shapes that follow each other within 10 ms
  std::optional<double> visual_fraction{};
  std::optional<double> haptic_fraction{};  ///< main: the same of h
};

// ==== displacement ====
// Displacements of vertices from metres to the grid and back. spec/25-packet.md section 1.

constexpr std::int32_t limited_displacement(std::int64_t v) noexcept {
  constexpr std::int64_t kMost = DeformableObject::kMaxDisplacement;
  return static_cast<std::int32_t>(v < -kMost ? -kMost : v > kMost ? kMost : v);
}

constexpr std::int64_t squared_distance(const std::array<std::int32_t, 3>& a, const std::array<std::int32_t, 3>& b) noexcept {
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::int64_t d = std::int64_t{a[i]} - b[i];
    sum += d * d;
  }
  return sum;
}

/// in   displacements  V x 3 [m], x y z of vertex 0 first
/// out  V vectors, x 2^-position_exp m.   time O(V), no allocation.
/// err  invalid_argument R-API-1 NaN or infinite; R-API-2 beyond +-2^27 grid units; R-API-5 counts differ. `out` is then undefined.
Result<void> to_grid(std::span<const float> displacements, unsigned position_exp,
                     std::span<std::array<std::int32_t, 3>> out) noexcept;

/// Grid to metres.
inline Vec3 to_metres(const std::array<std::int32_t, 3>& v, unsigned position_exp) noexcept {
  const double unit = 1.0 / static_cast<double>(std::uint64_t{1} << position_exp);
  return {v[0] * unit, v[1] * unit, v[2] * unit};
}

}  // namespace tactus
