// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/transparency/rigid_transparency.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace tactus::sim {
namespace {

using Complex = std::complex<double>;

/// G_s G_o / (1 + G_s G_o), the object's position by the probe's at the server.
Complex follows(const RigidCoupling& c, Complex s) noexcept {
  const Complex server = c.server_stiffness + c.server_damping * s;
  return server / (c.mass * s * s + c.damping * s + server);
}

/// G_o / (1 + G_s G_o), the object's position by a force on it [m/N].
Complex yields(const RigidCoupling& c, Complex s) noexcept {
  return 1.0 / (c.mass * s * s + (c.damping + c.server_damping) * s + c.server_stiffness);
}

Complex client(const RigidCoupling& c, Complex s) noexcept { return c.client_stiffness + c.client_damping * s; }

}  // namespace

Complex delay_factor(double omega, double delay, DelayModel model) noexcept {
  if (model == DelayModel::exact) return std::polar(1.0, -omega * delay);
  const Complex half(0, 0.5 * omega * delay);
  return (1.0 - half) / (1.0 + half);
}

double pade_limit(double delay) noexcept { return delay > 0 ? 1 / (3 * delay) : std::numeric_limits<double>::infinity(); }

Complex force_by_velocity(const RigidCoupling& coupling, double omega, DelayModel model) noexcept {
  const Complex s(0, omega);
  return client(coupling, s) / s * (1.0 - delay_factor(omega, coupling.round_trip(), model) * follows(coupling, s));
}

Complex force_by_resistance(const RigidCoupling& coupling, double omega, DelayModel model) noexcept {
  const Complex s(0, omega);
  return client(coupling, s) * delay_factor(omega, coupling.backward, model) * yields(coupling, s);
}

double damping_of_factor(double mass, double factor, double step) noexcept { return mass * (1 - factor * factor) / (2 * step); }

double client_force(const SteadyPush& push, double client_stiffness, double server_stiffness, double round_trip) noexcept {
  return client_stiffness / server_stiffness * (round_trip * server_stiffness * push.velocity + push.server_force());
}

double excess_force(double velocity, double stiffness, double round_trip) noexcept {
  return stiffness * round_trip * std::abs(velocity);
}

std::optional<double> tolerable_delay(const SteadyPush& push, double stiffness, double weber) noexcept {
  if (push.velocity == 0) return std::nullopt;
  return weber * std::abs(push.server_force()) / (std::abs(push.velocity) * stiffness);
}

std::optional<double> tolerable_change(const SteadyPush& push, double stiffness, double round_trip, double weber) noexcept {
  if (push.velocity == 0) return std::nullopt;
  return weber * std::abs(client_force(push, stiffness, stiffness, round_trip)) / (std::abs(push.velocity) * stiffness);
}

double reduced_stiffness(const SteadyPush& push, double stiffness, double round_trip) noexcept {
  const double delayed = std::abs(client_force(push, stiffness, stiffness, round_trip));
  return delayed > 0 ? stiffness * std::abs(push.server_force()) / delayed : stiffness;
}

double resistive_force(const Vec3& resistance, const Vec3& device_velocity) noexcept {
  const double speed = norm(device_velocity);
  return speed > 0 ? -dot(resistance, device_velocity) / speed : 0;
}

double blending(const Vec3& constraint, const Vec3& face) noexcept {
  return 2 / std::numbers::pi * std::acos(std::min(std::abs(dot(constraint, face)), 1.0));
}

double reduced_stiffness(double resistive, double speed, double stiffness, double round_trip, double beta) noexcept {
  return stiffness * -resistive / (-resistive + beta * round_trip * stiffness * speed);
}

std::optional<double> tolerable_delay(double resistive, double speed, double stiffness, double weber) noexcept {
  if (speed == 0) return std::nullopt;
  return weber * -resistive / (speed * stiffness);
}

std::optional<double> tolerable_change(double resistive, double speed, double stiffness, double round_trip,
                                       double weber) noexcept {
  if (speed == 0) return std::nullopt;
  return weber * (round_trip * stiffness * speed - resistive) / (speed * stiffness);
}

}  // namespace tactus::sim
