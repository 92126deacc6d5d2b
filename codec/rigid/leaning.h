// SPDX-License-Identifier: Apache-2.0
/// A velocity for an update that makes it last longer: it leans towards the acceleration, so that the error of the prediction first goes
/// to one side of its bounds and then to the other. Informative: an encoder's choice; a decoder sees a velocity like any other. Internal
/// to the library.
///
///   v' = v + s a,  w' = w + s alpha                                    for all of one object the same s
///
/// The truth is taken to go on with an acceleration that fades, a e^(-t/tau): it departs from v by a g(t), g(t) = tau (t - tau (1 - e^(-t/tau))),
/// and the prediction departs from the truth by a (s t - g(t)). Its largest value on the one side is, with x = s/tau,
///   tau^2 ((1 - x) ln(1 - x) + x),  and shall be B = the smallest of permitted error over acceleration;
/// x = y - y^2/6, at most 1, with y = sqrt(2 B)/tau, is within 7 % of that. For small B an update then lasts 1 + sqrt(2) times as long as
/// with s = 0. What the truth really does decides how long it lasts, never whether a bound holds.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <tactus/rigid/contact.h>
#include <tactus/rigid/rigid_state.h>
#include <tactus/rigid/trigger.h>
#include <tactus/scene/scene.h>

namespace tactus {

class Leaning {
 public:
  /// pre  `scene` outlives this
  explicit Leaning(const Scene& scene);

  /// The truth of a tick, after those before it.   time O(moving objects), no allocation
  void read(std::int64_t tick, std::span<const RigidSample> samples) noexcept;
  /// The object's sample of the last read(), with the velocities to tell.
  /// in   triggers  widened
  /// time O(contacts), about 50 ns, no allocation
  RigidSample lean(std::uint32_t object, std::span<const RigidSample> samples, std::span<const Contact> contacts,
                   const RigidTriggers& triggers) const noexcept;

 private:
  struct Motion {
    Vec3 velocity, angular_velocity;
  };
  /// [m/s^2, rad/s^2] Zero where the last two differences of the velocities do not agree.
  Motion acceleration(std::uint32_t object) const noexcept;
  double seconds(std::size_t from, std::size_t to) const noexcept;

  const Scene& scene_;
  std::array<std::int64_t, 3> ticks_;           // of the past, newest first
  std::array<std::vector<Motion>, 3> motions_;  // by object
};

}  // namespace tactus
