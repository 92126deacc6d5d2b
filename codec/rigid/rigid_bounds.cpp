// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/rigid_bounds.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <tactus/base/fixed.h>
#include <tactus/base/rule.h>
#include <tactus/rigid/rigid_syntax.h>

namespace tactus {
namespace {

constexpr unsigned kCoarsestLevel = 15;
constexpr double kVisualFraction = 0.18;  // of a bound may the rounding to a level use up; the rest is for the motion after it

/// Of a distance [m] and an angle [rad].   err  invalid_argument R-API-4 one of them is finer than the grid, or too large
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

/// Of `factor` times both, as far as there are such thresholds.   pre  pose_thresholds(distance, angle) gives some; factor >= 1
PoseThresholds scaled(double distance, double angle, double factor, const GridExponents& grid) noexcept {
  return pose_thresholds(std::min(factor * distance, 999'999.0), std::min(factor * angle, std::numbers::pi), grid)
      .value_or(PoseThresholds{});
}

/// A fraction of what is permitted; the grid level stays.
PoseThresholds scaled(PoseThresholds t, double fraction) noexcept {
  t.distance_squared = static_cast<std::int64_t>(fraction * fraction * static_cast<double>(t.distance_squared));
  t.half_angle_squared = static_cast<std::int64_t>(fraction * fraction * static_cast<double>(t.half_angle_squared));
  return t;
}

bool are_valid(const RigidTriggers& t) noexcept {
  return std::isfinite(t.heartbeat) && t.heartbeat >= 0 && t.heartbeat <= 3600 && t.weber_fraction > 0 && t.weber_fraction <= 1 &&
         t.perceptual_fraction > 0 && t.perceptual_fraction <= 1 && std::isfinite(t.force_floor) && t.force_floor > 0 &&
         std::isfinite(t.cone_angle) && t.cone_angle > 0 && t.cone_angle <= std::numbers::pi;
}

}  // namespace

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

Result<void> RigidBounds::check(const RigidTriggers& triggers, const GridExponents& grid) noexcept {
  if (!are_valid(triggers)) return fail(Errc::invalid_argument, "R-API-4");
  TACTUS_CHECK(pose_thresholds(triggers.visual_position, triggers.visual_rotation, grid));
  if (triggers.haptic == HapticRule::fixed) TACTUS_CHECK(pose_thresholds(triggers.fixed_position, triggers.fixed_rotation, grid));
  return {};
}

RigidBounds::RigidBounds(const Scene& scene, const RigidTriggers& triggers, const RigidTruth& truth)
    : scene_(scene), truth_(truth), triggers_(triggers) {
  set_scale(1);
}

void RigidBounds::set_scale(double factor) noexcept {
  for (std::size_t lod = 0; lod < (scene_.interest ? levels_.size() : 1); ++lod) {
    Level& level = levels_[lod];
    level.scale = std::ldexp(factor, static_cast<int>(lod));
    level.visual = scaled(triggers_.visual_position, triggers_.visual_rotation, level.scale, scene_.grid);
    level.fixed = scaled(triggers_.fixed_position, triggers_.fixed_rotation, level.scale, scene_.grid);
    if (triggers_.reduction == Reduction::none)
      level.visual.level = level.fixed.level = 0;  // the reference is as exact as the grid
    level.early = scaled(level.visual, early_);
  }
}

void RigidBounds::set_early(double fraction) noexcept {
  if (fraction == early_) return;
  early_ = fraction;
  for (Level& level : levels_) level.early = scaled(level.visual, early_);
}

RigidTriggers RigidBounds::scaled_triggers(std::uint8_t lod) const noexcept {
  RigidTriggers out = triggers_;
  for (double* bound : {&out.visual_position, &out.visual_rotation, &out.weber_fraction, &out.perceptual_fraction,
                        &out.fixed_position, &out.fixed_rotation})
    *bound *= of(lod).scale;
  return out;
}

double RigidBounds::haptic_ratio_of(std::uint32_t object, std::uint8_t lod, const RigidPose& shown) const noexcept {
  constexpr double kOutside = std::numeric_limits<double>::infinity();
  double out = 0;
  if (!is_touched(object)) return out;
  for (const Contact& contact : truth_.contacts()) {
    if (contact.kind == ContactKind::none || contact.object != object) continue;
    if (triggers_.haptic == HapticRule::fixed) return within(of(lod).fixed, shown, truth_.state(object)) ? 0 : kOutside;
    const Vec3 estimate = contact_force(contact, to_pose(shown, scene_.grid.position));
    const double ratio = haptic_ratio(triggers_, contact_force(contact, truth_.samples()[object].pose), estimate);
    if (std::isnan(ratio)) return kOutside;  // forces too large to compare
    out = std::max(out, ratio);
  }
  return out;
}

/// An update would bring the shown pose nearer to the truth: they are not at the same point of the grid.
bool RigidBounds::can_improve(std::uint32_t object, const RigidPose& shown) const noexcept {
  const Residual rest = quantise_pose(shown, truth_.state(object), scene_.objects[object].dof, 0, scene_.grid);
  return rest.of != Residual{}.of;
}

RigidDecision RigidBounds::decide(const SmoothedPath& path, const RigidPredictor& predictor, std::uint8_t lod,
                                  bool early) const noexcept {
  const std::uint32_t object = path.object;
  const std::int64_t tick = truth_.tick();
  const RigidState& truth = truth_.state(object);
  const RigidPose predicted = predictor.shown(object, path.state, tick);
  const RigidPose shown = smoothed(predicted, path.state, path.offset, tick);
  const double force_ratio = haptic_ratio_of(object, lod, shown);
  const Level& level = of(lod);
  RigidDecision out;
  if (force_ratio > level.scale && can_improve(object, shown)) out.reason = Reason::haptic;
  else if (!within(level.visual, shown, truth) || (is_smoothing(path.state, tick) && !within(level.visual, predicted, truth)))
    out.reason = Reason::visual;
  out.is_early =
      early && (!within(level.early, shown, truth) || (force_ratio > early_ * level.scale && can_improve(object, shown)));
  return out;
}

}  // namespace tactus
