// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/user/sampled_limit.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

namespace tactus::sim {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();

/// The loop at z = e^jw: the hand without the spring, and the factor of k.
struct Response {
  std::complex<double> hand, filter;
};

Response at(double w, const HandImpedance& hand, double samples) {
  const std::complex<double> step = 1.0 - std::polar(1.0, -w);
  return {hand.mass * 2 * (std::cos(w) - 1) / (kTick * kTick) + hand.stiffness + hand.damping * step / kTick,
          (1.0 - std::polar(1.0, -w * samples)) / (samples * step)};
}

/// The k that makes the imaginary part zero, and the real part that remains.
struct Crossing {
  double stiffness, rest;
};

Crossing crossing(double w, const HandImpedance& hand, double samples) {
  const Response r = at(w, hand, samples);
  const double k = -r.hand.imag() / r.filter.imag();
  return {k, r.hand.real() + k * r.filter.real()};
}

}  // namespace

double sampled_limit(const HandImpedance& hand, const SceneDevice& device) noexcept {
  const double n = device.filter;
  // z = -1, where no delay turns the phase
  const Response fastest = at(std::numbers::pi, hand, n);
  double limit = device.filter % 2 == 1 ? -fastest.hand.real() / fastest.filter.real() : kNone;
  const int steps = 500 + 32 * static_cast<int>(device.filter);  // the mean's response has a zero at every 2 pi / N
  Crossing last{kNone, kNone};
  double from = 0;
  for (int i = 1; i < steps && device.filter > 1; ++i) {
    const double w = std::numbers::pi * i / steps;
    const Crossing now = crossing(w, hand, n);
    if (last.stiffness > 0 && now.stiffness > 0 && last.rest > 0 && now.rest <= 0) {
      double low = from, high = w;
      for (int k = 0; k < 50; ++k) (crossing((low + high) / 2, hand, n).rest > 0 ? low : high) = (low + high) / 2;
      limit = std::min(limit, crossing(low, hand, n).stiffness);
    }
    last = now;
    from = w;
  }
  return std::max(0.0, limit);
}

}  // namespace tactus::sim
