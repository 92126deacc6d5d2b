// SPDX-License-Identifier: Apache-2.0
#include "lab/study/wall.h"

#include <algorithm>
#include <cmath>

#include <tactus/sim/user/passivity.h>

namespace tactus::sim::study {
namespace {

constexpr double kStep = 1e-6;      // [m] per sample
constexpr int kDepth = 1000;        // samples into the wall
constexpr int kReversals = 10'000;  // of the fast motion
constexpr int kSamples = 100'000;   // of a device that was let go
constexpr double kFar = 1e3;        // [m]
constexpr int kWindow = 1000;       // samples; motion that is larger in the last window than in the second one grows

/// Penetration at sample n, from outside the wall and back there.
double penetration(Motion motion, int n) {
  if (motion == Motion::slow) return kStep * (kDepth - std::abs(n - kDepth));
  if (n <= 0 || n >= 2 * kReversals) return 0;
  return n % 2 == 0 ? kStep : 2 * kStep;
}

}  // namespace

bool is_passive(const Wall& wall, double device_damping, double period, Motion motion) {
  PassivityObserver port;
  const int samples = motion == Motion::slow ? 2 * kDepth : 2 * kReversals;
  double before = 0;
  for (int n = 0; n <= samples; ++n) {
    const double p = penetration(motion, n), next = penetration(motion, n + 1);
    port.arrive({p, 0, 0});
    const double of_wall = wall.stiffness * p + wall.damping * (p - before) / period;
    port.hold({-(of_wall + device_damping * (next - p) / period), 0, 0});
    before = p;
  }
  return port.energy() >= 0;
}

bool is_stable(const Wall& wall, const Impedance& held, double period) {
  SampledMass device(held, period);
  device.move_to(1e-3, 0);
  double before = device.position(), early = 0, late = 0;
  for (int n = 0; n < kSamples; ++n) {
    const double x = device.position();
    if (!(std::abs(x) < kFar)) return false;
    if (n >= kWindow && n < 2 * kWindow) early = std::max(early, std::abs(x));
    if (n >= kSamples - kWindow) late = std::max(late, std::abs(x));
    device.step(-wall.stiffness * x - wall.damping * (x - before) / period);
    before = x;
  }
  return late <= early;
}

}  // namespace tactus::sim::study
