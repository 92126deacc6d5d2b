// SPDX-License-Identifier: Apache-2.0
/// Velocity Verlet (leapfrog with velocities at the same instant as displacements), `substeps` times per step with h / substeps each:
///   v' = e v0 + p M^-1 (f - k0),   u1 = u0 + h v',   k1 = k(u1 + beta v'),   v1 = e v' + p M^-1 (f - k1)
///   e = exp(-alpha h / 2),   p = (1 - e) / alpha, h / 2 without mass damping
/// alpha is mass_damping, beta stiffness_damping; k1 is the next step's k0. Mass damping is solved exactly and never limits the
/// step. Stiffness damping uses a velocity half a step old and does: h omega^2 (h + 2 beta) < 4.
#pragma once

#include <optional>

#include <tactus/sim/fem/checked_integrator.h>
#include <tactus/sim/fem/cholesky.h>

namespace tactus::sim {

class VelocityVerlet final : public CheckedIntegrator {
 public:
  VelocityVerlet(FemModel& model, const IntegratorOptions& options);

 private:
  tl::expected<StepReport, Diagnostic> advance(const Eigen::VectorXd& f, const FemState& state, FemState& next) override;
  double largest_swing() const noexcept override { return swing_; }
  void forces(const Eigen::VectorXd& u, const Eigen::VectorXd& v);
  void half_kick(const Eigen::VectorXd& f, Eigen::VectorXd& v);

  double part_;                   // [s] h / substeps
  double swing_ = 1;              // of the energy
  Eigen::VectorXd decay_;         // e, 0 where fixed
  Eigen::VectorXd kick_;          // p divided by the lumped mass, 0 where fixed
  Eigen::VectorXd k_, scratch_;   // k_: at the end of the step before
  std::optional<Cholesky> mass_;  // consistent
  Eigen::VectorXd free_;
};

}  // namespace tactus::sim
