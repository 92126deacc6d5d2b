// SPDX-License-Identifier: Apache-2.0
// Integrators do in time what they say: exact recurrences, orders, what is conserved, and other programs' figures.
#include <tactus/sim/fem/integrator.h>

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <tactus/sim/fem/error_estimate.h>
#include <tactus/sim/fem/linear_solver.h>
#include <tactus/sim/fem/newton.h>
#include <tactus/sim/random.h>
#include "tests/property/allocated.h"
#include "tests/property/heap_calls.h"
#include "tests/unit/fem_fixture.h"

namespace tactus::sim {
namespace {

using Eigen::VectorXd;

/// Every method with every solver that it can use; tolerances so tight that the time step alone errs.
std::vector<IntegratorOptions> all_integrators(double step) {
  std::vector<IntegratorOptions> out;
  const auto add = [&](Method method, LinearSolver solver) {
    IntegratorOptions o;
    o.method = method;
    o.solver = solver;
    o.step = step;
    o.solver_tolerance = 1e-12;
    o.newton_iterations = 60;
    o.newton_tolerance = 1e-11;
    out.push_back(o);
  };
  add(Method::velocity_verlet, LinearSolver::cholesky);
  for (const Method method : {Method::backward_euler, Method::newmark, Method::tr_bdf2})
    for (const LinearSolver solver : {LinearSolver::conjugate_gradients, LinearSolver::cholesky, LinearSolver::prefactored})
      add(method, solver);
  add(Method::projective, LinearSolver::prefactored);
  return out;
}

std::string label(const IntegratorOptions& o) { return std::string(name(o.method)) + " " + name(o.solver); }

std::unique_ptr<Integrator> make(FemModel& model, const IntegratorOptions& options) {
  return std::move(make_integrator(model, options).value());
}

void run(Integrator& integrator, const VectorXd& f, FemState& state, int steps) {
  for (int i = 0; i < steps; ++i) {
    const auto report = integrator.step(f, state);
    ASSERT_TRUE(report) << to_string(report.error());
  }
}

/// A small slab with a fixed end, bent by a load at the free one.
FemModel strip(Elasticity elasticity = Elasticity::corotated, MassMatrix mass = MassMatrix::lumped) {
  FemOptions options;
  options.materials = {{1e4, 0.3, 1000}};
  options.fixed = {0, 5, 10, 15, 20, 25};
  options.elasticity = elasticity;
  options.mass = mass;
  options.mass_damping = 2;
  options.stiffness_damping = 1e-3;
  return testing::make_model(make_slab(4, 2, 1, 0.01), options);
}

VectorXd strip_load(const FemModel& model) {
  VectorXd f = VectorXd::Zero(model.size());
  f[3 * 29 + 2] = -0.05;
  f[3 * 29] = 0.02;
  return f;
}

double membrane_deflection(IntegratorOptions options) {
  FemModel model = testing::slab_model();
  FemState state = model.rest();
  run(*make(model, options), testing::slab_load(model), state, 300);
  return state.u[3 * testing::kSlabCentre + 2];
}

// Runge-Kutta of order 4 with a step of 0.1 ms says -0.058432. VegaFEM 3.1 and SOFA agree on all digits with the second: theirs is
// backward Euler with one iteration from the displacement before. Their symplectic Euler, half a step off, says -0.058463.
TEST(FemIntegrator, MembraneUnderOneNewtonMovesAsOtherProgramsSay) {
  IntegratorOptions options;
  EXPECT_NEAR(membrane_deflection(options), -0.058422, 5e-7);
  options.method = Method::backward_euler;
  options.newton_iterations = 1;
  EXPECT_NEAR(membrane_deflection(options), -0.058350, 5e-7);
}

TEST(FemIntegrator, AMassOnASpringFollowsEachMethodsRecurrence) {
  FemOptions options;
  options.materials = {{2e4, 0.3, 1000}};
  options.fixed = {0, 1, 2};
  options.elasticity = Elasticity::linear;
  options.mass_damping = 3;
  options.stiffness_damping = 2e-4;
  const TetMesh mesh{{{0, 0, 0}, {0.01, 0, 0}, {0, 0.01, 0}, {0.002, 0.003, 0.01}}, {{0, 1, 2, 3}}};
  FemModel model = testing::make_model(mesh, options);
  SparseMatrix K;
  model.stiffness(VectorXd::Zero(12), K);
  const double mass = model.lumped_mass()[9];
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen{Eigen::Matrix3d(Eigen::MatrixXd(K))};
  const Eigen::Vector3d along = eigen.eigenvectors().col(1);
  const double square = eigen.eigenvalues()[1] / mass, h = 1e-3, damping = 3 + 2e-4 * square, pull = 1.5;
  ASSERT_GT(h * std::sqrt(square), 0.3) << "too easy";

  // (u, v)' = A (u, v) + (0, pull)
  Eigen::Matrix2d A;
  A << 0, 1, -square, -damping;
  const Eigen::Matrix2d I = Eigen::Matrix2d::Identity();
  const Eigen::Vector2d force(0, pull);
  double k = square * 2e-4 * 0.02;  // of Verlet, from the step before
  const auto verlet = [&](const Eigen::Vector2d& y) -> Eigen::Vector2d {
    const double e = std::exp(-3 * h / 2), p = (1 - e) / 3;
    const double half = e * y[1] + p * (pull - k), u = y[0] + h * half;
    k = square * (u + 2e-4 * half);
    return {u, e * half + p * (pull - k)};
  };
  const auto expected = [&](Method method, const Eigen::Vector2d& y) -> Eigen::Vector2d {
    if (method == Method::velocity_verlet) return verlet(y);
    if (method == Method::newmark) return (I - h / 2 * A).inverse() * ((I + h / 2 * A) * y + h * force);
    if (method == Method::tr_bdf2) {
      const double gamma = 2 - std::sqrt(2.0), c = gamma * h / 2;
      const Eigen::Vector2d middle = (I - c * A).inverse() * ((I + c * A) * y + 2 * c * force);
      const double w = 1 / (gamma * (2 - gamma));
      return (I - c * A).inverse() * (w * middle + (1 - w) * y + c * force);
    }
    return (I - h * A).inverse() * (y + h * force);
  };
  for (const IntegratorOptions& o : all_integrators(h)) {
    SCOPED_TRACE(label(o));
    const auto integrator = make(model, o);
    FemState state = model.rest();
    state.v.tail<3>() = 0.02 * along;
    VectorXd f = VectorXd::Zero(12);
    f.tail<3>() = mass * pull * along;
    Eigen::Vector2d y(0, 0.02);
    double largest = 0;
    for (int i = 0; i < 100; ++i) {
      ASSERT_TRUE(integrator->step(f, state));
      y = expected(o.method, y);
      largest = std::max(largest, std::abs(y[0]));
      ASSERT_LT((state.u.tail<3>() - y[0] * along).norm(), 1e-10 * largest) << "step " << i;
    }
  }
}

/// log2 of the ratio of errors at the end with a step and with half of it.
double measured_order(const IntegratorOptions& options, const FemOptions& object, double step = 5e-4) {
  const auto at_end = [&](double h, Method method) {
    FemModel model = testing::make_model(make_slab(4, 2, 1, 0.01), object);
    IntegratorOptions o = options;
    o.step = h;
    o.method = method;
    FemState state = model.rest();
    run(*make(model, o), strip_load(model), state, static_cast<int>(std::lround(0.064 / h)));
    return state.u;
  };
  const VectorXd reference = at_end(0.064 / 4096, Method::newmark);
  const auto error = [&](double h) { return (at_end(h, options.method) - reference).norm(); };
  return std::log2(error(step) / error(step / 2));
}

TEST(FemIntegrator, OrdersAreThoseStated) {
  for (const IntegratorOptions& o : all_integrators(1e-3)) {
    if (o.solver == LinearSolver::conjugate_gradients) continue;  // the recurrences cover it
    const bool first = o.method == Method::backward_euler || o.method == Method::projective;
    FemOptions object = strip().options();
    if (o.method == Method::velocity_verlet) {
      EXPECT_NEAR(measured_order(o, object, 2.5e-4), 1, 0.15) << "stiffness damping";
      object.stiffness_damping = 0;
    }
    EXPECT_NEAR(measured_order(o, object, o.method == Method::velocity_verlet ? 2.5e-4 : 5e-4), first ? 1 : 2, 0.15) << label(o);
  }
}

TEST(FemIntegrator, SubstepsAreStepsUnderOneForce) {
  FemModel model = strip();
  IntegratorOptions o = all_integrators(2e-4)[0];
  FemState fine = model.rest(), coarse = fine;
  const VectorXd f = strip_load(model);
  run(*make(model, o), f, fine, 60);
  o.step *= 5;
  o.substeps = 5;
  run(*make(model, o), f, coarse, 12);
  EXPECT_LT((coarse.u - fine.u).norm(), 1e-12 * fine.u.norm());
  EXPECT_LT((coarse.v - fine.v).norm(), 1e-12 * fine.v.norm());
}

// A load that is there at once, not one that grows from nothing: the weight of every deformable object.
TEST(FemIntegrator, SelfWeightThatIsSwitchedOnIsFollowedToTenPartsInAMillion) {
  const auto at_end = [](double step, int substeps) {
    FemModel model = testing::slab_model();
    IntegratorOptions o;
    o.step = step;
    o.substeps = substeps;
    VectorXd weight = VectorXd::Zero(model.size());
    for (Eigen::Index z = 2; z < weight.size(); z += 3) weight[z] = -0.2 * model.lumped_mass()[z];
    FemState state = model.rest();
    run(*make(model, o), weight, state, static_cast<int>(std::lround(0.3 / step)));
    return state;
  };
  const FemState one = at_end(1e-3, 1), exact = at_end(1e-3, 10);
  EXPECT_LT((one.u - exact.u).norm(), 1e-5 * exact.u.norm());
  EXPECT_LT((one.v - exact.v).norm(), 1e-4 * exact.v.norm());
}

// At steps that scenes have; with much shorter ones the derivative of the rotations, which one iteration lacks, is what is left.
TEST(FemIntegrator, OneIterationFromTheExtrapolatedStartKeepsOrderTwo) {
  for (const LinearSolver solver : {LinearSolver::cholesky, LinearSolver::prefactored}) {
    IntegratorOptions options;
    options.method = Method::newmark;
    options.solver = solver;
    options.newton_iterations = 1;
    EXPECT_GT(measured_order(options, strip().options(), 2e-3), 1.7) << name(solver);
  }
}

TEST(FemIntegrator, BackwardEulerNeverGainsEnergy) {
  FemOptions options = strip().options();
  options.mass_damping = options.stiffness_damping = 0;
  for (const MassMatrix mass : {MassMatrix::lumped, MassMatrix::consistent}) {
    options.mass = mass;
    FemModel model = testing::make_model(make_slab(4, 2, 1, 0.01), options);
    for (const double h : {1e-4, 1e-3, 2e-2}) {
      IntegratorOptions o = all_integrators(h)[2];
      ASSERT_EQ(label(o), "backward-euler cholesky");
      const auto integrator = make(model, o);
      FemState state = model.rest();
      Random random(3);
      for (const int i : model.free_dofs()) state.v[i] = random.uniform(-1, 1);
      VectorXd free(static_cast<Eigen::Index>(model.free_dofs().size()));
      const auto energy = [&] {
        for (std::size_t i = 0; i < model.free_dofs().size(); ++i)
          free[static_cast<Eigen::Index>(i)] = state.v[model.free_dofs()[i]];
        return 0.5 * free.dot(model.mass_matrix() * free) + model.energy(state.u);
      };
      double before = energy();
      for (int i = 0; i < 100; ++i) {
        ASSERT_TRUE(integrator->step(VectorXd::Zero(model.size()), state));
        const double now = energy();
        ASSERT_LE(now, before * (1 + 1e-10)) << "h " << h << " step " << i;
        before = now;
      }
    }
  }
}

TEST(FemIntegrator, AFreeBodyKeepsItsMomentum) {
  FemOptions options;
  options.materials = {{1e4, 0.3, 1000}};
  for (const MassMatrix mass : {MassMatrix::lumped, MassMatrix::consistent}) {
    options.mass = mass;
    FemModel model = testing::make_model(make_slab(3, 2, 1, 0.01), options);
    for (const IntegratorOptions& o : all_integrators(5e-4)) {
      SCOPED_TRACE(label(o));
      const auto integrator = make(model, o);
      FemState state = model.rest();
      Random random(5);
      for (double& v : state.v) v = random.uniform(-0.5, 1);
      const auto momentum = [&]() -> Eigen::Vector3d {
        const VectorXd p = model.mass_matrix() * state.v;
        return {p(Eigen::seq(0, Eigen::last, 3)).sum(), p(Eigen::seq(1, Eigen::last, 3)).sum(),
                p(Eigen::seq(2, Eigen::last, 3)).sum()};
      };
      const Eigen::Vector3d before = momentum();
      run(*integrator, VectorXd::Zero(model.size()), state, 100);
      EXPECT_LT((momentum() - before).norm(), 1e-7 * before.norm());
    }
  }
}

TEST(FemIntegrator, SolversOfOneMethodAgree) {
  for (const MassMatrix mass : {MassMatrix::lumped, MassMatrix::consistent}) {
    FemModel model = strip(Elasticity::corotated, mass);
    std::vector<std::pair<Method, VectorXd>> first;
    for (const IntegratorOptions& o : all_integrators(2e-3)) {
      if (o.method == Method::velocity_verlet) continue;
      FemState state = model.rest();
      run(*make(model, o), strip_load(model), state, 60);
      const Method scheme = o.method == Method::projective ? Method::backward_euler : o.method;
      if (first.empty() || first.back().first != scheme) {
        if (o.method != Method::projective) first.emplace_back(scheme, state.u);
      }
      for (const auto& [method, u] : first) {
        if (method == scheme) {
          EXPECT_LT((state.u - u).norm(), 1e-7 * u.norm()) << label(o);
        }
      }
    }
  }
}

TEST(FemIntegrator, RestStaysAtRest) {
  FemModel model = testing::slab_model();
  for (IntegratorOptions o : all_integrators(1e-3)) {
    o.newton_iterations = 10;
    const auto integrator = make(model, o);
    FemState state = model.rest();
    const auto report = integrator->step(VectorXd::Zero(model.size()), state);
    ASSERT_TRUE(report) << label(o);
    EXPECT_TRUE(report->converged) << label(o);
    EXPECT_LT(state.u.cwiseAbs().maxCoeff(), 1e-15) << label(o);
  }
}

TEST(FemIntegrator, NewtonSaysWhetherItMetItsTolerance) {
  FemModel model = strip();
  IntegratorOptions o = all_integrators(2e-3)[2];
  FemState state = model.rest();
  auto report = make(model, o)->step(strip_load(model), state);
  ASSERT_TRUE(report);
  EXPECT_TRUE(report->converged);
  EXPECT_GT(report->newton_iterations, 1);
  o.newton_iterations = 1;
  state = model.rest();
  report = make(model, o)->step(strip_load(model), state);
  ASSERT_TRUE(report);
  EXPECT_FALSE(report->converged);
}

// A first update that overshoots what rounding leaves must not mark the solve that then ends by rounding.
TEST(FemIntegrator, NoSolveBothConvergesAndDiverges) {
  FemModel model = strip();
  IntegratorOptions o;
  o.method = Method::tr_bdf2;
  o.step = 0.01;
  o.solver = LinearSolver::cholesky;
  Newton newton(model, o, std::make_unique<NewtonDirection>(model, o));
  const Eigen::Index n = newton.system().size();
  const double unit = newton.system().rounding() / std::sqrt(static_cast<double>(n));
  int converged = 0;
  for (double scale = 0.1; scale < 1e6; scale *= 1.05) {
    Stage stage{.c = 0.003, .a = VectorXd::Zero(n), .Mb = VectorXd::Zero(n), .f = VectorXd(n)};
    for (Eigen::Index i = 0; i < n; ++i) stage.f[i] = scale * unit * static_cast<double>(i * 7919 % 13 - 6) / 4;
    VectorXd u = VectorXd::Zero(n);
    const auto report = newton.solve(stage, u);
    ASSERT_TRUE(report);
    converged += report->converged ? 1 : 0;
    EXPECT_FALSE(report->converged && newton.diverged()) << scale;
  }
  EXPECT_GT(converged, 100);
}

TEST(FemIntegrator, StepsAllocateNothing) {
  for (const MassMatrix mass : {MassMatrix::lumped, MassMatrix::consistent}) {
    FemModel model = strip(Elasticity::corotated, mass);
    const VectorXd f = strip_load(model);
    for (const IntegratorOptions& o : all_integrators(2e-4)) {
      const auto integrator = make(model, o);
      FemState state = model.rest();
      run(*integrator, f, state, 1);
      const auto before = testing::heap_calls() + testing::allocated_bytes();
      bool well = true;
      for (int i = 0; i < 140; ++i) well = integrator->step(f, state).has_value() && well;  // the energy is looked at twice
      EXPECT_EQ(testing::heap_calls() + testing::allocated_bytes(), before) << label(o);
      EXPECT_TRUE(well) << label(o);
    }
  }
}

TEST(FemIntegrator, SameInputSameBits) {
  const auto end = [](const IntegratorOptions& o) {
    FemModel model = strip();
    FemState state = model.rest();
    run(*make(model, o), strip_load(model), state, 40);
    return state;
  };
  for (const IntegratorOptions& o : all_integrators(1e-3)) {
    const FemState a = end(o), b = end(o);
    EXPECT_TRUE(a.u == b.u && a.v == b.v) << label(o);
  }
}

TEST(ErrorEstimate, FollowsTheOrderAndLeavesTheSimulationAlone) {
  for (const Method method : {Method::velocity_verlet, Method::backward_euler, Method::newmark, Method::tr_bdf2}) {
    IntegratorOptions o = all_integrators(1e-3)[2];
    o.method = method;
    const auto error = [&](double h) {
      FemOptions undamped = strip().options();
      undamped.mass_damping = undamped.stiffness_damping = 0;
      FemModel model = testing::make_model(make_slab(4, 2, 1, 0.01), undamped);
      const VectorXd f = strip_load(model);
      o.step = h;
      const auto integrator = make(model, o), alone = make(model, o);
      FemState state = model.rest(), copy = state;
      auto estimate = ErrorEstimate::create(model, o, 5).value();
      for (int i = 0; i < static_cast<int>(0.08 / h); ++i) {
        estimate.look(f, state);
        static_cast<void>(integrator->step(f, state));
      }
      FemModel again = testing::make_model(make_slab(4, 2, 1, 0.01), undamped);
      run(*make(again, o), f, copy, static_cast<int>(0.08 / h));
      EXPECT_TRUE(copy.u == state.u && copy.v == state.v);
      return estimate.result().of_motion;
    };
    const bool first = method == Method::backward_euler;
    EXPECT_NEAR(std::log2(error(4e-4) / error(2e-4)), first ? 1 : 2, 0.4) << name(method) << ": of the motion in a step";
  }
}

}  // namespace
}  // namespace tactus::sim
