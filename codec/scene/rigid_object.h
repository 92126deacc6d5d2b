// SPDX-License-Identifier: Apache-2.0
/// A rigid object as a scene declares it. spec/20-scene.md sections 2 to 7.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <string>

#include <tactus/base/geometry.h>
#include <tactus/base/result.h>

namespace tactus {

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
