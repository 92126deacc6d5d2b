// SPDX-License-Identifier: Apache-2.0
/// Backward Euler, Newmark and TR-BDF2: which stages a step consists of (newton.h).
/// If a stage of Newmark or TR-BDF2 does not converge within the iterations allowed, the step is repeated with backward Euler,
/// and so are the next ones until one of them converges. A stage that is not solved would excite the stiff modes instead of
/// damping them.
#pragma once

#include <tactus/sim/fem/checked_integrator.h>
#include <tactus/sim/fem/newton.h>

namespace tactus::sim {

enum class Scheme : std::uint8_t { backward_euler, newmark, tr_bdf2 };

class Implicit final : public CheckedIntegrator {
 public:
  Implicit(FemModel& model, const IntegratorOptions& options, Scheme scheme, std::unique_ptr<DescentDirection> direction);

  /// c of the stages: what a matrix factored at the start is made for.
  static double stage_step(Scheme scheme, double h) noexcept;

 private:
  tl::expected<StepReport, Diagnostic> advance(const Eigen::VectorXd& f, const FemState& state, FemState& next) override;
  tl::expected<StepReport, Diagnostic> second_order();
  tl::expected<StepReport, Diagnostic> backward_euler();
  tl::expected<StepReport, Diagnostic> trapezoidal(double duration);
  tl::expected<StepReport, Diagnostic> tr_bdf2();
  tl::expected<StepReport, Diagnostic> solve();

  Scheme scheme_;
  bool extrapolate_;  // where backward Euler starts
  Newton newton_;
  Stage stage_;
  bool fallback_ = false;                // the last solve of the stages diverged: steps of backward Euler
  Eigen::VectorXd u_, v_, u0_, v0_, k_;  // free: state at work, state at the start, forces
  Eigen::VectorXd start_u_, start_v_;    // of the step
};

}  // namespace tactus::sim
