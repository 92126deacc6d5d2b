// SPDX-License-Identifier: Apache-2.0
/// Displacements of vertices from metres to the grid and back. spec/25-packet.md section 1.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include <tactus/base/geometry.h>
#include <tactus/base/result.h>
#include <tactus/scene/deformable_object.h>

namespace tactus {

constexpr std::int32_t limited_displacement(std::int64_t v) noexcept {
  return static_cast<std::int32_t>(
      std::clamp<std::int64_t>(v, -DeformableObject::kMaxDisplacement, DeformableObject::kMaxDisplacement));
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
