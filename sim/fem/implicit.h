// SPDX-License-Identifier: Apache-2.0
/// Backward Euler, Newmark and TR-BDF2: which stages a step consists of (newton.h).
/// Where the motion is so violent that a stage of the last two cannot be solved within the iterations allowed, the step is done
/// again with backward Euler, and so are the next ones until one of them can be solved: what is not a solution would feed the
/// stiff modes instead of damping them.
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
