// SPDX-License-Identifier: Apache-2.0
/// Energy balance of a whole simulation. It shows small errors of single steps that always have the same sign.
///   gained = E now - work of the forces + what damping took        0 when time integration makes no error
/// E is kinetic energy with the lumped mass plus elastic energy. The power of mass damping is summed in every step; that of
/// stiffness damping, v . (k(u + beta v) - k(u)), is evaluated in every 16th. For velocity Verlet, E and `gained` oscillate by
/// about (h omega)^2 / 4 of the energy that vibrates with omega.
#pragma once

#include <tactus/sim/fem/integrator.h>

namespace tactus::sim {

class EnergyBalance {
 public:
  struct Result {
    double moved = 0;   ///< [J] sum of the sizes of the work of all steps
    double gained = 0;  ///< [J] negative: lost
  };

  /// From rest, on a copy of the model.   err  as FemModel::create
  static tl::expected<EnergyBalance, Diagnostic> create(const FemModel& model);

  /// Record a step that was taken.   in  f [N] held over it, h [s], the state after it
  /// time O(vertices), and two evaluations of k in every 16th step with stiffness damping; no allocation
  void add(const Eigen::VectorXd& f, double h, const FemState& after) noexcept;
  Result result() noexcept;  ///< time of one evaluation of W

 private:
  explicit EnergyBalance(FemModel model);

  FemModel model_;
  FemState last_;
  Eigen::VectorXd ahead_, with_, without_;
  double work_ = 0, moved_ = 0, damped_ = 0;     // [J]
  double mass_power_ = 0, stiffness_power_ = 0;  // [W] at the last evaluation
  double since_ = 0;                             // [s] since the last evaluation of stiffness damping
  int steps_ = 0;
};

}  // namespace tactus::sim
