// SPDX-License-Identifier: Apache-2.0
/// When a recorded sample counts as missing: one rule for tables, ROS 2 recordings and arrays. Internal to the library.
#pragma once

#include <cmath>

namespace tactus {

inline constexpr double kRotationTolerance = 0.02;  ///< what the length of a recorded rotation may be off 1; it is then made 1

/// False for a rotation of zero (a tracker that lost its body), for NaN, and for numbers that are no rotation.
inline bool is_rotation_length(double length) noexcept { return std::abs(length - 1) <= kRotationTolerance; }

}  // namespace tactus
