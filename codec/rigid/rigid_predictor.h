// SPDX-License-Identifier: Apache-2.0
/// Predicted poses of rigid objects between updates, by the predictor that their last update chose. spec/40-rigid.md sections 4 and 5.2.
/// Integers only.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <tactus/rigid/driven_body.h>
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

  /// The pose at `tick`.
  ///   linear     x(t) = x + v dt;  q(t) = exp(w dt / 2) q;  dt = min(t - state.tick, max_extrapolation)     spec 40-rigid 4
  ///   ballistic  x(t) = x + v dt + g dt^2 / 2;  q as linear
  ///   slide      as linear with dt - dt^2 / (2 T) for dt, T / 2 from T on;  T = |v| / deceleration
  /// pre  tick >= state.tick, and the scene declares the state's predictor.   time O(1), about 50 ns, slide 80 ns; no allocation.
  ///   driven     as linear: packets are coded on what every receiver knows
  RigidPose pose(const RigidState& state, std::int64_t tick) const noexcept;

  /// Know the device of the client.   in  path  outlives the predictor.   allocates if the scene has driven objects
  void know(const DevicePath& path);
  bool knows_device() const noexcept { return path_ != nullptr; }
  /// The pose at `tick` as it is shown: pose(), but where the device drives the object, DrivenBody::pose().
  /// pre  those of pose(); `state` is one of `object`.   time that of both
  RigidPose shown(std::uint32_t object, const RigidState& state, std::int64_t tick) const noexcept;

  /// The velocities at `tick` by the state's predictor, corrected for the pose error there. After a steady change of velocity, an
  /// error e after dt implies a change of 3 e / (2 dt). Without an error they are not corrected.   spec 40-rigid 5.2
  RigidMotion motion(const RigidState& state, std::int64_t tick, const PoseError& error) const noexcept;

 private:
  std::int64_t gained(std::size_t axis, std::int64_t dt) const noexcept;  // velocity, by gravity
  void fall(std::int64_t dt, RigidPose& pose) const noexcept;
  RigidMotion free_motion(const RigidState& state, std::int64_t dt) const noexcept;

  const Scene& scene_;
  const DevicePath* path_ = nullptr;        // none: the device is not known
  mutable std::vector<DrivenBody> bodies_;  // by object; what the last looks have found
};

}  // namespace tactus
