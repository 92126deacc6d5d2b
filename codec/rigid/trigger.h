// SPDX-License-Identifier: Apache-2.0
/// When is an update worth sending? Heartbeat, visual and haptic dead reckoning (thesis 3.2.1, figure 3.1). Informative: an
/// encoder's choice, never needed to decode.
#pragma once

#include <cstdint>
#include <numbers>
#include <span>

#include "codec/rigid/contact.h"
#include "codec/rigid/rigid.h"

namespace tactus {

enum class Reduction : std::uint8_t {
  none,            ///< every object, every tick (reference setting S_R7)
  dead_reckoning,  ///< only when a trigger fires
};

enum class HapticRule : std::uint8_t {
  off,        ///< visual dead reckoning and heartbeat only (S_R1)
  isotropic,  ///< |f^ - f| > p |f|                                                   thesis eq. 3.1
  cone,       ///< | |f^| - |f| | > p |f| or angle(f^, f) > alpha_max                 thesis figure 3.12
  fixed,      ///< position or rotation error over fixed thresholds while in contact  thesis table 3.3, S_DR
};

/// Defaults are the thesis's (3.2.4.1) with p = 8 %.
struct RigidTriggers {
  Reduction reduction = Reduction::dead_reckoning;
  double heartbeat = 1.0;                                   ///< [s] 0 switches it off
  double visual_position = 0.006;                           ///< [m]
  double visual_rotation = 2.0 * std::numbers::pi / 180.0;  ///< [rad]
  HapticRule haptic = HapticRule::isotropic;
  double weber_fraction = 0.08;                            ///< p, traffic control parameter
  double cone_angle = 2.1 * std::numbers::pi / 180.0;      ///< alpha_max [rad]
  double fixed_position = 0.0015;                          ///< [m]
  double fixed_rotation = 2.0 * std::numbers::pi / 180.0;  ///< [rad]
  double force_floor = 0.05;                               ///< [N] below this force the threshold stays p * force_floor
};

/// Permitted force error at true force f: p * max(|f|, force_floor) [N].
double force_budget(const RigidTriggers& triggers, double force) noexcept;

/// How far `estimate` is outside the haptic rule around `truth`: <= 1 inside, > 1 outside; the ratio of error and permitted error.
/// For `fixed` and `off` 0 is returned.    time O(1), no allocation.
double haptic_ratio(const RigidTriggers& triggers, const Vec3& truth, const Vec3& estimate) noexcept;

/// Weber fraction of force magnitude, measured on people: 10 % from 2.5 N up, 14 % at 1 N, 17 % at 0.5 N, 22 % at 0.3 N and
/// below, linear between.
double perceptual_fraction(double force) noexcept;

}  // namespace tactus
