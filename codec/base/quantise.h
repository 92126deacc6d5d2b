// SPDX-License-Identifier: Apache-2.0
/// From SI units to a fixed-point grid. Internal to the library.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <tactus/base/fixed.h>
#include <tactus/base/geometry.h>
#include <tactus/base/rule.h>

namespace tactus {

/// floor(v) of a value within +-2^31; the library's std::floor() is a call on machines without SSE4.
inline std::int32_t floor32(double v) noexcept {
  const auto towards_zero = static_cast<std::int64_t>(v);
  return static_cast<std::int32_t>(towards_zero - (v < static_cast<double>(towards_zero) ? 1 : 0));
}

/// floor(v * 2^exp + 1/2); false when that is not within +-limit, or v is not finite.   pre  limit is an integer <= 2^31 - 1
inline bool quantise(double v, unsigned exp, double limit, std::int32_t& out) noexcept {
  const double scaled = v * static_cast<double>(std::uint64_t{1} << exp) + 0.5;
  if (!(scaled >= -limit && scaled < limit + 1)) return false;
  out = floor32(scaled);
  return true;
}

/// A pose on the grid, or the rule that it breaks: R-API-1, R-API-2 or R-API-3 as of to_grid().
inline RuleName quantise(const Pose& pose, unsigned exp, std::array<std::int32_t, 3>& position,
                         std::array<std::int32_t, 4>& rotation) noexcept {
  const Vec3& p = pose.position;
  const Quat& q = pose.rotation;
  if (!is_finite(p) || !is_finite(q)) return "R-API-1";
  constexpr double kLimit = 2147483647.0;
  if (!quantise(p.x, exp, kLimit, position[0]) || !quantise(p.y, exp, kLimit, position[1]) ||
      !quantise(p.z, exp, kLimit, position[2]))
    return "R-API-2";
  const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  if (!(std::abs(length - 1) <= 1e-3)) return "R-API-3";
  const double scale = static_cast<double>(kOne30) / length;
  const double components[] = {q.w, q.x, q.y, q.z};
  for (std::size_t i = 0; i < 4; ++i) rotation[i] = std::min(floor32(components[i] * scale + 0.5), kOne30);
  return {};
}

}  // namespace tactus
