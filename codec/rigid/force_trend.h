// SPDX-License-Identifier: Apache-2.0
/// How fast the forces on objects sink, and with them what may be wrong: an error that is inside its bound now may not be in a few
/// milliseconds. An encoder's; internal to the library.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <tactus/rigid/contact.h>
#include <tactus/rigid/rigid_state.h>
#include <tactus/scene/scene.h>

namespace tactus {

class ForceTrend {
 public:
  /// pre  `scene` outlives this.   allocates
  explicit ForceTrend(const Scene& scene);

  /// The contacts of a tick, after those before it.   time O(moving objects + contacts), about 30 ns per contact; no allocation
  void read(std::int64_t tick, std::span<const RigidSample> samples, std::span<const Contact> contacts) noexcept;
  /// [1/s] the part of the least force on the object that goes per second; 0 if it grows, or was not there two ticks ago
  double sinking(std::uint32_t object) const noexcept;

 private:
  const Scene& scene_;
  std::array<std::int64_t, 3> ticks_{};        // of the past, newest first
  std::array<std::vector<double>, 3> forces_;  // [N] the least by object; infinite: nothing touches it
};

}  // namespace tactus
