// SPDX-License-Identifier: Apache-2.0
/// Whether what a client shows of a rigid object is near enough to the truth. Informative: an encoder's choice. Internal to the library.
#pragma once

#include <array>
#include <cstdint>

#include <tactus/base/result.h>
#include <tactus/rigid/curve.h>
#include <tactus/rigid/level_of_detail.h>
#include <tactus/rigid/rigid_state.h>
#include <tactus/rigid/rigid_truth.h>
#include <tactus/rigid/rigid_work.h>
#include <tactus/rigid/trigger.h>

namespace tactus {

// ==== pose thresholds ====
// The visual bound of a pose, in integers.

/// In grid units, shrunk so that the bound also holds for the unrounded truth.
struct PoseThresholds {
  std::int64_t distance_squared = 0;
  std::int64_t half_angle_squared = 0;  ///< (sin(angle / 2))^2 x 2^-60 of a quaternion of length 1
  unsigned level = 0;                   ///< coarsest grid level whose rounding stays well within
};

/// time 10 ns, no allocation
bool within(const PoseThresholds& t, const RigidPose& shown, const RigidState& truth) noexcept;

// ==== bounds ====
// All bounds of an encoder: of what is seen, and of the force that is felt.

class RigidBounds {
 public:
  /// Those of one level of detail, scaled.
  struct Level {
    double scale = 1;
    PoseThresholds visual, fixed, early;  ///< early: over which an object joins a packet
  };

  /// err  invalid_argument R-API-4: one is negative, NaN, finer than the grid, or too large
  static Result<void> check(const RigidTriggers& triggers, const GridExponents& grid) noexcept;
  /// pre  check(); scene and truth outlive this
  RigidBounds(const Scene& scene, const RigidTriggers& triggers, const RigidTruth& truth);

  void set_scale(double factor) noexcept;    ///< of all.   pre  factor >= 1
  void set_early(double fraction) noexcept;  ///< of its bounds over which an object joins a packet
  double early() const noexcept { return early_; }
  const Level& of(std::uint8_t lod) const noexcept { return levels_[lod]; }
  const RigidTriggers& triggers() const noexcept { return triggers_; }
  RigidTriggers scaled_triggers(std::uint8_t lod) const noexcept;

  /// Its force counts.
  bool is_touched(std::uint32_t object) const noexcept {
    return triggers_.haptic != HapticRule::off && truth_.is_touched(object);
  }
  /// The largest haptic_ratio() of the contacts on the object; with the rule `fixed` 0 or infinite. To be compared with Level::scale.
  double haptic_ratio_of(std::uint32_t object, std::uint8_t lod, const RigidPose& shown) const noexcept;
  /// Whether a trigger fires, other than the heartbeat.
  /// in   path   of the object, as a client has it;  early  ask whether it would soon cause a packet, too
  RigidDecision decide(const SmoothedPath& path, const RigidPredictor& predictor, std::uint8_t lod, bool early) const noexcept;

 private:
  bool can_improve(std::uint32_t object, const RigidPose& shown) const noexcept;

  const Scene& scene_;
  const RigidTruth& truth_;
  RigidTriggers triggers_;
  double early_ = 1;
  std::array<Level, kOutOfInterest + 1> levels_;
};

}  // namespace tactus
