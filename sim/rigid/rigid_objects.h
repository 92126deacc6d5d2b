// SPDX-License-Identifier: Apache-2.0
/// The scene's rigid objects for probes: at the server, where ODE moves them, and at a client, where they are shown.
#pragma once

#include <span>
#include <vector>

#include <tactus/load/load_state.h>
#include <tactus/sim/rigid/rigid_probe.h>
#include <tactus/sim/rigid/rigid_world.h>
#include <tactus/sim/scene/scene.h>
#include <tactus/sim/touchable.h>

namespace tactus::sim {

class RigidObjects final : public Simulated {
 public:
  /// pre  every call on the same thread (RigidWorld)
  explicit RigidObjects(const Scene& scene);

  /// pre  `frame` is that of the tick before, has room for all objects of the scene, and frame.changed is set with capacity for them
  /// time O(objects that moved)
  void observe(TraceFrame& frame) noexcept override;
  Touch touch(std::size_t user, const DeviceSample& device, bool held) noexcept override;
  void push(std::size_t user, double share) noexcept override;
  tl::expected<void, Diagnostic> step() override;

  /// Put an object elsewhere, as of this tick.   no allocation
  void place(std::uint32_t object, const Pose& pose) noexcept;
  /// Push an object at its centre with a force [N] in this tick.   no allocation
  void push_centre(std::uint32_t object, const Vec3& force) noexcept { world_.push(object, force, poses_[object].position); }

  Vec3 inertia(std::uint32_t object) const noexcept { return world_.inertia(object); }  ///< RigidWorld::inertia

  /// Forces of the last step on every rigid and one-dimensional object of the scene, those on the latter zero; empty unless
  /// tells_loads(scene).
  std::span<const ObjectLoad> loads() const noexcept { return loads_; }

 private:
  RigidWorld world_;
  std::vector<RigidProbe> probes_;  // one per user
  std::vector<Touch> touches_;      // likewise, of this tick
  std::vector<Pose> poses_;         // one per object
  std::vector<ObjectLoad> loads_;   // one per object of the stream
  std::vector<Vec3> pushes_;        // [N] of each user on each of them, in the last step,
  std::vector<Vec3> pushing_;       // and in this tick
};

/// At a client.
class RigidView final : public Touchable {
 public:
  /// Whether the client knows which objects moved; it then checks the others only occasionally.
  enum class News : std::uint8_t { of_all, of_changed };

  RigidView(const Scene& scene, News news);

  /// pre  an object that is not shown anew keeps its pose
  void show(std::uint32_t object, const Pose& pose) noexcept;
  Touch touch(std::size_t user, const DeviceSample& device, bool held) noexcept override;

  std::span<const Pose> poses() const noexcept { return poses_; }

 private:
  News news_;
  std::vector<RigidProbe> probes_;
  std::vector<Pose> poses_;
};

}  // namespace tactus::sim
