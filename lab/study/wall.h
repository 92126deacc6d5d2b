// SPDX-License-Identifier: Apache-2.0
/// A sampled virtual wall: f = K p + B dp/T for a penetration p, held for a sample. Thesis 2.2.2.
#pragma once

#include <cstdint>

#include "lab/study/sampled_mass.h"

namespace tactus::sim::study {

struct Wall {
  double stiffness = 0;  ///< K [N/m]
  double damping = 0;    ///< B [N s/m]
};

/// How a hand that yields to nothing moves the device. Both are straight between samples: of all motions through the same samples
/// these lose least energy in the device's damper, so the limit found holds for every hand.
///   slow  in by a thousandth of the depth per sample, and out again
///   fast  to and fro at every sample, at half the sampling rate
enum class Motion : std::uint8_t { slow, fast };

/// Whether a passivity observer between this hand and the device (damping b_d) in front of the wall sees no more energy come out than
/// went in, over the whole motion.
bool is_passive(const Wall& wall, double device_damping, double period, Motion motion);

/// A hand on the device, tied to the wall at 1 mm and let go: does it stay within bounds?
bool is_stable(const Wall& wall, const Impedance& held, double period);

}  // namespace tactus::sim::study
