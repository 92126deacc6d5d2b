// SPDX-License-Identifier: Apache-2.0
#include "lab/study/sampled_mass.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tactus::sim::study {
namespace {

using Matrix = std::array<std::array<double, 3>, 3>;

Matrix product(const Matrix& a, const Matrix& b) noexcept {
  Matrix out{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t k = 0; k < 3; ++k) out[i][j] += a[i][k] * b[k][j];
  return out;
}

}  // namespace

Transition transition(const Impedance& impedance, double period) noexcept {
  // Exponential of the system {x, v, u}: the series over a part of the period that is short enough, then squared repeatedly.
  const double rate = impedance.damping / impedance.mass + std::sqrt(impedance.stiffness / impedance.mass) + 1 / period;
  const int halvings = std::max(0, static_cast<int>(std::ceil(std::log2(rate * period)))) + 4;
  const double h = std::ldexp(period, -halvings);
  const Matrix a{{{0, h, 0},
                  {-h * impedance.stiffness / impedance.mass, -h * impedance.damping / impedance.mass, h / impedance.mass},
                  {0, 0, 0}}};
  Matrix sum{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, term = sum;
  for (int n = 1; n <= 12; ++n) {
    term = product(term, a);
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) sum[i][j] += (term[i][j] /= n);
  }
  for (int n = 0; n < halvings; ++n) sum = product(sum, sum);
  return {.state = {{{sum[0][0], sum[0][1]}, {sum[1][0], sum[1][1]}}}, .force = {sum[0][2], sum[1][2]}};
}

double largest_spring(const Transition& t) noexcept {
  // The closed loop has trace = trace0 - K a and determinant = determinant0 + K b. Stable: |determinant| < 1 and
  // |trace| < 1 + determinant; each of these is a bound on K.
  const double trace = t.state[0][0] + t.state[1][1];
  const double determinant = t.state[0][0] * t.state[1][1] - t.state[0][1] * t.state[1][0];
  const double a = t.force[0], b = t.force[1] * t.state[0][1] - t.force[0] * t.state[1][1];
  double limit = std::numeric_limits<double>::infinity();
  const auto bound = [&limit](double slack, double slope) {
    if (slope > 0) limit = std::fmin(limit, std::fmax(slack, 0) / slope);
  };
  bound(1 - determinant, b);
  bound(1 + trace + determinant, a - b);
  return limit;
}

void SampledMass::step(double force) noexcept {
  const auto& [state, input] = transition_;
  const double x = state[0][0] * x_ + state[0][1] * v_ + input[0] * force;
  v_ = state[1][0] * x_ + state[1][1] * v_ + input[1] * force;
  x_ = x;
}

}  // namespace tactus::sim::study
