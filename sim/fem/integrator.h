// SPDX-License-Identifier: Apache-2.0
/// Time integration of deformable objects behind one interface.
///
/// method            order  stable when          per step
/// symplectic_euler  2 (1)  h omega_max < 2      one evaluation of k; order 2 in u for leapfrog's shifted velocities
/// backward_euler    1      always, damps        Newton with one linear system each
/// newmark           2      always               beta 1/4, gamma 1/2 (average acceleration); Newton
/// tr_bdf2           2      always, L-stable     two stages, Newton
/// modal             2      always               K modes of the linear problem, exact in time for constant forces
/// projective        1      always, damps        one factorisation at start; each iteration solves with it (quasi-Newton)
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "sim/fem/model.h"

namespace tactus {

enum class Method : std::uint8_t { symplectic_euler, backward_euler, newmark, tr_bdf2, modal, projective };
enum class LinearSolver : std::uint8_t { conjugate_gradients, cholesky };

const char* name(Method method) noexcept;  ///< "symplectic-euler"
const char* name(LinearSolver solver) noexcept;

struct IntegratorOptions {
  Method method = Method::symplectic_euler;
  double step = 1e-3;  ///< h [s]
  LinearSolver solver = LinearSolver::conjugate_gradients;
  double solver_tolerance = 1e-6;  ///< relative residual of the linear system
  int newton_iterations = 10;      ///< at most; 1: semi-implicit
  double newton_tolerance = 1e-8;  ///< stop when the update's energy norm is below this share of the first one's
  int modes = 0;                   ///< of `modal`
};

/// What a step took.
struct StepReport {
  int newton_iterations = 0;
  int solver_iterations = 0;
  bool converged = true;  ///< Newton met its tolerance within its iterations; false is no error when only few were asked for
};

class Integrator {
 public:
  /// Advance by h under constant external forces f [N].
  /// time see the table; no allocation after the first step (cholesky and newton: none after the second).
  /// err  R-FEM-5, R-FEM-6 (state unchanged, remedy named), R-FEM-7
  virtual tl::expected<StepReport, FemError> step(const Eigen::VectorXd& f, FemState& state) = 0;
  virtual const IntegratorOptions& options() const noexcept = 0;
  virtual ~Integrator() = default;
};

/// pre  `model` outlives the integrator and is used by it alone.   err  R-FEM-7, R-FEM-8
tl::expected<std::unique_ptr<Integrator>, FemError> make_integrator(FemModel& model, const IntegratorOptions& options);

/// What suits the scene: explicit when h omega_max <= 1.6, else the prefactored quasi-Newton scheme when a step must take less than
/// real time, and why, in one sentence with the numbers.
struct Choice {
  IntegratorOptions options;
  double largest_frequency = 0;  ///< [rad/s]
  std::string reason;
};
Choice choose(const FemModel& model, double step);

}  // namespace tactus
