// SPDX-License-Identifier: Apache-2.0
/// Dead reckoning of rigid objects: their predicted poses between updates. spec/40-rigid.md sections 4 and 5.2. Integers only.
#pragma once

#include <array>
#include <cstdint>

#include <tactus/rigid/rigid_state.h>
#include <tactus/scene/scene.h>

namespace tactus {

/// Velocities of an object, on the grid.
struct RigidMotion {
  std::array<std::int32_t, 3> velocity{};
  std::array<std::int32_t, 3> angular_velocity{};
};

/// Difference of a pose from the predicted one: position in grid units, rotation as a quarter-angle vector.
struct PoseError {
  std::array<std::int32_t, 3> position{};
  std::array<std::int32_t, 3> rotation{};
};

/// The motion model of encoder, decoder and replica: a function of a state, a tick, and the scene declaration.
class RigidPredictor {
 public:
  /// pre  `scene` outlives the predictor
  explicit RigidPredictor(const Scene& scene) noexcept : scene_(scene) {}

  /// The pose at `tick` of an object with constant velocities.
  ///   x(t) = x + v dt;  q(t) = exp(w dt / 2) q;  dt = min(t - state.tick, max_extrapolation)     spec 40-rigid 4
  /// pre  tick >= state.tick.   time O(1), about 50 ns, no allocation.
  RigidPose pose(const RigidState& state, std::int64_t tick) const noexcept;

  /// The velocities at `tick`, corrected for the pose error there. After a steady change of velocity, an error e after dt implies
  /// a change of 3 e / (2 dt). Without an error they are the state's.   spec 40-rigid 5.2
  RigidMotion motion(const RigidState& state, std::int64_t tick, const PoseError& error) const noexcept;

 private:
  const Scene& scene_;
};

}  // namespace tactus
