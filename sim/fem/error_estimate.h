// SPDX-License-Identifier: Apache-2.0
/// How wrong steps are: estimated error, and energy that nobody put in.
#pragma once

#include <cstdint>

#include <tactus/sim/fem/integrator.h>

namespace tactus::sim {

// ==== error estimate ====
// Error of single steps by step doubling: one whole step against two half ones from the same state, for some of the steps, on a
// copy of the model. The simulation's results do not depend on it.
//   error of the whole step = 2^p / (2^p - 1) |u_whole - u_halves|,  p the order        relative to |u_halves - u_before|
// The root mean squares of both are compared, so that a step counts by how far the object moves in it. At rest no method errs, and those
// that damp rest soonest: a median over steps would rank these first.

class ErrorEstimate {
 public:
  struct Result {
    double of_motion = 0;       ///< RMS error of a step by the RMS motion in a step; 0 without samples, or motion
    double most_of_motion = 0;  ///< the largest error of a step by the same
    std::int64_t samples = 0;
  };

  /// in  every  estimate every n-th step   err  as make_integrator
  static tl::expected<ErrorEstimate, Diagnostic> create(const FemModel& model, const IntegratorOptions& options,
                                                        std::int64_t every = 50);

  /// Report a step before it is taken. One that the copies cannot take does not count.   time three steps if it is estimated,
  /// else nothing; no allocation after the first estimate
  void look(const Eigen::VectorXd& f, const FemState& state);
  Result result() const noexcept;

 private:
  struct Copy {  // stays where it is: the integrator refers to the model
    FemModel model;
    std::unique_ptr<Integrator> integrator;
  };
  ErrorEstimate(std::unique_ptr<Copy> whole, std::unique_ptr<Copy> half, std::int64_t every);
  static tl::expected<std::unique_ptr<Copy>, Diagnostic> copy(const FemModel& model, const IntegratorOptions& options);
  std::unique_ptr<Copy> whole_, half_;
  std::int64_t every_, calls_ = 0;
  double order_factor_;
  FemState coarse_, fine_;
  double errors2_ = 0, motions2_ = 0, largest2_ = 0;  // [m2] sums of squares, and the largest error's
  std::int64_t samples_ = 0;
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
