// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/sim/fem/element_block.h>
#include <tactus/sim/fem/integrator.h>

namespace tactus::sim {

/// The common part of all integrators: checks the input, and lets no diverged state leave a step (integrator.h).
class CheckedIntegrator : public Integrator {
 public:
  CheckedIntegrator(FemModel& model, const IntegratorOptions& options);

  tl::expected<StepReport, Diagnostic> step(const Eigen::VectorXd& f, FemState& state) final;
  const IntegratorOptions& options() const noexcept final { return options_; }

 protected:
  /// Compute `next` from `state`.   err  R-FEM-6, R-FEM-7; step and remedy are filled in here
  virtual tl::expected<StepReport, Diagnostic> advance(const Eigen::VectorXd& f, const FemState& state, FemState& next) = 0;
  /// False if the method cannot. FemModel::energy() is then not what it conserves.
  virtual bool may_gain_energy() const noexcept { return true; }
  /// Largest ratio of maximum to minimum energy, as the method sees it, of a stable motion without forces.
  virtual double largest_swing() const noexcept { return 1; }
  FemModel& model() noexcept { return model_; }
  double h() const noexcept { return options_.step; }
  /// Whether the given state differs from the one that the last step returned.
  bool edited() const noexcept { return edited_; }

 private:
  bool finite(const Eigen::VectorXd& x) const noexcept;
  /// Whether next_ is not a valid step from `before`. Stores it in last_ before the result is known.
  bool diverged(const Eigen::VectorXd& f, const FemState& before);
  Diagnostic divergence() const;
  bool gained_energy();

  FemModel& model_;
  IntegratorOptions options_;
  FemState next_;
  std::int64_t steps_ = 0;
  double far_ = 0;                                                // [m] movement that may have torn an element
  double moved_ = 0;                                              // [m] since the last check of the elements
  double work_ = 0;                                               // [J] of external forces since the reference
  double reference_ = 0;                                          // [J]
  double rounding_ = 0;                                           // [J] below which energy is noise
  bool edited_ = true, interrupted_ = true, referenced_ = false;  // interrupted: the last step failed, or there was none
  FemState last_;
  ElementKernels kernels_ = kernels(widest());
};

}  // namespace tactus::sim
