// SPDX-License-Identifier: Apache-2.0
/// The K slowest modes of the problem linearised at rest.
///   K phi = lambda M phi,  phi^T M phi = 1          u = sum q_i phi_i
///   q'' + (alpha + beta lambda) q' + lambda q = phi^T f
#pragma once

#include <Eigen/Dense>

#include <tactus/sim/fem/checked_integrator.h>
#include <tactus/sim/modes/slowest_modes.h>

namespace tactus::sim {

/// Of the free degrees of freedom, K at rest.   pre  1 <= count <= free degrees of freedom.   err  R-FEM-7
/// time 0.04 s for 50 modes of the membrane (714 vertices)
tl::expected<Modes, Diagnostic> slowest_modes(FemModel& model, int count);

class Modal final : public CheckedIntegrator {
 public:
  static tl::expected<std::unique_ptr<Integrator>, Diagnostic> create(FemModel& model, const IntegratorOptions& options);

 private:
  Modal(FemModel& model, const IntegratorOptions& options, Modes modes);
  tl::expected<StepReport, Diagnostic> advance(const Eigen::VectorXd& f, const FemState& state, FemState& next) override;
  bool may_gain_energy() const noexcept override { return false; }

  /// (q, h q') after a step from q, h q', h^2 p under a constant force p.
  using Recurrence = Eigen::Matrix<double, 2, 3>;
  Modes modes_;
  Eigen::MatrixXd weighted_;  // M phi
  std::vector<Recurrence> recurrence_;
  Eigen::VectorXd q_, rate_, force_, free_;
};

}  // namespace tactus::sim
