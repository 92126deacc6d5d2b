// SPDX-License-Identifier: Apache-2.0
#include "sim/user/sampled_limit.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

namespace tactus {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();

/// The loop at z = e^jw: without the spring, and what multiplies k.
struct Response {
  std::complex<double> hand, filter;
};

Response at(double w, const HandImpedance& hand, std::uint32_t samples) {
  const std::complex<double> back = std::polar(1.0, -w);
  std::complex<double> filter, delayed = 1;
  for (std::uint32_t i = 0; i < samples; ++i, delayed *= back) filter += delayed;
  return {hand.mass * 2 * (std::cos(w) - 1) / (kTick * kTick) + hand.stiffness + hand.damping * (1.0 - back) / kTick,
          filter / static_cast<double>(samples)};
}

/// The k with which the imaginary part vanishes, and what is left of the real one.
struct Crossing {
  double stiffness, rest;
};

Crossing crossing(double w, const HandImpedance& hand, std::uint32_t samples) {
  const Response r = at(w, hand, samples);
  const double k = -r.hand.imag() / r.filter.imag();
  return {k, r.hand.real() + k * r.filter.real()};
}

}  // namespace

double sampled_limit(const HandImpedance& hand, const SceneDevice& device) noexcept {
  const std::uint32_t n = device.filter;
  // z = -1
  const Response fastest = at(std::numbers::pi, hand, n);
  double limit = n % 2 == 1 ? -fastest.hand.real() / fastest.filter.real() : kNone;
  if (n == 1) return std::max(0.0, limit);  // the only way out: no delay turns the phase
  constexpr int kSteps = 2000;
  Crossing last{kNone, kNone};
  double from = 0;
  for (int i = 1; i < kSteps; ++i) {
    const double w = std::numbers::pi * i / kSteps;
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

}  // namespace tactus
