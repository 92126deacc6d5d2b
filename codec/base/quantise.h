// SPDX-License-Identifier: Apache-2.0
/// From SI units to a fixed-point grid. Internal to the library.
#pragma once

#include <cmath>
#include <cstdint>

namespace tactus {

/// floor(v * 2^exp + 1/2); false when that is not within +-limit, or v is not finite.
inline bool quantise(double v, unsigned exp, double limit, std::int32_t& out) noexcept {
  const double scaled = std::floor(v * static_cast<double>(std::uint64_t{1} << exp) + 0.5);
  if (!(scaled >= -limit && scaled <= limit)) return false;
  out = static_cast<std::int32_t>(scaled);
  return true;
}

}  // namespace tactus
