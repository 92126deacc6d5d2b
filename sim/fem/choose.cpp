// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>

#include <tactus/sim/fem/integrator.h>

namespace tactus::sim {
namespace {

constexpr double kExplicitLimit = 1.8;  ///< of 2: deformation and contact stiffen the object
/// Cost of a step of TR-BDF2 in evaluations of the forces. Measured on the membrane: 11 in slow motion, 60 in fast. This many
/// sub-steps cost no more and are more accurate: each has the error of a step many times shorter.
constexpr int kWorthwhile = 12;
constexpr double kTolerance = 1e-4;  ///< of the quasi-Newton scheme; at 1e-2 a turning object visibly brakes

/// h omega of the undamped oscillator that is as close to instability as this one with stiffness damping (explicit.h).
double effective(double h, double omega, double beta) { return omega * std::sqrt(h * (h + 2 * beta)); }

/// Step with which effective() is `limit`.
double stable_step(double limit, double omega, double beta) {
  const double square = limit * limit / (omega * omega);
  return square / (beta + std::sqrt(beta * beta + square));
}

[[gnu::format(printf, 1, 2)]] std::string text(const char* format, ...) {
  char buffer[320];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(buffer, sizeof buffer, format, arguments);
  va_end(arguments);
  return buffer;
}

const char* how(const IntegratorOptions& options) {
  if (options.solver == LinearSolver::prefactored) return "with one factorisation, made at the start, and few solves per stage";
  if (options.newton_iterations == 1)
    return "with one factorisation at the start: elasticity is linear, and every stage one solve";
  return "with a factorisation in every iteration, which an object that is nearly incompressible takes";
}

}  // namespace

double largest_poisson(const FemModel& model) noexcept {
  double out = -1;
  for (const Material& material : model.options().materials) out = std::max(out, material.poisson);
  return out;
}

IntegratorOptions suited(const FemModel& model, Method method, double step) {
  IntegratorOptions options;
  options.method = method;
  options.step = step;
  if (method == Method::velocity_verlet) return options;
  if (model.options().elasticity == Elasticity::linear) {
    options.solver = LinearSolver::cholesky;
    options.newton_iterations = 1;
  } else if (largest_poisson(model) > kNearlyIncompressible) {
    options.solver = LinearSolver::cholesky;
  } else {
    options.solver = LinearSolver::prefactored;
    options.newton_tolerance = kTolerance;
  }
  return options;
}

Choice choose(const FemModel& model, double step) {
  const double omega = model.largest_frequency(), beta = model.options().stiffness_damping;
  const double reach = effective(step, omega, beta), longest = omega > 0 ? stable_step(kExplicitLimit, omega, beta) : step;
  const std::string numbers = text("h omega = %.3g (h %.4g ms, omega %.4g rad/s at rest%s)", reach, 1e3 * step, omega,
                                   beta > 0 ? ", stiffness damping included" : "");
  const double parts = std::max(1.0, std::ceil(step / longest));
  Choice choice{suited(model, Method::velocity_verlet, step), omega, {}};
  if (parts == 1) {
    choice.reason =
        numbers + text(
                      " is at most %.2g: velocity Verlet is stable, and nothing costs less than its one evaluation of "
                      "the forces per step",
                      kExplicitLimit);
  } else if (parts <= kWorthwhile) {
    choice.options.substeps = static_cast<int>(parts);
    choice.reason = numbers + text(
                                  ": %g sub-steps of velocity Verlet, stable up to %.2g each, cost %g evaluations of the forces; "
                                  "an implicit step costs as much as %d or more and errs more",
                                  parts, kExplicitLimit, parts, kWorthwhile);
  } else {
    choice.options = suited(model, Method::tr_bdf2, step);
    choice.reason = numbers + text(": velocity Verlet would need %g sub-steps, and %d cost as much as one of implicit TR-BDF2 %s",
                                   parts, kWorthwhile, how(choice.options));
  }
  return choice;
}

std::string divergence_remedy(const FemModel& model, const IntegratorOptions& options) {
  const double omega = model.largest_frequency(), beta = model.options().stiffness_damping;
  const double part = options.step / options.substeps;
  if (options.method == Method::velocity_verlet && effective(part, omega, beta) >= 2)
    return text(
        "velocity-verlet with h = %.4g ms is stable up to omega = %.5g rad/s, this object has %.5g%s: use tr-bdf2, or a step "
        "below "
        "%.3g ms",
        1e3 * part, 2 / std::sqrt(part * (part + 2 * beta)), omega, beta > 0 ? " and stiffness damping" : "",
        1e3 * stable_step(kExplicitLimit, omega, beta));
  const bool iterates = options.method != Method::velocity_verlet && options.method != Method::modal;
  const bool quasi = options.method == Method::projective || options.solver == LinearSolver::prefactored;
  return text(
      "%s with h = %.4g ms (h omega = %.3g) could not follow this motion: use a step of %.3g ms%s, or smaller forces and "
      "velocities",
      name(options.method), 1e3 * part, part * omega, 250 * part,
      !iterates                                  ? ""
      : quasi                                    ? ", the solver cholesky"
      : options.method == Method::backward_euler ? ""
                                                 : ", backward-euler");
}

}  // namespace tactus::sim
