// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/transparency/deformable_transparency.h>

#include <algorithm>
#include <cmath>

namespace tactus::sim {
namespace {

using Complex = std::complex<double>;

double square(double x) noexcept { return x * x; }

Complex impedance(const DeformableCoupling& c, double omega, double round_trip, Complex follows) noexcept {
  const Complex s(0, omega);
  return (c.client_stiffness + c.client_damping * s) * (1.0 - std::polar(1.0, -omega * round_trip) * follows) / s;
}

/// |k_o + k_s - k_s e^(-j omega R)|^2, the yielding of object and delay together.
double yielding(const DeformableCoupling& c, double stiffness, double omega, double round_trip) noexcept {
  const double sum = c.object_stiffness + stiffness;
  return square(sum) - 2 * stiffness * sum * std::cos(omega * round_trip) + square(stiffness);
}

}  // namespace

Complex follows(const DeformableCoupling& coupling, double omega) noexcept {
  const Complex s(0, omega);
  return coupling.server_stiffness /
         (coupling.object_mass * s * s + coupling.object_damping * s + coupling.object_stiffness + coupling.server_stiffness);
}

double follows_slowly(const DeformableCoupling& coupling) noexcept {
  return coupling.server_stiffness / (coupling.object_stiffness + coupling.server_stiffness);
}

Complex client_impedance(const DeformableCoupling& coupling, double omega, double round_trip) noexcept {
  return impedance(coupling, omega, round_trip, follows(coupling, omega));
}

Complex server_impedance(const DeformableCoupling& coupling, double omega) noexcept {
  return coupling.server_stiffness * (1.0 - follows(coupling, omega)) / Complex(0, omega);
}

Complex slow_client_impedance(const DeformableCoupling& coupling, double omega, double round_trip) noexcept {
  return impedance(coupling, omega, round_trip, follows_slowly(coupling));
}

std::optional<double> tolerable_delay(const DeformableCoupling& coupling, double omega, double weber) noexcept {
  const double ratio = follows_slowly(coupling);
  const double stiffness = square(coupling.client_stiffness), damper = square(coupling.client_damping * omega);
  const double cosine = ((1 + square(ratio)) * (stiffness + damper) - square((1 + weber) * (1 - ratio)) * stiffness) /
                        (2 * ratio * (stiffness + damper));
  if (!(std::abs(cosine) <= 1)) return std::nullopt;
  return std::acos(cosine) / omega;
}

double reduced_stiffness(const DeformableCoupling& coupling, double omega, double round_trip) noexcept {
  const double k = coupling.server_stiffness;
  const double wanted = square(coupling.object_stiffness) / yielding(coupling, k, omega, round_trip);
  return k * std::sqrt(std::max(wanted - square(coupling.client_damping * omega / k), 0.0));
}

double reduced_stiffness_undamped(const DeformableCoupling& coupling, double omega, double round_trip) noexcept {
  const double k = coupling.client_stiffness;
  return k * coupling.object_stiffness / std::sqrt(yielding(coupling, k, omega, round_trip));
}

}  // namespace tactus::sim
