// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/fem/error_estimate.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace tactus::sim {

// ==== error estimate ====

namespace {

constexpr std::size_t kMost = 4096;  ///< samples; when full, every second sample is dropped and the sampling interval doubles

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
  errors_.reserve(kMost);
}

void ErrorEstimate::look(const Eigen::VectorXd& f, const FemState& state) {
  if (calls_++ % every_ != 0) return;
  if (errors_.size() == kMost) {
    for (std::size_t i = 0; i < kMost / 2; ++i) errors_[i] = errors_[2 * i];
    errors_.resize(kMost / 2);
    every_ *= 2;
  }
  errors_.push_back(relative_error(f, state));
}

double ErrorEstimate::relative_error(const Eigen::VectorXd& f, const FemState& state) {
  coarse_ = state;
  fine_ = state;
  if (!whole_->integrator->step(f, coarse_)) return std::numeric_limits<double>::infinity();
  for (int i = 0; i < 2; ++i)
    if (!half_->integrator->step(f, fine_)) return std::numeric_limits<double>::infinity();
  const double size = fine_.u.norm();
  return size == 0 ? 0 : order_factor_ * (coarse_.u - fine_.u).norm() / size;
}

ErrorEstimate::Result ErrorEstimate::result() const {
  if (errors_.empty()) return {};
  std::vector<double> sorted = errors_;
  std::sort(sorted.begin(), sorted.end());
  return {sorted[sorted.size() / 2], sorted.back(), static_cast<std::int64_t>(sorted.size())};
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
