// SPDX-License-Identifier: Apache-2.0
/// A user of the component fem: a beam bends under its load, by a method that factors its matrix.
#include <tactus/sim/fem/integrator.h>

#include <cstdio>

namespace {

const char* bend() {
  tactus::sim::FemOptions options;
  options.materials = {{.young = 1e4, .poisson = 0.3, .density = 1000}};
  options.fixed = {0, 5, 10, 15};
  auto model = tactus::sim::FemModel::create(tactus::sim::make_slab(4, 1, 1, 0.01), options);
  if (!model) return "the beam is refused";
  tactus::sim::IntegratorOptions method;
  method.method = tactus::sim::Method::backward_euler;
  method.solver = tactus::sim::LinearSolver::cholesky;
  const auto integrator = tactus::sim::make_integrator(*model, method);
  if (!integrator) return "the method is refused";

  tactus::sim::FemState state = model->rest();
  Eigen::VectorXd load = Eigen::VectorXd::Zero(model->size());
  constexpr Eigen::Index kTip = 3 * 4 + 2;
  load[kTip] = -0.01;
  for (int i = 0; i < 10; ++i)
    if (!(*integrator)->step(load, state)) return "a step diverges";
  return state.u[kTip] < 0 ? nullptr : "the beam does not bend";
}

}  // namespace

int main() {
  const char* complaint = bend();
  std::puts(complaint ? complaint : "a beam bends");
  return complaint ? 1 : 0;
}
