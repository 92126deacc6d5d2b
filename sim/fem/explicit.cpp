// SPDX-License-Identifier: Apache-2.0
#include <tactus/base/elementary.h>
#include <tactus/sim/fem/explicit.h>

#include <cmath>

namespace tactus::sim {

VelocityVerlet::VelocityVerlet(FemModel& model, const IntegratorOptions& options)
    : CheckedIntegrator(model, options),
      part_(h() / options.substeps),
      decay_(Eigen::VectorXd::Zero(model.size())),
      kick_(decay_),
      k_(kick_),
      scratch_(kick_) {
  // u^2 omega^2 + v^2 of an oscillator swings between 1 and this; beyond the limit of stability it grows without end.
  const double reach = part_ * model.largest_frequency() / 2;
  if (reach < 1) swing_ = 1 / (1 - reach * reach);
  const double alpha = model.options().mass_damping;
  const double kick = alpha > 0 ? -exponential_less_one(-part_ / 2 * alpha) / alpha : part_ / 2;
  const bool lumped = model.options().mass == MassMatrix::lumped;
  for (const int i : model.free_dofs()) {
    decay_[i] = exponential(-part_ / 2 * alpha);
    kick_[i] = kick / (lumped ? model.lumped_mass()[i] : 1.0);
  }
  if (lumped || model.free_dofs().empty()) return;
  free_.resize(static_cast<Eigen::Index>(model.free_dofs().size()));
  mass_.emplace().analyse(model.mass_matrix());
  mass_->factor(model.mass_matrix());  // a sum of positive definite element matrices
}

void VelocityVerlet::forces(const Eigen::VectorXd& u, const Eigen::VectorXd& v) {
  const double beta = model().options().stiffness_damping;
  if (beta == 0) return model().internal_forces(u, k_);
  scratch_ = u + beta * v;
  model().internal_forces(scratch_, k_);
}

void VelocityVerlet::half_kick(const Eigen::VectorXd& f, Eigen::VectorXd& v) {
  if (!mass_) {
    v = decay_.cwiseProduct(v) + kick_.cwiseProduct(f - k_);
    return;
  }
  const auto dofs = model().free_dofs();
  for (std::size_t i = 0; i < dofs.size(); ++i) free_[static_cast<Eigen::Index>(i)] = f[dofs[i]] - k_[dofs[i]];
  mass_->solve(free_, free_);
  v.array() *= decay_.array();
  for (std::size_t i = 0; i < dofs.size(); ++i) v[dofs[i]] += kick_[dofs[i]] * free_[static_cast<Eigen::Index>(i)];
}

tl::expected<StepReport, Diagnostic> VelocityVerlet::advance(const Eigen::VectorXd& f, const FemState& state, FemState& next) {
  if (edited()) forces(state.u, state.v);
  next.u = state.u;
  next.v = state.v;
  for (int i = 0; i < options().substeps; ++i) {
    half_kick(f, next.v);
    next.u += part_ * next.v;
    forces(next.u, next.v);
    half_kick(f, next.v);
  }
  return StepReport{};
}

}  // namespace tactus::sim
