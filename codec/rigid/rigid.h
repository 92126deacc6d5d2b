// SPDX-License-Identifier: Apache-2.0
/// Rigid objects: the part that encoder, decoder and replica share. spec/40-rigid.md. Integers only.
#pragma once

#include <cstdint>
#include <span>

#include <tactus/base/geometry.h>
#include <tactus/base/result.h>
#include <tactus/scene/scene_syntax.h>

namespace tactus {

/// Pose and motion of one rigid object in SI units, as a simulation or a recording gives it.
struct RigidSample {
  Pose pose;
  Vec3 velocity;          ///< [m/s] world frame
  Vec3 angular_velocity;  ///< [rad/s] world frame
};

/// Why an object's state was sent. Values are wire values (spec/40-rigid.md table 1).
enum class Reason : std::uint8_t {
  request = 0,    ///< no trigger: a key packet or a stream without data reduction
  heartbeat = 1,  ///< time-out since the last update
  visual = 2,     ///< position or rotation error over the visual threshold (visual dead reckoning)
  haptic = 3,     ///< force error over the haptic threshold (haptic dead reckoning, thesis eq. 3.1)
};

/// Integer pose, position x 2^-position m, rotation x 2^-30.
struct RigidPose {
  std::array<std::int32_t, 3> position{};
  std::array<std::int32_t, 4> rotation{1 << 30, 0, 0, 0};
  friend bool operator==(const RigidPose&, const RigidPose&) = default;
};

/// Dead reckoning: the pose at `tick` of an object that keeps its velocity and spin.
///   x(t) = x + v dt;  q(t) = exp(w dt / 2) q;  dt = min(t - state.tick, max_extrapolation)     spec 40-rigid 4
/// pre  tick >= state.tick.   time O(1), about 50 ns, no allocation.
RigidPose predict(const RigidState& state, std::int64_t tick, const StreamHeader& header) noexcept;

/// SI sample to grid.
/// err  invalid_argument R-API-1 a component is NaN or infinite; R-API-2 the value leaves the grid's range;
///      R-API-3 the quaternion's length differs from 1 by more than 1e-3.
Result<RigidState> to_grid(const RigidSample& sample, std::int64_t tick, const GridExponents& grid) noexcept;

/// Grid to SI units. The only place where a decoded state becomes floating point.
Pose to_pose(const RigidPose& pose, const GridExponents& grid) noexcept;
RigidSample to_sample(const RigidState& state, const GridExponents& grid) noexcept;

/// FNV-1a (64 bit) over tick, position, rotation, velocity and spin of every object that can move. spec 40-rigid 6
std::uint64_t state_hash(const StreamHeader& header, std::span<const RigidState> objects) noexcept;

}  // namespace tactus
