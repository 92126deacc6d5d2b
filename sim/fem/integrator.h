// SPDX-License-Identifier: Apache-2.0
/// Time integration of deformable objects behind one interface. All methods advance the same equation,
///   M u'' + mass_damping M u' + k(u + stiffness_damping u') = f
/// which is that of model.h: the elastic force at u + stiffness_damping u' is the elastic force plus stiffness_damping K u',
/// exactly for linear elasticity, else to first order. It costs one evaluation.
///
/// method            order  stable when            per step
/// velocity_verlet   2      h omega_max < 2        one evaluation of k per sub-step; stiffness damping, half a step late, is of order 1
/// backward_euler    1      always, damps          one stage
/// newmark           2      K constant, undamped   one stage; beta 1/4, gamma 1/2 (average acceleration). Where elements turn, energy
///                                                 may grow until the step is refused, at h omega_max of 4 to 16, with one
///                                                 iteration from 2 on
/// tr_bdf2           2      always, damps high w   two stages: trapezoidal rule over (2 - sqrt 2) h, then BDF2
/// projective        1      always, damps          backward Euler whose stages are solved with `prefactored`
/// modal             exact  always                 K modes of the problem linearised at rest, whatever the elasticity; exact in
///                                                 time for constant forces; motion outside the modes is lost
///
/// Backward Euler starts its iteration at u0. With `prefactored`, and in the other methods, it starts at the displacement
/// extrapolated with v0. Newmark and TR-BDF2 fall back to backward Euler where the motion is so violent that their stages cannot
/// be solved. A stage is a nonlinear system. Each iteration finds a direction with the linear solver, and shortens the step along
/// it when the residual shows that it overshoots. `newton_iterations` 1 is the linearly implicit variant, without that check. If
/// the convergence rate of earlier stages predicts a negligible second update, the residual check is skipped.
///
/// solver               direction                                                    per iteration
/// conjugate_gradients  (a M + b K(u))^-1, block Jacobi, warm start                  assembly, about 3 products at h omega = 0.6
/// cholesky             (a M + b K(u))^-1                                            assembly, factorisation; linear: one at the start
/// prefactored          quasi-Newton from (a M + b K(0))^-1, turned vertex by        one evaluation of k, one solve
///                      vertex into the deformed shape, with limited memory (L-BFGS)
///
/// Mass: implicit methods take M as the model has it. Velocity Verlet with a consistent M factors it once and solves every step.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include <tactus/sim/fem/model.h>

namespace tactus::sim {

enum class Method : std::uint8_t { velocity_verlet, backward_euler, newmark, tr_bdf2, modal, projective };
enum class LinearSolver : std::uint8_t { conjugate_gradients, cholesky, prefactored };

const char* name(Method method) noexcept;  ///< "velocity-verlet"
const char* name(LinearSolver solver) noexcept;

struct IntegratorOptions {
  Method method = Method::velocity_verlet;
  double step = 1e-3;  ///< h [s]
  int substeps = 1;    ///< of velocity_verlet: equal parts of h, each with its own evaluation; the table's h is one of them
  LinearSolver solver = LinearSolver::conjugate_gradients;
  double solver_tolerance = 1e-6;  ///< of conjugate gradients: relative residual of the linear system
  int newton_iterations = 10;      ///< at most; 1: linearly implicit
  /// Stop when an update d, or the estimate of the next one, is below this fraction of the stage's first update, or below 1e-10 of the
  /// motion, sqrt(v^T M v). The size of d is sqrt(-d . r) with the residual r: for d = -A^-1 r its energy norm in the system matrix
  /// A, without a product with A. A larger fraction of the motion would bias every step: the missing part always has the same sign.
  double newton_tolerance = 1e-8;
  int modes = 0;  ///< of `modal`, 1 .. free degrees of freedom
};

std::string to_string(const IntegratorOptions& options);  ///< "velocity-verlet, 10 sub-steps", "tr-bdf2, prefactored"

/// What a step took.
struct StepReport {
  int newton_iterations = 0;
  int solver_iterations = 0;
  bool converged = true;  ///< Newton met its tolerance within its iterations; false is no error when few were allowed
};

class Integrator {
 public:
  /// Advance by h under constant external forces f [N].
  ///
  /// A step diverged (R-FEM-6) when its result is not finite, when a tetrahedron is torn (FemModel::broken_element, checked
  /// whenever vertices have moved far enough since the last check), or when the sum of kinetic and elastic energy, checked every 64th
  /// step except with `modal`, exceeds 10 s (E + W) by more than rounding. E is the sum at the first check, W the sum of |work of f|
  /// per step since then; both start anew when the caller has changed the state. s is 1; with velocity Verlet
  /// below its limit 1 / (1 - (h omega_max / 2)^2), the swing of its energy in stable motion. The state before the step is kept.
  /// The error names the tetrahedron that is torn, or else the one that is stretched most.
  /// time see the tables; no allocation after the first step.
  /// err  R-FEM-5, R-FEM-6 (remedy named), R-FEM-7
  virtual tl::expected<StepReport, Diagnostic> step(const Eigen::VectorXd& f, FemState& state) = 0;
  virtual const IntegratorOptions& options() const noexcept = 0;
  virtual ~Integrator() = default;
};

/// pre  `model` outlives the integrator and is used by it alone.   err  R-FEM-7, R-FEM-8
tl::expected<std::unique_ptr<Integrator>, Diagnostic> make_integrator(FemModel& model, const IntegratorOptions& options);

/// Poisson's ratio beyond which quasi-Newton directions do not converge (R-FEM-8).
inline constexpr double kNearlyIncompressible = 0.4999;
double largest_poisson(const FemModel& model) noexcept;

/// A method with the solver and tolerance that suit the object: one factorisation at the start, where that converges.
IntegratorOptions suited(const FemModel& model, Method method, double step);

/// The method that suits the scene, and the reason, in one sentence with the numbers: velocity Verlet in sub-steps of h omega
/// <= 1.8 where they cost no more than an implicit step, else TR-BDF2.
struct Choice {
  IntegratorOptions options;
  double largest_frequency = 0;  ///< [rad/s]
  std::string reason;
};
/// time one Lanczos iteration for omega_max, milliseconds for thousands of tetrahedra; allocates
Choice choose(const FemModel& model, double step);

/// Remedy for a divergence, with the numbers of this object.
std::string divergence_remedy(const FemModel& model, const IntegratorOptions& options);

}  // namespace tactus::sim
