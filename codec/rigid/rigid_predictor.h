// SPDX-License-Identifier: Apache-2.0
/// Where a rigid object is between two updates: by itself, or driven by the device of a client. Integers.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <tactus/rigid/rigid_state.h>
#include <tactus/scene/scene.h>

namespace tactus {

// ==== driven body ====
// A rigid object that a device pushes or holds, tick by tick from an update on: what the predictor `driven` shows to who knows the device.
// spec/42-driven.md section 4. Integers only.
//
// Held: a free body on its own weight and the spring of the device. Pushed: it keeps to the screw of the update's velocities, as the
// surroundings that guide it go on doing so; along it the device drives and a drag brakes.

class DevicePath;

class DrivenBody {
 public:
  /// The pose at `tick` of an object that `state` says is driven.
  /// pre  the scene has constants for it; tick >= state.tick
  /// time 0.15 us for each tick since the last call with this state, if that asked for an earlier one and the past of the path is the same;
  ///      else since the state's.   no allocation
  RigidPose pose(const Scene& scene, std::uint32_t object, const DevicePath& path, const RigidState& state,
                 std::int64_t tick) noexcept;

 private:
  using Vec = std::array<std::int64_t, 3>;
  using Rows = std::array<std::array<std::int64_t, 3>, 3>;  // x 2^-30

  void start(const Scene& scene, std::uint32_t object, const RigidState& state) noexcept;
  void start_screw(const Scene& scene, const DrivenConstants::Body& body) noexcept;
  void step(const Scene& scene, std::uint32_t object, const DevicePath& path) noexcept;
  Vec pull(const Scene& scene, const DrivenConstants::Body& body, const DevicePath& path, const Rows& rows) noexcept;
  void slide(const DrivenConstants::Body& body, const Vec& device) noexcept;
  void hold(const Scene& scene, const DrivenConstants::Body& body, const Rows& rows, const Vec& pull) noexcept;
  void push(const Scene& scene, const DrivenConstants::Body& body, const Rows& rows, const Vec& pull) noexcept;
  std::int64_t load(const Vec& pull) const noexcept;
  RigidPose shown(const Scene& scene, std::uint32_t object) const noexcept;

  RigidState from_;
  std::int64_t tick_ = -1;  // that was reached; below that of from_: none
  std::uint64_t revision_ = 0;
  bool is_touching_ = false;
  Vec position_{};  // x 2^-32 m
  std::array<std::int32_t, 4> rotation_{};
  Vec point_{};             // where the spring pulls, object frame, x 2^-28 m
  Vec normal_{};            // x 2^-30
  Vec gravity_{};           // x 2^-16 m/s^2
  Vec down_{};              // its direction, x 2^-30
  Vec velocity_{};          // held: x 2^-27 m/s
  Vec angular_{};           // held: x 2^-22 rad/s
  Vec along_{}, about_{};   // pushed: the screw at speed 1 in the object's frame, x 2^-24, x 2^-19 rad/m
  std::int64_t speed_ = 0;  // pushed: x 2^-27 m/s
  std::int64_t rub_ = 0,
               first_load_ = 0;  // pushed: friction of the ground on its path, x 2^-24; its load at the start, x 2^-16 m/s^2
};

// ==== rigid predictor ====
// Predicted poses of rigid objects between updates, by the predictor that their last update chose. spec/40-rigid.md sections 4 and 5.2.
// Integers only. All that tells one predictor from another is here: what it needs, who may follow it, its motion, when it comes to rest.

/// Updates choose among them.
bool has_predictors(const Scene& scene) noexcept;
/// Does the scene declare what the predictor needs? (R-RIG-7)
bool is_declared(const Scene& scene, std::uint32_t object, Predictor predictor) noexcept;
/// Is it declared, and no axis along which it accelerates locked?   in  predictor  one of kFreePredictors
bool is_free_to(const Scene& scene, std::uint32_t object, Predictor predictor) noexcept;

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
  /// The same where the device of the client is known, which may drive objects.
  /// in   device  its path, which outlives the predictor; null: it is not known.   allocates if the scene has driven objects
  RigidPredictor(const Scene& scene, const DevicePath* device);

  /// The pose at `tick`, by the state's predictor; `driven` as linear: packets are coded on what every receiver knows.
  /// pre  tick >= state.tick, and the scene declares the state's predictor.   time O(1), about 50 ns, slide 80 ns; no allocation.
  RigidPose pose(const RigidState& state, std::int64_t tick) const noexcept;

  bool has_device_path() const noexcept { return path_ != nullptr; }
  /// The pose at `tick` as it is shown: pose(), but where the device drives the object, DrivenBody::pose().
  /// pre  those of pose(); `state` is one of `object`.   time that of both
  RigidPose shown(std::uint32_t object, const RigidState& state, std::int64_t tick) const noexcept;

  /// From `tick` on its pose never changes.   pre  those of pose().   time that of pose()
  bool is_at_rest(const RigidState& state, std::int64_t tick) const noexcept;

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
