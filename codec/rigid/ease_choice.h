// SPDX-License-Identifier: Apache-2.0
/// How long an update of an eased scene may take to pass over to its own path. Informative: an encoder's choice. Internal to the library.
#pragma once

#include <cstdint>

#include <tactus/rigid/acceleration.h>
#include <tactus/rigid/error_share.h>

namespace tactus {

/// An error of position [m] and rotation [rad], world frame, less than a right angle.
struct SmallError {
  Vec3 moved, turned;
};

/// What is known of an update's error in the ticks to come:
///   e(t) = offset (1 - t/T) + error + drift t - acceleration departure(t)
struct UpdateCourse {
  SmallError offset;                  ///< from the update's pose to the one shown when it comes: what is left to go
  SmallError error;                   ///< of the update's pose
  Acceleration::Motion drift;         ///< the velocities told, less the true ones
  Acceleration::Motion acceleration;  ///< of the truth
};

/// `ease`: the longest T = 2^ease ticks, of at most 16 ms, during which the error stays inside its bounds; 0 if even two ticks are
/// too long.
/// time O(contacts), about 0.3 us with one
std::uint8_t longest_ease(const UpdateCourse& course, const ErrorShare& share, std::uint32_t tick_rate) noexcept;

}  // namespace tactus
