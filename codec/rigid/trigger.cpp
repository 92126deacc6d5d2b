// SPDX-License-Identifier: Apache-2.0
#include <tactus/base/elementary.h>
#include <tactus/rigid/trigger.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace tactus {

double force_budget(const RigidTriggers& triggers, double force) noexcept {
  const double counted = std::max(force, triggers.force_floor);
  if (triggers.haptic == HapticRule::perceptual) return triggers.perceptual_fraction * weber_fraction_at(counted) * counted;
  return triggers.weber_fraction * counted;
}

double haptic_ratio(const RigidTriggers& triggers, const Vec3& truth, const Vec3& estimate) noexcept {
  const double force = norm(truth);
  const double budget = force_budget(triggers, force);
  if (triggers.haptic == HapticRule::isotropic || triggers.haptic == HapticRule::perceptual)
    return norm(estimate - truth) / budget;
  if (triggers.haptic != HapticRule::cone) return 0;
  const double estimated = norm(estimate);
  const double magnitude = std::abs(estimated - force) / budget;
  if (force < triggers.force_floor || estimated < triggers.force_floor) return magnitude;
  const double cosine = dot(truth, estimate);
  const double sine = norm(cross(truth, estimate));
  const double direction = angle_of(sine, cosine) / triggers.cone_angle;
  return std::max(magnitude, direction);
}

double weber_fraction_at(double force) noexcept {
  struct Point {
    double force, fraction;
  };
  static constexpr std::array<Point, 4> kCurve{{{0.3, 0.22}, {0.5, 0.17}, {1.0, 0.14}, {2.5, 0.10}}};
  if (force <= kCurve.front().force) return kCurve.front().fraction;
  for (std::size_t i = 1; i < kCurve.size(); ++i) {
    const Point &a = kCurve[i - 1], &b = kCurve[i];
    if (force < b.force) return a.fraction + (b.fraction - a.fraction) * (force - a.force) / (b.force - a.force);
  }
  return kCurve.back().fraction;
}

double isotropic_angle(double weber_fraction) noexcept {
  return weber_fraction < 1 ? arc_sine(weber_fraction) : std::numbers::pi;
}

}  // namespace tactus
