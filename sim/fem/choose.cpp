// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>

#include "sim/fem/integrator.h"

namespace tactus {
namespace {

constexpr double kSafety = 1.05;        ///< power iteration approaches the largest frequency from below
constexpr double kExplicitLimit = 1.8;  ///< of 2: deformation and contact stiffen what was measured at rest
constexpr double kTolerance = 1e-2;  ///< of the quasi-Newton scheme: one iteration where motion is small, more where it is wild

/// Largest h omega of an undamped oscillator that is as near to instability as this one with stiffness damping (explicit.h).
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

}  // namespace

Choice choose(const FemModel& model, double step) {
  Choice choice;
  choice.options.step = step;
  choice.largest_frequency = model.largest_frequency();
  const double omega = kSafety * choice.largest_frequency, beta = model.options().stiffness_damping;
  const double reach = effective(step, omega, beta);
  const std::string numbers = text("h omega = %.3g (h %.4g ms, omega %.4g rad/s at rest with 5 %% safety%s)", reach, 1e3 * step,
                                   omega, beta > 0 ? ", stiffness damping included" : "");
  if (reach <= kExplicitLimit) {
    choice.reason =
        numbers + text(
                      " is at most %.2g: symplectic Euler is stable, and nothing costs less than its one evaluation of "
                      "the forces per step",
                      kExplicitLimit);
    return choice;
  }
  choice.options.method = Method::tr_bdf2;
  if (model.options().elasticity == Elasticity::linear) {
    choice.options.solver = LinearSolver::cholesky;
    choice.options.newton_iterations = 1;
    choice.reason =
        numbers + text(
                      " exceeds %.2g: implicit TR-BDF2; elasticity is linear, so one factorisation at the start makes "
                      "every stage one exact solve",
                      kExplicitLimit);
    return choice;
  }
  choice.options.solver = LinearSolver::prefactored;
  choice.options.newton_tolerance = kTolerance;
  choice.reason =
      numbers + text(
                    " exceeds %.2g: implicit TR-BDF2 with one factorisation, made at the start, and few solves per stage; "
                    "symplectic Euler would need a step of %.3g ms",
                    kExplicitLimit, 1e3 * stable_step(kExplicitLimit, omega, beta));
  return choice;
}

std::string divergence_remedy(const FemModel& model, const IntegratorOptions& options) {
  const double omega = kSafety * model.largest_frequency(), beta = model.options().stiffness_damping;
  if (options.method == Method::symplectic_euler && effective(options.step, omega, beta) > kExplicitLimit)
    return text(
        "symplectic-euler with h = %.4g ms is stable up to omega = %.4g rad/s, this object has %.5g%s: use tr-bdf2, or a step "
        "below %.3g ms",
        1e3 * options.step, 2 / std::sqrt(options.step * (options.step + 2 * beta)), omega,
        beta > 0 ? " and stiffness damping" : "", 1e3 * stable_step(kExplicitLimit, omega, beta));
  return text(
      "%s with h = %.4g ms (h omega = %.3g) could not follow this motion: use a step of %.3g ms, backward-euler with more Newton "
      "iterations, or smaller forces and velocities",
      name(options.method), 1e3 * options.step, options.step * omega, 250 * options.step);
}

}  // namespace tactus
