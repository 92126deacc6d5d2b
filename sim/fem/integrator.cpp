// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/fem/integrator.h>

#include <tactus/base/rule.h>
#include <tactus/sim/fem/explicit.h>
#include <tactus/sim/fem/implicit.h>
#include <tactus/sim/fem/linear_solver.h>
#include <tactus/sim/fem/modal.h>

namespace tactus::sim {
namespace {

constexpr int kMostSubsteps = 1000;

Scheme scheme(Method method) {
  if (method == Method::newmark) return Scheme::newmark;
  return method == Method::tr_bdf2 ? Scheme::tr_bdf2 : Scheme::backward_euler;
}

bool quasi_newton(const IntegratorOptions& o) {
  if (o.method == Method::velocity_verlet || o.method == Method::modal) return false;
  return o.method == Method::projective || o.solver == LinearSolver::prefactored;
}

/// What is wrong with the options, nullptr: nothing.
const char* wrong(const FemModel& model, const IntegratorOptions& o) {
  if (!(o.step >= 1e-9 && o.step <= 1)) return "a step between 1e-9 s and 1 s";
  if (!(o.solver_tolerance > 0 && o.solver_tolerance < 1)) return "a solver tolerance between 0 and 1";
  if (!(o.newton_tolerance > 0 && o.newton_tolerance < 1)) return "a Newton tolerance between 0 and 1";
  if (o.substeps < 1 || o.substeps > kMostSubsteps) return "1 to 1000 sub-steps";
  if (o.newton_iterations < 1) return "at least one Newton iteration";
  if (quasi_newton(o) && largest_poisson(model) > kNearlyIncompressible && model.options().elasticity == Elasticity::corotated)
    return "the solver cg or cholesky: with a Poisson's ratio above 0.4999 quasi-Newton directions do not converge";
  const auto free = static_cast<std::int64_t>(model.free_dofs().size());
  if (o.method == Method::modal && (o.modes < 1 || o.modes > free)) return "between one mode and the free degrees of freedom";
  return nullptr;
}

}  // namespace

const char* name(Method method) noexcept {
  switch (method) {
    case Method::velocity_verlet:
      return "velocity-verlet";
    case Method::backward_euler:
      return "backward-euler";
    case Method::newmark:
      return "newmark";
    case Method::tr_bdf2:
      return "tr-bdf2";
    case Method::modal:
      return "modal";
    case Method::projective:
      return "projective";
  }
  return "?";
}

const char* name(LinearSolver solver) noexcept {
  switch (solver) {
    case LinearSolver::conjugate_gradients:
      return "cg";
    case LinearSolver::cholesky:
      return "cholesky";
    case LinearSolver::prefactored:
      return "prefactored";
  }
  return "?";
}

std::string to_string(const IntegratorOptions& options) {
  std::string out = name(options.method);
  if (options.substeps > 1) out += ", " + std::to_string(options.substeps) + " sub-steps";
  const bool solves = options.method != Method::velocity_verlet && options.method != Method::modal;
  return solves ? out + ", " + name(options.solver) : out;
}

tl::expected<std::unique_ptr<Integrator>, Diagnostic> make_integrator(FemModel& model, const IntegratorOptions& options) {
  if (const char* remedy = wrong(model, options))
    return tl::unexpected(
        Diagnostic{.error = fail(Errc::invalid_argument, "R-FEM-8").value(), .remedy = std::string("give ") + remedy});
  if (options.method == Method::velocity_verlet) return std::make_unique<VelocityVerlet>(model, options);
  if (options.method == Method::modal) return Modal::create(model, options);
  const Scheme stages = scheme(options.method);
  std::unique_ptr<DescentDirection> direction;
  if (quasi_newton(options)) {
    TACTUS_TRY(auto made, PrefactoredDirection::create(model, Implicit::stage_step(stages, options.step)));
    direction = std::move(made);
  } else {
    direction = std::make_unique<NewtonDirection>(model, options);
  }
  return std::make_unique<Implicit>(model, options, stages, std::move(direction));
}

}  // namespace tactus::sim
