// SPDX-License-Identifier: Apache-2.0
/// So many steps of the thesis's membrane under 1 N, as the program chooses them: guard_cost STEPS
#include <cstdio>
#include <cstdlib>

#include <tactus/sim/fem/integrator.h>
#include "tests/unit/fem_fixture.h"

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  using namespace tactus;
  sim::FemModel model = testing::slab_model();
  const Eigen::VectorXd load = testing::slab_load(model);
  const auto integrator = std::move(sim::make_integrator(model, choose(model, 1e-3).options).value());
  sim::FemState state = model.rest();
  for (int i = 0; i < std::atoi(argv[1]); ++i)
    if (!integrator->step(load, state)) return 1;
  std::printf("%.9g\n", state.u[3 * testing::kSlabCentre + 2]);
  return 0;
}
