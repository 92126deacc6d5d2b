// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/pose_thresholds.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <tactus/base/fixed.h>
#include <tactus/base/rule.h>

namespace tactus {

constexpr unsigned kCoarsestLevel = 15;
constexpr double kVisualFraction = 0.18;  // of a bound may the rounding to a level use up; the rest is for the motion after it

Result<PoseThresholds> pose_thresholds(double distance, double angle, const GridExponents& grid) noexcept {
  const double unit = std::ldexp(1.0, -grid.position);
  const double turn_unit = std::ldexp(4.0, -grid.rotation);
  if (!(distance >= 8 * unit && distance < 1e6) || !(angle >= 8 * turn_unit && angle <= std::numbers::pi)) {
    return fail(Errc::invalid_argument, "R-API-4");
  }
  PoseThresholds out;
  const auto units = static_cast<std::int64_t>(std::min(distance / unit, 1073741824.0)) - 1;
  out.distance_squared = units * units;
  const auto half = static_cast<std::uint32_t>(angle / (4 * std::numbers::pi) * 4294967296.0);
  const std::int64_t sine = sin30(half) - 8;
  out.half_angle_squared = sine * sine;
  const double worst = std::sqrt(0.75);
  const auto fits = [worst](double step, double bound) { return worst * step <= kVisualFraction * bound; };
  while (out.level < kCoarsestLevel && fits(std::ldexp(unit, static_cast<int>(out.level) + 1), distance) &&
         fits(std::ldexp(turn_unit, static_cast<int>(out.level) + 1), angle)) {
    ++out.level;
  }
  return out;
}

PoseThresholds scaled(double distance, double angle, double factor, const GridExponents& grid) noexcept {
  return pose_thresholds(std::min(factor * distance, 999'999.0), std::min(factor * angle, std::numbers::pi), grid)
      .value_or(PoseThresholds{});
}

PoseThresholds scaled(PoseThresholds t, double fraction) noexcept {
  t.distance_squared = static_cast<std::int64_t>(fraction * fraction * static_cast<double>(t.distance_squared));
  t.half_angle_squared = static_cast<std::int64_t>(fraction * fraction * static_cast<double>(t.half_angle_squared));
  return t;
}

bool within(const PoseThresholds& t, const RigidPose& shown, const RigidState& truth) noexcept {
  constexpr std::int64_t kFar = 1 << 30;
  std::int64_t distance = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::int64_t d = std::clamp(static_cast<std::int64_t>(truth.position[i]) - shown.position[i], -kFar, kFar);
    distance += d * d;
  }
  if (distance > t.distance_squared) return false;
  if (shown.rotation == truth.rotation) return true;
  const Quat30 turn = multiply(truth.rotation, conjugate(shown.rotation));
  double half = 0;
  for (std::size_t i = 1; i < 4; ++i) half += static_cast<double>(turn[i]) * turn[i];
  const double length_squared = (half + static_cast<double>(turn[0]) * turn[0]) * 0x1p-60;  // 1 but for rounding
  return half <= static_cast<double>(t.half_angle_squared) * length_squared;
}

}  // namespace tactus
