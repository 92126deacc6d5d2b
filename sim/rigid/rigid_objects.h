// SPDX-License-Identifier: Apache-2.0
/// The scene's rigid objects for probes: at the server, where ODE moves them, and at a client, where they are shown.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <tactus/base/geometry.h>
#include <tactus/load/load_state.h>
#include <tactus/sim/rigid/rigid_probe.h>
#include <tactus/sim/rigid/rigid_world.h>
#include <tactus/sim/scene/scene.h>
#include <tactus/sim/touchable.h>

namespace tactus::sim {

// ==== rest watch ====
// Finds piles that are at rest except for solver jitter, so that they can sleep.
//
// Piles never come fully to rest under QuickStep: the blocks of a tower of 54 jitter with 0.5 mm/s and creep 0.1 mm in ten
// seconds. A group of touching objects rests if none was pushed and none of their points moved farther than kRestDistance in
// kRestTicks. An object that touches no other moving one is not judged: its rest is exact (rigid_world.h).

inline constexpr std::int64_t kRestTicks = 256;
inline constexpr double kRestDistance = 20e-6;  ///< [m]

class RestWatch {
 public:
  /// Add a moving object whose corners are `reach` [m] from its centre.
  void add(const Pose& pose, double reach);

  /// Report that something acts on an object: it does not count as resting in this period.   time O(1)
  void disturb(std::size_t object) noexcept { objects_[object].disturbed = true; }
  /// Report that two objects touch.   pre  in the last tick of a period   time O(1), about
  void touch(std::size_t a, std::size_t b) noexcept { objects_[pile_of(b)].pile = pile_of(a); }
  /// End a period with these poses and begin a new one; rests() then gives the result.   time O(objects), no allocation
  void end_period(std::span<const Pose> poses) noexcept;
  bool rests(std::size_t object) const noexcept { return objects_[object].rests; }

 private:
  struct Watched {
    Pose before;  // at the beginning of the period
    double reach;
    std::size_t pile;  // another object of the same pile; itself: it represents the pile
    bool disturbed = false, rests = false;
    // Of the pile that it represents.
    std::size_t members = 0;
    bool restless = false;
  };
  std::size_t pile_of(std::size_t object) noexcept;

  std::vector<Watched> objects_;
};

// ==== rigid objects ====

class RigidObjects final : public Simulated {
 public:
  /// pre  every call on the same thread (RigidWorld)
  explicit RigidObjects(const Scene& scene, const RigidEffort& effort = {});

  /// pre  `frame` is that of the tick before, has room for all objects of the scene, and frame.changed is set with capacity for them
  /// time O(objects that moved)
  void observe(TraceFrame& frame) noexcept override;
  Touch touch(std::size_t user, const DeviceSample& device, bool held) noexcept override;
  void push(std::size_t user, double fraction) noexcept override;
  tl::expected<void, Diagnostic> step() override;

  /// Put an object elsewhere, as of this tick.   no allocation
  void move_to(std::uint32_t object, const Pose& pose) noexcept;
  /// Push an object at its centre with a force [N] in this tick.   no allocation
  void push_centre(std::uint32_t object, const Vec3& force) noexcept { world_.push(object, force, poses_[object].position); }

  Vec3 inertia(std::uint32_t object) const noexcept { return world_.inertia(object); }  ///< RigidWorld::inertia
  const RigidErrors& errors() const noexcept { return world_.errors(); }
  double energy(std::uint32_t object) const noexcept { return world_.energy(object); }  ///< [J] RigidWorld::energy

  /// Forces of the last step on every rigid and one-dimensional object of the scene, those on the latter zero; empty unless
  /// sends_loads(scene).
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
