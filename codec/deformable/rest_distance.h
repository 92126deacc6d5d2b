// SPDX-License-Identifier: Apache-2.0
/// Squared distances of rest positions, on a grid so coarse that they fit 38 bits. spec/50-deformable.md section 4.2. Internal to the
/// library.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>

#include <tactus/base/fixed.h>

namespace tactus {

class RestDistance {
 public:
  explicit RestDistance(std::span<const Vec3i> rest) noexcept {
    std::uint64_t extent = 0;
    for (std::size_t axis = 0; axis < 3 && !rest.empty(); ++axis) {
      const auto [low, high] =
          std::minmax_element(rest.begin(), rest.end(), [axis](const Vec3i& a, const Vec3i& b) { return a[axis] < b[axis]; });
      extent = std::max(extent, static_cast<std::uint64_t>(static_cast<std::int64_t>((*high)[axis]) - (*low)[axis]));
    }
    const auto width = static_cast<unsigned>(std::bit_width(extent));
    shift_ = width > 18 ? width - 18 : 0;
  }
  /// At least 1. Not symmetric.
  std::uint64_t operator()(const Vec3i& a, const Vec3i& b) const noexcept {
    std::uint64_t sum = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::int64_t d = (static_cast<std::int64_t>(a[axis]) - b[axis]) >> shift_;
      sum += static_cast<std::uint64_t>(d * d);
    }
    return std::max<std::uint64_t>(sum, 1);
  }

 private:
  unsigned shift_ = 0;
};

}  // namespace tactus
