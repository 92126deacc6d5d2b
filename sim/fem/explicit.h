// SPDX-License-Identifier: Apache-2.0
/// Symplectic Euler:  v1 = (v0 + h M^-1 (f - k(u0 + beta v0))) / (1 + h alpha),  u1 = u0 + h v1.
/// alpha is mass_damping, beta stiffness_damping. Mass damping, taken implicitly, never limits the step;
/// stiffness damping does: h omega^2 (h + 2 beta) < 4.
#pragma once

#include <optional>

#include "sim/fem/cholesky.h"
#include "sim/fem/guarded.h"

namespace tactus {

class SymplecticEuler final : public Guarded {
 public:
  SymplecticEuler(FemModel& model, const IntegratorOptions& options);

 private:
  tl::expected<StepReport, FemError> advance(const Eigen::VectorXd& f, const FemState& state, FemState& next) override;

  Eigen::VectorXd k_, ahead_;
  Eigen::VectorXd decay_;         // 1 / (1 + h alpha), 0 where fixed
  Eigen::VectorXd kick_;          // h / (1 + h alpha) divided by the lumped mass, 0 where fixed
  std::optional<Cholesky> mass_;  // consistent
  Eigen::VectorXd free_;
};

}  // namespace tactus
