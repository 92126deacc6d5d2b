// SPDX-License-Identifier: Apache-2.0
/// How wrong steps are: estimated error, and energy that nobody put in.
#pragma once

#include <vector>

#include <tactus/sim/fem/integrator.h>

namespace tactus::sim {

// ==== error estimate ====
// Error of single steps by step doubling: one whole step against two half ones from the same state, for some of the steps, on a
// copy of the model. The simulation's results do not depend on it.
//   error of the whole step = 2^p / (2^p - 1) |u_whole - u_halves|,  p the order        relative to |u_halves|

class ErrorEstimate {
 public:
  struct Result {
    double p50 = 0, max = 0;  ///< relative error of one step; 0 without samples
    std::int64_t samples = 0;
  };

  /// in  every  estimate every n-th step   err  as make_integrator
  static tl::expected<ErrorEstimate, Diagnostic> create(const FemModel& model, const IntegratorOptions& options,
                                                        std::int64_t every = 50);

  /// Report a step before it is taken.   time three steps if it is estimated, else nothing; no allocation after the first
  /// estimate
  void look(const Eigen::VectorXd& f, const FemState& state);
  Result result() const;  ///< allocates

 private:
  struct Copy {  // stays where it is: the integrator refers to the model
    FemModel model;
    std::unique_ptr<Integrator> integrator;
  };
  ErrorEstimate(std::unique_ptr<Copy> whole, std::unique_ptr<Copy> half, std::int64_t every);
  static tl::expected<std::unique_ptr<Copy>, Diagnostic> copy(const FemModel& model, const IntegratorOptions& options);
  double relative_error(const Eigen::VectorXd& f, const FemState& state);

  std::unique_ptr<Copy> whole_, half_;
  std::int64_t every_, calls_ = 0;
  double order_factor_;
  FemState coarse_, fine_;
  std::vector<double> errors_;
};

// ==== energy balance ====
// Energy balance of a whole simulation. It shows small errors of single steps that always have the same sign.
//   gained = E now - work of the forces + what damping took        0 when time integration makes no error
// E is kinetic energy with the lumped mass plus elastic energy. The power of mass damping is summed in every step; that of
// stiffness damping, v . (k(u + beta v) - k(u)), is evaluated in every 16th. For velocity Verlet, E and `gained` oscillate by
// about (h omega)^2 / 4 of the energy that vibrates with omega.

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
