// SPDX-License-Identifier: Apache-2.0
/// Virtual coupling of probe and proxy: the force that the hand feels. Thesis eqs. 2.6 (spring) and 2.7 (spring and damper).
#pragma once

#include <limits>

#include "codec/base/geometry.h"

namespace tactus::sim {

struct Coupling {
  double stiffness = 0;                                        ///< [N/m] k_o > 0
  double damping = 0;                                          ///< [Ns/m] b_o >= 0; 0: eq. 2.6
  double max_force = std::numeric_limits<double>::infinity();  ///< [N] what the device can show
};

/// A point and how fast it moves.
struct Motion {
  Vec3 position;  ///< [m]
  Vec3 velocity;  ///< [m/s]
};

/// f_d = k_o (x_p - x_d) + b_o (x_p' - x_d'), shortened to the device's limit.
/// out  [N] on the hand.   time O(1), no allocation
inline Vec3 coupling_force(const Coupling& coupling, const Motion& proxy, const Motion& device) noexcept {
  const Vec3 force =
      coupling.stiffness * (proxy.position - device.position) + coupling.damping * (proxy.velocity - device.velocity);
  const double size = norm(force);
  return size > coupling.max_force ? (coupling.max_force / size) * force : force;
}

}  // namespace tactus::sim
