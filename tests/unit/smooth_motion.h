// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>

#include "tests/unit/rigid_fixture.h"

namespace tactus::testing {

/// Smooth motion of one object, exact to the grid.
inline RigidState along(std::int64_t tick, bool moves) {
  const double t = 1e-3 * static_cast<double>(tick), angle = 2 * std::sin(1.5 * t + 0.3);
  const Vec3 axis{0.6, 0, 0.8};
  RigidSample sample;
  sample.pose.position = {0.1 * std::sin(3 * t), 0.2 * std::cos(2 * t), 0.3 * t * t};
  sample.pose.rotation = {std::cos(angle / 2), axis.x * std::sin(angle / 2), axis.y * std::sin(angle / 2),
                          axis.z * std::sin(angle / 2)};
  if (moves) {
    sample.velocity = {0.3 * std::cos(3 * t), -0.4 * std::sin(2 * t), 0.6 * t};
    sample.angular_velocity = 3 * std::cos(1.5 * t + 0.3) * axis;
  }
  return to_grid(sample, tick, scene_of(1)->grid).value();
}

}  // namespace tactus::testing
