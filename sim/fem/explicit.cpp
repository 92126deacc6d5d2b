// SPDX-License-Identifier: Apache-2.0
#include "sim/fem/explicit.h"

namespace tactus {

SymplecticEuler::SymplecticEuler(FemModel& model, const IntegratorOptions& options)
    : Guarded(model, options),
      k_(model.size()),
      ahead_(model.size()),
      decay_(Eigen::VectorXd::Zero(model.size())),
      kick_(decay_) {
  const double decay = 1 / (1 + h() * model.options().mass_damping);
  const bool lumped = model.options().mass == MassMatrix::lumped;
  for (const int i : model.free_dofs()) {
    decay_[i] = decay;
    kick_[i] = h() * decay / (lumped ? model.lumped_mass()[i] : 1.0);
  }
  if (lumped || model.free_dofs().empty()) return;
  free_.resize(static_cast<Eigen::Index>(model.free_dofs().size()));
  mass_.emplace().analyse(model.mass_matrix());
  mass_->factor(model.mass_matrix());  // a sum of positive definite element matrices
}

tl::expected<StepReport, FemError> SymplecticEuler::advance(const Eigen::VectorXd& f, const FemState& state, FemState& next) {
  const double beta = model().options().stiffness_damping;
  if (beta > 0) {
    ahead_ = state.u + beta * state.v;
    model().internal_forces(ahead_, k_);
  } else {
    model().internal_forces(state.u, k_);
  }
  k_ = f - k_;
  if (mass_) {
    const auto dofs = model().free_dofs();
    for (std::size_t i = 0; i < dofs.size(); ++i) free_[static_cast<Eigen::Index>(i)] = k_[dofs[i]];
    mass_->solve(free_, free_);
    for (std::size_t i = 0; i < dofs.size(); ++i) k_[dofs[i]] = free_[static_cast<Eigen::Index>(i)];
  }
  next.v = decay_.cwiseProduct(state.v) + kick_.cwiseProduct(k_);
  next.u = state.u + h() * next.v;
  return StepReport{};
}

}  // namespace tactus
