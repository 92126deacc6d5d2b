// SPDX-License-Identifier: Apache-2.0
/// One implicit stage, and the iteration that solves it. Vectors here hold the free degrees of freedom only.
///
///   M (v - b)/c + alpha M v + k(u + beta v) = f,   v = (u - a)/c                            unknown: u
///   r(u)  = left side - f [N]
///   A     = (1 + c alpha)/c^2 M + (1 + beta/c) K(u + beta v), the derivative of r without that of the rotations
///
/// scheme                       c      a                b
/// backward Euler               h      u0               v0
/// Newmark (trapezoidal rule)   h/2    u0 + c v0        v0 + c M^-1 (f - alpha M v0 - k(u0 + beta v0))
/// BDF2 after the trapezoid     gamma h/2   combination of the two states before
#pragma once

#include <tactus/sim/fem/integrator.h>

namespace tactus::sim {

struct Stage {
  double c = 0;        ///< [s]
  Eigen::VectorXd a;   ///< [m]
  Eigen::VectorXd Mb;  ///< [kg m/s]
  Eigen::VectorXd f;   ///< [N]
};

/// The model seen through its free degrees of freedom.
class StageSystem {
 public:
  explicit StageSystem(FemModel& model);

  FemModel& model() noexcept { return model_; }
  Eigen::Index size() const noexcept { return static_cast<Eigen::Index>(model_.free_dofs().size()); }
  double alpha() const noexcept { return model_.options().mass_damping; }
  double beta() const noexcept { return model_.options().stiffness_damping; }
  double mass_factor(double c) const noexcept { return (1 + c * alpha()) / (c * c); }
  double stiffness_factor(double c) const noexcept { return 1 + beta() / c; }

  void gather(const Eigen::VectorXd& full, Eigen::VectorXd& free) const noexcept;
  void scatter(const Eigen::VectorXd& free, Eigen::VectorXd& full) const noexcept;
  /// k(u + beta v); the point of evaluation stays in ahead().
  void forces(const Eigen::VectorXd& u, const Eigen::VectorXd& v, Eigen::VectorXd& k);
  /// k from the stage's equation for a solution with velocity v: free of the stiff error left in u.
  void balanced_forces(const Stage& stage, const Eigen::VectorXd& v, Eigen::VectorXd& k);
  void residual(const Stage& stage, const Eigen::VectorXd& u, Eigen::VectorXd& r);
  /// v^T M v [J], the squared energy norm of a motion with v over c.
  double motion(const Stage& stage, const Eigen::VectorXd& u);
  /// u + beta v of the last evaluation, 3N.
  const Eigen::VectorXd& ahead() const noexcept { return ahead_; }
  /// Norm of the rounding error of r when nothing moves [N].
  double rounding() const noexcept { return rounding_; }

 private:
  FemModel& model_;
  Eigen::VectorXd ahead_, k_, v_, Mv_;
  double rounding_ = 0;
};

/// Finds the next update of a stage.
class DescentDirection {
 public:
  /// d, about -A^-1 r, with d . r < 0.
  /// pre  system.ahead() belongs to r.   ret  iterations of the linear solver.   err  R-FEM-7
  virtual tl::expected<int, Diagnostic> find(StageSystem& system, const Stage& stage, const Eigen::VectorXd& r,
                                             Eigen::VectorXd& d) = 0;
  /// Report the result of a direction: u moved by s, r changed by y.
  virtual void moved(const Eigen::VectorXd& s, const Eigen::VectorXd& y) = 0;
  /// Report that a direction overshot: the data it was built on are out of date.
  virtual void forget() {}
  virtual ~DescentDirection() = default;
};

/// Newton's method, exact or inexact, with a line search on the residual.
class Newton {
 public:
  Newton(FemModel& model, const IntegratorOptions& options, std::unique_ptr<DescentDirection> direction);

  /// in, out  u  start, solution.   err  R-FEM-6 when the residual is not finite, R-FEM-7
  tl::expected<StepReport, Diagnostic> solve(const Stage& stage, Eigen::VectorXd& u);
  StageSystem& system() noexcept { return system_; }
  /// True if the last solve failed: after the allowed iterations the estimated next update is still above 1 % of the stage's first
  /// update and of the motion at its start. Always false for linearly implicit steps.
  bool diverged() const noexcept { return diverged_; }

 private:
  bool search(const Stage& stage, double decrease, Eigen::VectorXd& u);

  StageSystem system_;
  std::unique_ptr<DescentDirection> direction_;
  int iterations_;
  double tolerance_;
  bool diverged_ = false;
  double shrinkage_ = 1;  // of the residual's square in a first iteration, as last seen; nearer to 1 the longer ago
  Eigen::VectorXd r_, next_r_, d_;
};

}  // namespace tactus::sim
