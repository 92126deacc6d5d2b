// SPDX-License-Identifier: Apache-2.0
/// What a scene declares of its objects: bounds and rigid objects; deformable ones are in mesh/deformable_object.h. spec/20-scene.md.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <tactus/base/geometry.h>
#include <tactus/base/result.h>
#include <tactus/mesh/deformable_object.h>

namespace tactus {

// ==== bounds ====
// Error bounds that a sender guarantees to a client that gets every packet and does not interpolate. Decoding does not use them;
// evaluating a replica does. spec/20-scene.md section 6.

enum class Reduction : std::uint8_t {
  none,            ///< every object, every tick (reference setting S_R7)
  dead_reckoning,  ///< only when a trigger fires
};

/// Values are wire values.
enum class HapticRule : std::uint8_t {
  off = 0,         ///< visual dead reckoning and heartbeat only (S_R1)
  isotropic = 1,   ///< |f^ - f| > p |f|                                                   thesis eq. 3.1
  cone = 2,        ///< | |f^| - |f| | > p |f| or angle(f^, f) > alpha_max                 thesis figure 3.12
  fixed = 3,       ///< position or rotation error over fixed thresholds while in contact  thesis table 3.3, S_DR
  perceptual = 4,  ///< isotropic with the fraction that people notice at this force      thesis 2.1.3, table 2.1
};

/// When a rigid object must be sent; f is the normal force. Defaults: 0.3 mm, 2 deg and 4 %, for deformable objects as well.
struct RigidTriggers {
  Reduction reduction = Reduction::dead_reckoning;          ///< not a bound, never transmitted
  double heartbeat = 1.0;                                   ///< [s] 0 switches it off
  double visual_position = 3e-4;                            ///< [m]
  double visual_rotation = 2.0 * std::numbers::pi / 180.0;  ///< [rad]
  HapticRule haptic = HapticRule::isotropic;
  double weber_fraction = 0.04;                            ///< p, traffic control parameter
  double perceptual_fraction = 1;                          ///< with `perceptual`: p is this times weber_fraction_at()
  double cone_angle = 2.1 * std::numbers::pi / 180.0;      ///< alpha_max [rad]
  double fixed_position = 0.0015;                          ///< [m]
  double fixed_rotation = 2.0 * std::numbers::pi / 180.0;  ///< [rad]
  double force_floor = 0.05;                               ///< [N] below this force the threshold is that at this force
  friend bool operator==(const RigidTriggers&, const RigidTriggers&) = default;
};

/// When a vertex must be sent.
struct DeformableThresholds {
  double visual = 3e-4;                         ///< v [m], thesis eq. 3.10; 0: every vertex, exact to the grid
  std::optional<double> weber_fraction = 0.04;  ///< p, eq. 3.12: h = p |f_s| / k_c; none: no haptic threshold
  double depth_floor = 2e-4;                    ///< [m] lower limit of |f_s| / k_c: at first touch h would be 0
  friend bool operator==(const DeformableThresholds&, const DeformableThresholds&) = default;
};

/// When the force on a rigid object must be sent: once it is off by more than p max(|f|, floor).
struct LoadThresholds {
  double weber_fraction = 0.1;  ///< p
  double force_floor = 0.5;     ///< [N]
  friend bool operator==(const LoadThresholds&, const LoadThresholds&) = default;
};

struct DeformableBounds {
  DeformableThresholds thresholds;
  bool kept = true;  ///< false: the bounds only decide what is sent; errors may exceed them (profile thesis: its quantiser)
  friend bool operator==(const DeformableBounds&, const DeformableBounds&) = default;
};

struct StreamBounds {
  std::optional<RigidTriggers>
      rigid;  ///< none: no rigid object can move. Fields that `haptic` does not use are not transmitted and keep their defaults
  std::vector<DeformableBounds> deformables;  ///< one per deformable object
  std::optional<LoadThresholds> loads{};      ///< set if the scene has loads
  friend bool operator==(const StreamBounds&, const StreamBounds&) = default;
};

// ==== rigid object ====
// A rigid object as a scene declares it. spec/20-scene.md section 3.

/// Degrees of freedom of a rigid object: world axes it may move along and turn about. No bit set: a static object, never sent.
/// Rotation is about no axis, one axis or all three (R-STR-12).
struct Dof {
  static constexpr std::uint8_t x = 1, y = 2, z = 4, rx = 8, ry = 16, rz = 32;
  static constexpr std::uint8_t none = 0, translation = 7, all = 63;

  /// R-STR-12: any axes of translation; of rotation none, one or all.
  static constexpr bool is_valid(std::uint8_t dof) noexcept {
    return dof <= all && std::popcount(static_cast<unsigned>(dof >> 3)) != 2;
  }
};

/// Integer pose, position x 2^-position m, rotation x 2^-30, Hamilton w, x, y, z.
struct RigidPose {
  std::array<std::int32_t, 3> position{};
  std::array<std::int32_t, 4> rotation{1 << 30, 0, 0, 0};
  friend bool operator==(const RigidPose&, const RigidPose&) = default;
};

struct RigidObject {
  std::string name;  ///< UTF-8, 1..255 bytes, unlike any other object's
  std::uint8_t dof = Dof::all;
  RigidPose initial;  ///< pose at tick 0, at rest; the baseline of key packets
};

/// A pose on a scene's grid.   in  position_exp  GridExponents::position
/// err  invalid_argument R-API-1 a component is NaN or infinite; R-API-2 the position leaves the grid's range;
///      R-API-3 the quaternion's length differs from 1 by more than 1e-3.
Result<RigidPose> to_grid(const Pose& pose, unsigned position_exp) noexcept;
/// The only place where a decoded pose becomes floating point.
Pose to_pose(const RigidPose& pose, unsigned position_exp) noexcept;

}  // namespace tactus
