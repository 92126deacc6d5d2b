// SPDX-License-Identifier: Apache-2.0
#include "bounds.h"

namespace tactus::c {

static_assert(TACTUS_HAPTIC_OFF == static_cast<int>(HapticRule::off) &&
              TACTUS_HAPTIC_ISOTROPIC == static_cast<int>(HapticRule::isotropic) &&
              TACTUS_HAPTIC_CONE == static_cast<int>(HapticRule::cone) &&
              TACTUS_HAPTIC_FIXED == static_cast<int>(HapticRule::fixed) &&
              TACTUS_HAPTIC_PERCEPTUAL == static_cast<int>(HapticRule::perceptual));

tactus_rigid_bounds bounds_of(const RigidTriggers& bounds) noexcept {
  return {.size = sizeof(tactus_rigid_bounds),
          .haptic = static_cast<std::int32_t>(bounds.haptic),
          .heartbeat = bounds.heartbeat,
          .visual_position = bounds.visual_position,
          .visual_rotation = bounds.visual_rotation,
          .weber_fraction = bounds.weber_fraction,
          .perceptual_fraction = bounds.perceptual_fraction,
          .cone_angle = bounds.cone_angle,
          .fixed_position = bounds.fixed_position,
          .fixed_rotation = bounds.fixed_rotation,
          .force_floor = bounds.force_floor};
}

tactus_deformable_bounds bounds_of(const DeformableBounds& bounds) noexcept {
  const DeformableThresholds& t = bounds.thresholds;
  return {.size = sizeof(tactus_deformable_bounds),
          .haptic = t.weber_fraction.has_value(),
          .visual = t.visual,
          .weber_fraction = t.weber_fraction.value_or(0),
          .depth_floor = t.depth_floor,
          .kept = bounds.kept,
          .reserved = 0};
}

tactus_load_bounds bounds_of(const LoadThresholds& bounds) noexcept {
  return {.size = sizeof(tactus_load_bounds),
          .reserved = 0,
          .weber_fraction = bounds.weber_fraction,
          .force_floor = bounds.force_floor};
}

Result<RigidTriggers> bounds_of(const tactus_rigid_bounds* bounds) noexcept {
  TACTUS_TRY(const tactus_rigid_bounds b, given_or(bounds, bounds_of(RigidTriggers{})));
  if (b.haptic < TACTUS_HAPTIC_OFF || b.haptic > TACTUS_HAPTIC_PERCEPTUAL) return fail(Errc::invalid_argument, "R-API-4");
  return RigidTriggers{.reduction = RigidTriggers{}.reduction,
                       .heartbeat = b.heartbeat,
                       .visual_position = b.visual_position,
                       .visual_rotation = b.visual_rotation,
                       .haptic = static_cast<HapticRule>(b.haptic),
                       .weber_fraction = b.weber_fraction,
                       .perceptual_fraction = b.perceptual_fraction,
                       .cone_angle = b.cone_angle,
                       .fixed_position = b.fixed_position,
                       .fixed_rotation = b.fixed_rotation,
                       .force_floor = b.force_floor};
}

Result<DeformableThresholds> bounds_of(const tactus_deformable_bounds* bounds) noexcept {
  TACTUS_TRY(const tactus_deformable_bounds b, given_or(bounds, bounds_of(DeformableBounds{})));
  DeformableThresholds out{.visual = b.visual, .weber_fraction = b.weber_fraction, .depth_floor = b.depth_floor};
  if (b.haptic == 0) out.weber_fraction.reset();
  return out;
}

Result<LoadThresholds> bounds_of(const tactus_load_bounds* bounds) noexcept {
  TACTUS_TRY(const tactus_load_bounds b, given_or(bounds, bounds_of(LoadThresholds{})));
  return LoadThresholds{.weber_fraction = b.weber_fraction, .force_floor = b.force_floor};
}

}  // namespace tactus::c
