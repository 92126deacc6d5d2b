// SPDX-License-Identifier: Apache-2.0
#include "sim/fem/model.h"

#include <gtest/gtest.h>

#include "tests/unit/fem_fixture.h"

namespace tactus {
namespace {

/// z of the loaded vertex after `steps` of symplectic Euler under 1 N downwards.
double deflection(FemModel& model, double h, int steps) {
  FemState state = model.rest();
  Eigen::VectorXd k;
  for (int i = 0; i < steps; ++i) {
    model.internal_forces(state.u, k);
    k = -k;
    k[3 * testing::kSlabCentre + 2] -= 1;
    for (const int dof : model.free_dofs()) {
      state.v[dof] += h * k[dof] / model.lumped_mass()[dof];
      state.u[dof] += h * state.v[dof];
    }
  }
  return state.u[3 * testing::kSlabCentre + 2];
}

// VegaFEM 3.1, SOFA (FastTetrahedralCorotational) and a prototype agree on all these digits.
TEST(FemModel, MembraneUnderOneNewtonMovesAsThreeOtherProgramsSay) {
  FemModel model = testing::slab_model();
  EXPECT_NEAR(deflection(model, 1e-3, 300), -0.058463, 5e-7);
}

TEST(FemModel, LinearMembraneMovesFarther) {
  FemOptions options = testing::slab_options();
  options.elasticity = Elasticity::linear;
  FemModel model = testing::slab_model(options);
  EXPECT_NEAR(deflection(model, 1e-3, 300), -0.065721, 5e-7);
}

// Reference values rounded to 1 rad/s; ours may be up to 1e-3 above the true one, never below.
TEST(FemModel, LargestFrequencyOfTheMembrane) {
  struct Row {
    double young, poisson, omega;
  };
  for (const Row& row : {Row{1e4, 0.30, 339}, Row{1e4, 0.45, 578}, Row{2.5e3, 0.45, 289}, Row{1e4, 0.49, 1241},
                         Row{1e4, 0.499, 3890}, Row{1e6, 0.45, 5778}}) {
    const double omega = testing::slab_model(testing::slab_options(row.young, row.poisson)).largest_frequency();
    EXPECT_GE(omega, row.omega - 0.5);
    EXPECT_LE(omega, 1.001 * (row.omega + 0.5));
  }
}

}  // namespace
}  // namespace tactus
