// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/fem/energy_balance.h>

#include <cmath>
#include <utility>

namespace tactus::sim {
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
