// SPDX-License-Identifier: Apache-2.0
/// Boxes and other solids (ode_mesh.h) on a floor, stepped by ODE at 1 kHz (thesis 3.2.4.1).
///
/// Coulomb friction  ODE bounds friction per axis (a pyramid). One axis is aligned with the velocity that the contact point would
///                   have without friction, so that the bound is mu N in every direction of sliding, not up to 41 % more.
/// Damping           v and w are multiplied by the object's d after every step.
/// Standstill        an object in contact stands still if it is not pushed and none of its points is faster than 1e-8 m/s after a
///                   step, or 1e-7 m/s if it stood still before: it keeps its pose, and its velocity is zero. Otherwise it would
///                   creep by the solver's residual.
/// Sleep             a group of touching objects, or a single one, is left out of steps when no bit of its state changed in 16
///                   ticks, until one of them is pushed or hit. Results are the same bit for bit: each group of touching objects
///                   is solved on its own. A pile that jitters sleeps, too (rigid_objects.h), and then loses its velocities.
/// Locked axes       an object keeps the exact bits of its first position along them, and of its first rotation.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include <tactus/base/diagnostic.h>
#include <tactus/base/geometry.h>
#include <tactus/rigid/rigid_state.h>
#include <tactus/sim/rigid/rigid_errors.h>
#include <tactus/sim/scene/scene.h>

namespace tactus::sim {

/// What a step costs, and how exact it is.
struct RigidEffort {
  int parts = 1;         ///< of a tick, stepped one after the other
  int iterations = 100;  ///< of the contact solver; ten times as many where they do not suffice
};

class RigidWorld {
 public:
  /// Uses only the scene's objects, floor and gravity.   pre  every call on the same thread
  explicit RigidWorld(const Scene& scene, const RigidEffort& effort = {});

  /// Add a force [N] at a world point to the next step. Along locked axes it only loads the object's supports.
  void push(std::uint32_t object, const Vec3& force, const Vec3& point) noexcept;

  /// Advance by one tick.
  /// time O(contacts), about 15 us for one cube on the floor, and O(log objects) for each that is awake; nothing for those that sleep
  ///      or are static; no allocation once ODE's arenas fit the contacts, in the first step.
  /// err  limit_exceeded R-SIM-6: more than 65536 contacts in this step;
  ///      invalid_argument R-SIM-1: a pose is not finite, or an object got faster than 1e4 m/s or 1e5 rad/s; the world is then
  ///      unusable.
  tl::expected<void, Diagnostic> step();

  /// Put an object elsewhere; it keeps its velocities.   time O(1), and that of waking it
  void move_to(std::uint32_t object, const Pose& pose) noexcept;
  /// Wake an object for the next step, as a push without force would.
  void wake(std::uint32_t object) noexcept;
  /// Objects whose states the last step may have changed, ascending; before the first step all.
  std::span<const std::uint32_t> changed() const noexcept;

  /// State of an object now, its velocities those of half a step before: position minus step times velocity is where it was a step
  /// before.   time O(1), no allocation
  RigidSample sample(std::uint32_t object) const noexcept;
  /// Forces on an object in the last step.
  struct Load {
    Vec3 external;  ///< [N] all but those of push(): gravity, contacts, damping
    Vec3 hold;      ///< along the normal of its contacts, as long as the sum of mu |f_n| [N]   spec/45-load.md 3
  };
  const Load& load(std::uint32_t object) const noexcept;  ///< zero unless sends_loads(scene)
  const RigidErrors& errors() const noexcept;             ///< of all steps so far
  /// [J] Kinetic energy of an object at this tick, and gravity's since its start.   time O(1)
  double energy(std::uint32_t object) const noexcept;
  /// [kg m^2] Moments of inertia about the axes of an object's frame; zero: it is static.
  Vec3 inertia(std::uint32_t object) const noexcept;
  std::int64_t tick() const noexcept;

  RigidWorld(RigidWorld&&) noexcept;
  RigidWorld& operator=(RigidWorld&&) noexcept;
  ~RigidWorld();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tactus::sim
