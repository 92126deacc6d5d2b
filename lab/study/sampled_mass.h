// SPDX-License-Identifier: Apache-2.0
/// A hand on a device in one dimension, exact between samples: m x'' + b x' + k x = u, with u held from one sample to the next.
#pragma once

#include <array>

namespace tactus::sim::study {

struct Impedance {
  double mass = 0, damping = 0, stiffness = 0;  ///< [kg], [N s/m], [N/m]
};

/// {x, v} after a sample, from those before it and the held force u.
struct Transition {
  std::array<std::array<double, 2>, 2> state{};
  std::array<double, 2> force{};
};

/// Matrix exponential over `period` [s], to rounding.
Transition transition(const Impedance& impedance, double period) noexcept;

/// Largest K [N/m] for which u = -K x, computed from every sample, does not diverge: Jury's criterion on the 2 x 2 closed loop.
double largest_spring(const Transition& transition) noexcept;

class SampledMass {
 public:
  SampledMass(const Impedance& impedance, double period) noexcept
      : transition_(tactus::sim::study::transition(impedance, period)) {}

  void step(double force) noexcept;
  double position() const noexcept { return x_; }
  double velocity() const noexcept { return v_; }
  void move_to(double x, double v) noexcept { x_ = x, v_ = v; }

 private:
  Transition transition_;
  double x_ = 0, v_ = 0;
};

}  // namespace tactus::sim::study
