// SPDX-License-Identifier: Apache-2.0
// Linear algebra under the integrators: the Cholesky factor, conjugate gradients; modal reduction in time.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <numbers>

#include <tactus/sim/fem/cholesky.h>
#include <tactus/sim/fem/integrator.h>
#include <tactus/sim/fem/linear_solver.h>
#include <tactus/sim/fem/modal.h>
#include <tactus/sim/random.h>
#include "tests/unit/fem_fixture.h"

namespace tactus::sim {
namespace {

using Eigen::VectorXd;

VectorXd random_vector(Eigen::Index size) {
  Random random(7);
  VectorXd out(size);
  for (double& x : out) x = random.uniform(-1, 1);
  return out;
}

FemModel free_slab(std::uint32_t nx, std::uint32_t ny, std::uint32_t nz, Elasticity elasticity = Elasticity::linear) {
  FemOptions options;
  options.materials = {{1e4, 0.3, 1000}};
  options.elasticity = elasticity;
  return testing::make_model(make_slab(nx, ny, nz, 0.01), options);
}

TEST(Cholesky, SolvesSheetsBodiesAndParts) {
  for (const auto& [nx, ny, nz] : {std::array{1U, 1U, 1U}, {16U, 20U, 1U}, {5U, 5U, 5U}, {40U, 1U, 1U}}) {
    FemModel model = free_slab(nx, ny, nz);
    SystemMatrix matrix(model);
    const SparseMatrix& A = matrix.assemble(VectorXd::Zero(model.size()), 1e6, 1);
    Cholesky cholesky;
    cholesky.analyse(A);
    ASSERT_TRUE(cholesky.factor(A));
    const VectorXd b = random_vector(A.rows());
    VectorXd x(A.rows()), again = b;
    cholesky.solve(b, x);
    EXPECT_LT((A * x - b).norm(), 1e-12 * b.norm()) << nx << " " << ny << " " << nz;
    cholesky.solve(again, again);
    EXPECT_TRUE(again == x) << "in place";
  }
}

TEST(Cholesky, TakesPatternsThatLeaveHolesInBlocksAndNothingAtAll) {
  SparseMatrix A(9, 9);
  for (int i = 0; i < 9; ++i) {
    A.insert(i, i) = 2 + i;
    if (i > 0) A.insert(i, i - 1) = A.insert(i - 1, i) = -0.3 * i;
  }
  A.makeCompressed();
  Cholesky cholesky;
  cholesky.analyse(A);
  ASSERT_TRUE(cholesky.factor(A));
  const VectorXd b = random_vector(9);
  VectorXd x(9);
  cholesky.solve(b, x);
  EXPECT_LT((A * x - b).norm(), 1e-14 * b.norm());

  const SparseMatrix none(0, 0);
  VectorXd empty;
  cholesky.analyse(none);
  EXPECT_TRUE(cholesky.factor(none));
  cholesky.solve(empty, empty);
  EXPECT_EQ(cholesky.fill(), 0);
}

TEST(Cholesky, RefusesWhatIsNotPositiveDefiniteAndWorksAgainAfterwards) {
  FemModel model = free_slab(3, 3, 1);
  SystemMatrix matrix(model);
  Cholesky cholesky;
  cholesky.analyse(matrix.matrix());
  EXPECT_FALSE(cholesky.factor(matrix.assemble(VectorXd::Zero(model.size()), -1e6, 1)));
  SparseMatrix broken = matrix.assemble(VectorXd::Zero(model.size()), 1e6, 1);
  broken.valuePtr()[0] = std::nan("");
  EXPECT_FALSE(cholesky.factor(broken));
  const SparseMatrix& A = matrix.assemble(VectorXd::Zero(model.size()), 1e6, 1);
  ASSERT_TRUE(cholesky.factor(A));
  const VectorXd b = random_vector(A.rows());
  VectorXd x(A.rows());
  cholesky.solve(b, x);
  EXPECT_LT((A * x - b).norm(), 1e-12 * b.norm());
}

TEST(Cholesky, FillOfTheMembraneIsThatOfAGoodOrdering) {
  FemModel model = testing::slab_model();
  SystemMatrix matrix(model);
  Cholesky cholesky;
  cholesky.analyse(matrix.matrix());
  EXPECT_LT(cholesky.fill(), 150000);
  EXPECT_GT(cholesky.fill(), matrix.matrix().nonZeros() / 2);
}

TEST(ConjugateGradients, MeetTheirToleranceAndStartWarm) {
  FemModel model = free_slab(6, 5, 2);
  SystemMatrix matrix(model);
  const SparseMatrix& A = matrix.assemble(VectorXd::Zero(model.size()), 1e5, 1);
  const VectorXd b = random_vector(A.rows());
  for (const double tolerance : {1e-3, 1e-6, 1e-12}) {
    ConjugateGradients gradients(A.rows(), tolerance);
    gradients.prepare(A);
    VectorXd x = VectorXd::Zero(A.rows());
    const int cold = gradients.solve(A, b, x);
    EXPECT_LE((A * x - b).norm(), 1.01 * tolerance * b.norm());
    EXPECT_GT(cold, 1);
    EXPECT_LE(gradients.solve(A, b, x), 1) << "from the solution";
    x *= 1e6;
    EXPECT_LE(gradients.solve(A, b, x), cold) << "a start worse than zero is dropped";
  }
}

/// A cantilever of few vertices, all modes counted.
FemModel small_cantilever(double mass_damping, double stiffness_damping) {
  FemOptions options;
  options.materials = {{1e4, 0.3, 1000}};
  options.elasticity = Elasticity::linear;
  options.fixed = {0, 5, 10, 15, 20, 25};
  options.mass_damping = mass_damping;
  options.stiffness_damping = stiffness_damping;
  return testing::make_model(make_slab(4, 2, 1, 0.01), options);
}

FemState after(FemModel& model, const IntegratorOptions& options, int steps) {
  const auto integrator = std::move(make_integrator(model, options).value());
  FemState state = model.rest();
  VectorXd f = VectorXd::Zero(model.size());
  for (int i = 0; i < steps; ++i) {
    f[3 * 29 + 2] = i < steps / 2 ? -0.05 : 0.02;
    static_cast<void>(integrator->step(f, state).value());
  }
  return state;
}

TEST(Modal, WithAllModesIsTheLinearProblemExactInTime) {
  for (const auto& [alpha, beta] : {std::pair{0.0, 0.0}, {2.0, 1e-3}, {0.0, 0.5}}) {  // the last: overdamped
    FemModel model = small_cantilever(alpha, beta);
    IntegratorOptions modal;
    modal.method = Method::modal;
    modal.modes = static_cast<int>(model.free_dofs().size());
    modal.step = 2e-3;
    const FemState exact = after(model, modal, 20);
    const auto error = [&](double h) {
      IntegratorOptions o;
      o.method = Method::tr_bdf2;
      o.solver = LinearSolver::cholesky;
      o.step = h;
      return (after(model, o, static_cast<int>(std::lround(0.04 / h))).u - exact.u).norm() / exact.u.norm();
    };
    const double coarse = error(1e-4), fine = error(5e-5);
    EXPECT_LT(fine, 1e-3);
    EXPECT_NEAR(std::log2(coarse / fine), 2, 0.3) << "alpha " << alpha << " beta " << beta;
  }
}

TEST(Modal, AModeReturnsAfterItsPeriod) {
  FemModel model = small_cantilever(0, 0);
  const Modes modes = slowest_modes(model, 3).value();
  IntegratorOptions o;
  o.method = Method::modal;
  o.modes = 3;
  constexpr int kSteps = 50;
  o.step = 2 * std::numbers::pi / std::sqrt(modes.squares[1]) / kSteps;
  FemState state = model.rest();
  const auto dofs = model.free_dofs();
  for (std::size_t i = 0; i < dofs.size(); ++i) state.u[dofs[i]] = 1e-3 * modes.shapes(static_cast<Eigen::Index>(i), 1);
  const VectorXd start = state.u;
  const auto integrator = std::move(make_integrator(model, o).value());
  for (int i = 0; i < kSteps; ++i) {
    static_cast<void>(integrator->step(VectorXd::Zero(model.size()), state).value());
    if (i == kSteps / 2 - 1) {
      EXPECT_LT((state.u + start).norm(), 1e-9 * start.norm());
    }
  }
  EXPECT_LT((state.u - start).norm(), 1e-9 * start.norm());
}

}  // namespace
}  // namespace tactus::sim
