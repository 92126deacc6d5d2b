// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/fem/modal.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <tactus/sim/fem/linear_solver.h>

namespace tactus::sim {
namespace {

/// Exponential of the step's matrix by its Taylor series, scaled and squared, for any lambda and damping, zero and critical included.
Eigen::Matrix<double, 2, 3> exact_step(double lambda, double damping, double h) {
  Eigen::Matrix3d A;
  A << 0, 1, 0, -lambda * h * h, -damping * h, 1, 0, 0, 0;
  const double size = A.cwiseAbs().rowwise().sum().maxCoeff();
  const int halvings = std::max(0, std::ilogb(size) + 3);
  A /= std::ldexp(1.0, halvings);
  Eigen::Matrix3d sum = Eigen::Matrix3d::Identity(), term = sum;
  for (int i = 1; i <= 16; ++i) {
    term = term * A / i;
    sum += term;
  }
  for (int i = 0; i < halvings; ++i) sum = sum * sum;
  return sum.topRows<2>();
}

}  // namespace

tl::expected<Modes, Diagnostic> slowest_modes(FemModel& model, int count) {
  SparseMatrix K;
  model.stiffness(Eigen::VectorXd::Zero(model.size()), K);
  auto modes = slowest_modes(K, model.mass_matrix(), count);
  if (!modes) return tl::unexpected(not_positive_definite());
  return *std::move(modes);
}

tl::expected<std::unique_ptr<Integrator>, Diagnostic> Modal::create(FemModel& model, const IntegratorOptions& options) {
  TACTUS_TRY(auto modes, slowest_modes(model, options.modes));
  return std::unique_ptr<Integrator>(new Modal(model, options, std::move(modes)));
}

Modal::Modal(FemModel& model, const IntegratorOptions& options, Modes modes)
    : CheckedIntegrator(model, options),
      modes_(std::move(modes)),
      weighted_(model.mass_matrix() * modes_.shapes),
      q_(Eigen::VectorXd::Zero(modes_.squares.size())),
      rate_(q_),
      force_(q_),
      free_(modes_.shapes.rows()) {
  for (const double lambda : modes_.squares)
    recurrence_.push_back(
        exact_step(lambda, model.options().mass_damping + model.options().stiffness_damping * lambda, options.step));
}

tl::expected<StepReport, Diagnostic> Modal::advance(const Eigen::VectorXd& f, const FemState& state, FemState& next) {
  const auto dofs = model().free_dofs();
  const auto gather = [&](const Eigen::VectorXd& full) {
    for (std::size_t i = 0; i < dofs.size(); ++i) free_[static_cast<Eigen::Index>(i)] = full[dofs[i]];
  };
  const auto expand = [&](const Eigen::VectorXd& q, Eigen::VectorXd& full) {
    free_.noalias() = modes_.shapes * q;
    full.setZero();
    for (std::size_t i = 0; i < dofs.size(); ++i) full[dofs[i]] = free_[static_cast<Eigen::Index>(i)];
  };
  if (edited()) {
    gather(state.u);
    q_.noalias() = weighted_.transpose() * free_;
    gather(state.v);
    rate_.noalias() = weighted_.transpose() * free_;
  }
  gather(f);
  force_.noalias() = modes_.shapes.transpose() * free_;
  for (std::size_t i = 0; i < recurrence_.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const Eigen::Vector2d after = recurrence_[i] * Eigen::Vector3d(q_[k], h() * rate_[k], h() * h() * force_[k]);
    q_[k] = after[0];
    rate_[k] = after[1] / h();
  }
  expand(q_, next.u);
  expand(rate_, next.v);
  return StepReport{};
}

}  // namespace tactus::sim
