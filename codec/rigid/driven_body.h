// SPDX-License-Identifier: Apache-2.0
/// A rigid object that a device pushes or holds, tick by tick from an update on: what the predictor `driven` shows to who knows the device.
/// spec/40-rigid.md section 4.1. Integers only. Internal to the library.
///
/// Held: a free body on its own weight and the spring of the device. Pushed: it keeps to the screw of the update's velocities, as the
/// surroundings that guide it go on doing so; along it the device drives and a drag brakes.
#pragma once

#include <array>
#include <cstdint>

#include <tactus/rigid/rigid_state.h>
#include <tactus/scene/scene.h>

namespace tactus {

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
  Vec place_{};  // x 2^-32 m
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
               first_load_ = 0;  // pushed: friction of the ground on the way, x 2^-24; its load at the start, x 2^-16 m/s^2
};

}  // namespace tactus
