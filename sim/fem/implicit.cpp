// SPDX-License-Identifier: Apache-2.0
#include "sim/fem/implicit.h"

#include <numbers>
#include <utility>

namespace tactus {
namespace {

constexpr double kGamma = 2 - std::numbers::sqrt2;  ///< share of the trapezoidal stage: both stages have the same c

}  // namespace

double Implicit::stage_step(Scheme scheme, double h) noexcept {
  switch (scheme) {
    case Scheme::backward_euler:
      return h;
    case Scheme::newmark:
      return h / 2;
    case Scheme::tr_bdf2:
      return kGamma * h / 2;
  }
  return h;
}

Implicit::Implicit(FemModel& model, const IntegratorOptions& options, Scheme scheme, std::unique_ptr<Direction> direction)
    : Guarded(model, options),
      scheme_(scheme),
      extrapolate_(options.method == Method::projective || options.solver == LinearSolver::prefactored),
      newton_(model, options, std::move(direction)),
      u_(newton_.system().size()),
      v_(u_),
      u0_(u_),
      v0_(u_),
      k_(u_) {
  stage_ = {stage_step(scheme, h()), u_, u_, u_};
}

tl::expected<StepReport, FemError> Implicit::advance(const Eigen::VectorXd& f, const FemState& state, FemState& next) {
  newton_.system().gather(f, stage_.f);
  newton_.system().gather(state.u, u_);
  newton_.system().gather(state.v, v_);
  auto report = scheme_ == Scheme::backward_euler ? backward_euler() : scheme_ == Scheme::newmark ? trapezoidal(h()) : tr_bdf2();
  if (!report) return report;
  next.u = state.u;
  next.v.setZero();
  newton_.system().scatter(u_, next.u);
  newton_.system().scatter(v_, next.v);
  return report;
}

/// Solve the stage from the start in u, and take its velocity.
tl::expected<StepReport, FemError> Implicit::solve() {
  auto report = newton_.solve(stage_, u_);
  if (report) v_ = (u_ - stage_.a) / stage_.c;
  return report;
}

tl::expected<StepReport, FemError> Implicit::backward_euler() {
  stage_.a = u_;
  stage_.Mb.noalias() = model().mass_matrix() * v_;
  if (extrapolate_) u_ += h() * v_;
  return solve();
}

/// Starting from u0 + duration v0 makes one iteration second-order: what the update has to correct is small by then.
tl::expected<StepReport, FemError> Implicit::trapezoidal(double duration) {
  const double c = stage_.c;
  stage_.Mb.noalias() = (1 - c * newton_.system().alpha()) * (model().mass_matrix() * v_);
  if (newton_.evaluated() && !edited()) newton_.system().last_forces(k_);
  else newton_.system().forces(u_, v_, k_);
  stage_.Mb += c * (stage_.f - k_);
  stage_.a = u_ + c * v_;
  u_ += duration * v_;
  return solve();
}

tl::expected<StepReport, FemError> Implicit::tr_bdf2() {
  constexpr double kOld = (1 - kGamma) * (1 - kGamma) / (kGamma * (2 - kGamma)), kNew = 1 + kOld;
  u0_ = u_;
  v0_ = v_;
  auto report = trapezoidal(kGamma * h());
  if (!report) return report;
  stage_.a = kNew * u_ - kOld * u0_;
  v0_ = kNew * v_ - kOld * v0_;
  stage_.Mb.noalias() = model().mass_matrix() * v0_;
  u_ += (1 - kGamma) * h() * v_;
  auto second = solve();
  if (!second) return second;
  return StepReport{report->newton_iterations + second->newton_iterations, report->solver_iterations + second->solver_iterations,
                    report->converged && second->converged};
}

}  // namespace tactus
