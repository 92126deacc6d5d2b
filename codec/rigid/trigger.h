// SPDX-License-Identifier: Apache-2.0
/// When is an update worth sending? Heartbeat, visual and haptic dead reckoning (thesis 3.2.1, figure 3.1). Informative: an
/// encoder's choice, never needed to decode.
#pragma once

#include <tactus/base/geometry.h>
#include <tactus/scene/bounds.h>

namespace tactus {

/// Permitted force error at true force f: p F with F = max(|f|, force_floor) [N], p that of the rule at F.
double force_budget(const RigidTriggers& triggers, double force) noexcept;

/// Force error of `estimate` over the error that the haptic rule permits around `truth`: <= 1 inside, > 1 outside.
/// Returns 0 for `fixed` and `off`.    time O(1), no allocation.
double haptic_ratio(const RigidTriggers& triggers, const Vec3& truth, const Vec3& estimate) noexcept;

/// Weber fraction of force magnitude, measured in human subjects: 10 % from 2.5 N up, 14 % at 1 N, 17 % at 0.5 N, 22 % at 0.3 N
/// and below, linear between.   spec 20-scene 6; thesis table 2.1
double perceptual_fraction(double force) noexcept;

/// alpha_max = arcsin p: the largest angle between two forces inside an isotropic deadzone [rad]; half a circle from p = 1 on, where
/// no direction is excluded.   thesis eq. 3.3
double isotropic_angle(double weber_fraction) noexcept;

}  // namespace tactus
