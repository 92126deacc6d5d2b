// SPDX-License-Identifier: Apache-2.0
/// The acceleration of true motions, from the velocities of the last three ticks. An encoder's; internal to the library.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <tactus/rigid/rigid_state.h>
#include <tactus/scene/scene.h>

namespace tactus {

class Acceleration {
 public:
  /// A change of motion fades, a e^(-t/kFade): after t the truth has departed from a steady motion by a departure(t).
  static constexpr double kFade = 0.03;  ///< [s]
  static double departure(double seconds) noexcept;

  struct Motion {
    Vec3 linear, angular;  ///< per s, or per s^2
  };

  /// pre  `scene` outlives this
  explicit Acceleration(const Scene& scene);

  /// The truth of a tick, after those before it.   time O(moving objects), no allocation
  void read(std::int64_t tick, std::span<const RigidSample> samples) noexcept;
  /// [m/s^2, rad/s^2] at the last read(). Zero in each component where the last two differences of the velocities do not agree.
  Motion of(std::uint32_t object) const noexcept;

 private:
  double seconds(std::size_t from, std::size_t to) const noexcept;

  const Scene& scene_;
  std::array<std::int64_t, 3> ticks_;           // of the past, newest first
  std::array<std::vector<Motion>, 3> motions_;  // by object
};

}  // namespace tactus
