// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/fem/error_estimate.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace tactus::sim {

// ==== error estimate ====

namespace {

int order(Method method) { return method == Method::backward_euler || method == Method::projective ? 1 : 2; }

}  // namespace

tl::expected<std::unique_ptr<ErrorEstimate::Copy>, Diagnostic> ErrorEstimate::copy(const FemModel& model,
                                                                                   const IntegratorOptions& options) {
  TACTUS_TRY(auto again, FemModel::create(model.mesh(), model.options()));
  auto made = std::make_unique<Copy>(Copy{std::move(again), nullptr});
  TACTUS_TRY(auto integrator, make_integrator(made->model, options));
  made->integrator = std::move(integrator);
  return made;
}

tl::expected<ErrorEstimate, Diagnostic> ErrorEstimate::create(const FemModel& model, const IntegratorOptions& options,
                                                              std::int64_t every) {
  TACTUS_TRY(auto whole, copy(model, options));
  IntegratorOptions halved = options;
  halved.step /= 2;
  TACTUS_TRY(auto half, copy(model, halved));
  return ErrorEstimate(std::move(whole), std::move(half), std::max<std::int64_t>(every, 1));
}

ErrorEstimate::ErrorEstimate(std::unique_ptr<Copy> whole, std::unique_ptr<Copy> half, std::int64_t every)
    : whole_(std::move(whole)), half_(std::move(half)), every_(every), coarse_(whole_->model.rest()), fine_(coarse_) {
  const double power = 1 << order(whole_->integrator->options().method);
  order_factor_ = power / (power - 1);
}

void ErrorEstimate::look(const Eigen::VectorXd& f, const FemState& state) {
  if (calls_++ % every_ != 0) return;
  coarse_ = state;
  fine_ = state;
  if (!whole_->integrator->step(f, coarse_)) return;
  for (int i = 0; i < 2; ++i)
    if (!half_->integrator->step(f, fine_)) return;
  const double error2 = order_factor_ * order_factor_ * (coarse_.u - fine_.u).squaredNorm();
  errors2_ += error2;
  largest2_ = std::max(largest2_, error2);
  motions2_ += (fine_.u - state.u).squaredNorm();
  ++samples_;
}

ErrorEstimate::Result ErrorEstimate::result() const noexcept {
  if (motions2_ == 0) return {.samples = samples_};
  const double motion2 = motions2_ / static_cast<double>(samples_);
  return {std::sqrt(errors2_ / motions2_), std::sqrt(largest2_ / motion2), samples_};
}

// ==== energy balance ====

namespace {

constexpr int kEvery = 16;

double twice_kinetic(const FemModel& model, const Eigen::VectorXd& v) noexcept { return v.cwiseAbs2().dot(model.lumped_mass()); }

}  // namespace

tl::expected<EnergyBalance, Diagnostic> EnergyBalance::create(const FemModel& model) {
  TACTUS_TRY(auto again, FemModel::create(model.mesh(), model.options()));
  return EnergyBalance(std::move(again));
}

EnergyBalance::EnergyBalance(FemModel model)
    : model_(std::move(model)), last_(model_.rest()), ahead_(last_.u), with_(last_.u), without_(last_.u) {}

void EnergyBalance::add(const Eigen::VectorXd& f, double h, const FemState& after) noexcept {
  const double work = f.dot(after.u - last_.u), alpha = model_.options().mass_damping, beta = model_.options().stiffness_damping;
  work_ += work;
  moved_ += std::abs(work);
  const double mass_power = alpha * twice_kinetic(model_, after.v);
  damped_ += h / 2 * (mass_power_ + mass_power);
  mass_power_ = mass_power;
  last_.u = after.u;
  last_.v = after.v;
  since_ += h;
  if (beta == 0 || ++steps_ % kEvery != 0) return;
  ahead_ = after.u + beta * after.v;
  model_.internal_forces(ahead_, with_);
  model_.internal_forces(after.u, without_);
  with_ -= without_;
  const double power = after.v.dot(with_);
  damped_ += since_ / 2 * (stiffness_power_ + power);
  stiffness_power_ = power;
  since_ = 0;
}

EnergyBalance::Result EnergyBalance::result() noexcept {
  const double energy = model_.energy(last_.u) + twice_kinetic(model_, last_.v) / 2;
  return {moved_, energy - work_ + damped_};
}

}  // namespace tactus::sim
