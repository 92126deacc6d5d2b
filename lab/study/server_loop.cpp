// SPDX-License-Identifier: Apache-2.0
#include "lab/study/server_loop.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

namespace tactus::sim::study {
namespace {

constexpr double kPress = 1e-3;  // [m] step of every hand
constexpr std::uint32_t kPeriods = 20000;
constexpr double kGrown = 1e6;  // times what the hands move
constexpr double kSettled = 0.1;

/// Weight of the newest surface position in the mean force of a period.
double newest_weight(const ServerLoop& loop) noexcept {
  if (loop.approach == Approach::at_once || loop.decimator == Decimator::last) return 1;
  return (loop.divider + 1.0) / (2.0 * loop.divider);
}

}  // namespace

MsdLoopOptions ServerLoop::options(double stiffness) const {
  MsdLoopOptions out{.object = object, .tick = tick, .divider = divider, .decimator = decimator, .server = approach, .users = {}};
  out.users.assign(users, MsdUser{.server_stiffness = stiffness});
  return out;
}

Verdict step_response(const ServerLoop& loop, double stiffness) {
  MsdLoop simulation(loop.options(stiffness));
  const std::vector<double> device(loop.users, kPress);
  const double total = stiffness * loop.users;
  const double at_rest = kPress * total / (total + loop.object.stiffness);
  double early = 0, late = 0;
  for (std::uint32_t period = 0; period < kPeriods; ++period) {
    for (std::uint32_t tick = 0; tick < loop.divider; ++tick) simulation.step(device);
    const double strayed = std::abs(simulation.surface() - at_rest);
    if (!(strayed < kGrown * kPress * loop.users)) return Verdict::diverges;
    if (period < kPeriods / 4) early = std::max(early, strayed);
    if (period >= kPeriods - kPeriods / 4) late = std::max(late, strayed);
  }
  return late <= kSettled * early ? Verdict::stable : Verdict::limit;
}

double measured_limit(const ServerLoop& loop) {
  double low = 1, high = 2;
  while (step_response(loop, low) == Verdict::diverges) low /= 2;
  while (step_response(loop, high) != Verdict::diverges) high *= 2;
  return bisect(std::max(low, high / 2), high, 1e-4, [&](double k) { return step_response(loop, k) != Verdict::diverges; });
}

double spectral_radius(const ServerLoop& loop, double stiffness) noexcept {
  const double period = loop.period(), newest = newest_weight(loop), total = stiffness * loop.users;
  const double inertia = loop.object.mass / (period * period), viscosity = loop.object.damping / period;
  const std::complex<double> a = inertia + viscosity + loop.object.stiffness;
  const std::complex<double> b = -2 * inertia - viscosity + newest * total, c = inertia + (1 - newest) * total;
  const std::complex<double> root = std::sqrt(b * b - 4.0 * a * c);
  return std::max(std::abs((-b + root) / (2.0 * a)), std::abs((-b - root) / (2.0 * a)));
}

double jury_limit(const ServerLoop& loop) noexcept {
  const double newest = newest_weight(loop), all = critical_stiffness(loop.object, loop.period());
  if (newest == 1) return all / loop.users;
  const double other = (loop.object.stiffness + loop.object.damping / loop.period()) / (1 - newest);
  return std::min(other, all / (2 * newest - 1)) / loop.users;
}

}  // namespace tactus::sim::study
