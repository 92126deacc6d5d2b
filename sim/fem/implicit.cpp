// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/fem/implicit.h>

#include <numbers>
#include <utility>

namespace tactus::sim {
namespace {

constexpr double kGamma = 2 - std::numbers::sqrt2;  ///< fraction of the trapezoidal stage: both stages have the same c

StepReport operator+(const StepReport& a, const StepReport& b) {
  return {a.newton_iterations + b.newton_iterations, a.solver_iterations + b.solver_iterations, a.converged && b.converged};
}

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

Implicit::Implicit(FemModel& model, const IntegratorOptions& options, Scheme scheme, std::unique_ptr<DescentDirection> direction)
    : CheckedIntegrator(model, options),
      scheme_(scheme),
      extrapolate_(options.method == Method::projective || options.solver == LinearSolver::prefactored),
      newton_(model, options, std::move(direction)),
      u_(newton_.system().size()),
      v_(u_),
      u0_(u_),
      v0_(u_),
      k_(u_),
      start_u_(u_),
      start_v_(u_) {
  stage_ = {stage_step(scheme, h()), u_, u_, u_};
}

tl::expected<StepReport, Diagnostic> Implicit::advance(const Eigen::VectorXd& f, const FemState& state, FemState& next) {
  newton_.system().gather(f, stage_.f);
  newton_.system().gather(state.u, u_);
  newton_.system().gather(state.v, v_);
  auto report = scheme_ == Scheme::backward_euler ? backward_euler() : second_order();
  if (!report) return report;
  next.u = state.u;
  next.v.setZero();
  newton_.system().scatter(u_, next.u);
  newton_.system().scatter(v_, next.v);
  return report;
}

tl::expected<StepReport, Diagnostic> Implicit::second_order() {
  StepReport report{0, 0, true};
  start_u_ = u_;
  start_v_ = v_;
  if (!fallback_) {
    stage_.c = stage_step(scheme_, h());
    auto done = scheme_ == Scheme::newmark ? trapezoidal(h()) : tr_bdf2();
    if (!done || !newton_.diverged()) return done;
    report = *done;
    u_ = start_u_;
    v_ = start_v_;
  }
  stage_.c = h();
  const auto done = backward_euler();
  fallback_ = newton_.diverged();
  return done ? report + *done : done;
}

/// Solve the stage from the initial guess in u, and compute its velocity.
tl::expected<StepReport, Diagnostic> Implicit::solve() {
  auto report = newton_.solve(stage_, u_);
  if (!report) return report;
  v_ = (u_ - stage_.a) / stage_.c;
  newton_.system().balanced_forces(stage_, v_, k_);
  return report;
}

tl::expected<StepReport, Diagnostic> Implicit::backward_euler() {
  stage_.a = u_;
  stage_.Mb.noalias() = model().mass_matrix() * v_;
  if (extrapolate_) u_ += h() * v_;
  return solve();
}

/// Starting from u0 + duration v0 makes a single iteration second-order, because the remaining correction is small.
tl::expected<StepReport, Diagnostic> Implicit::trapezoidal(double duration) {
  const double c = stage_.c;
  stage_.Mb.noalias() = (1 - c * newton_.system().alpha()) * (model().mass_matrix() * v_);
  const bool balanced = options().newton_iterations > 1;  // one iteration leaves an error of order two in k_
  if (edited() || !balanced) newton_.system().forces(u_, v_, k_);
  stage_.Mb += c * (stage_.f - k_);
  stage_.a = u_ + c * v_;
  u_ += duration * v_;
  return solve();
}

tl::expected<StepReport, Diagnostic> Implicit::tr_bdf2() {
  constexpr double kOld = (1 - kGamma) * (1 - kGamma) / (kGamma * (2 - kGamma)), kNew = 1 + kOld;
  u0_ = u_;
  v0_ = v_;
  auto report = trapezoidal(kGamma * h());
  if (!report || newton_.diverged()) return report;
  stage_.a = kNew * u_ - kOld * u0_;
  v0_ = kNew * v_ - kOld * v0_;
  stage_.Mb.noalias() = model().mass_matrix() * v0_;
  u_ += (1 - kGamma) * h() * v_;
  auto second = solve();
  return second ? *report + *second : second;
}

}  // namespace tactus::sim
