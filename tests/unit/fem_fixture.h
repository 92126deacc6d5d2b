// SPDX-License-Identifier: Apache-2.0
/// The thesis's membrane with 1 cm cells, and other objects that tests and benches of the finite elements share.
#pragma once

#include <vector>

#include <tactus/sim/fem/model.h>
#include <tactus/sim/tets/tet_mesh.h>

namespace tactus::testing {

inline constexpr std::uint32_t kSlabX = 16, kSlabY = 20;
inline constexpr std::uint32_t kSlabCentre = 535;  ///< vertex in the middle of the top

/// The eight corner vertices of a slab.
inline std::vector<std::uint32_t> slab_corners(std::uint32_t nx = kSlabX, std::uint32_t ny = kSlabY, std::uint32_t nz = 1) {
  std::vector<std::uint32_t> out;
  for (const std::uint32_t k : {0U, nz})
    for (const std::uint32_t j : {0U, ny})
      for (const std::uint32_t i : {0U, nx}) out.push_back((k * (ny + 1) + j) * (nx + 1) + i);
  return out;
}

inline sim::FemOptions slab_options(double young = 1e4, double poisson = 0.45) {
  sim::FemOptions options;
  options.materials = {{young, poisson, 1e4}};
  options.fixed = slab_corners();
  return options;
}

inline sim::FemModel make_model(sim::TetMesh mesh, sim::FemOptions options) {
  return sim::FemModel::create(std::move(mesh), std::move(options)).value();
}

inline sim::FemModel slab_model(sim::FemOptions options = slab_options()) {
  return make_model(sim::make_slab(kSlabX, kSlabY, 1, 0.01), std::move(options));
}

/// Symplectic Euler in its shortest form: v += h M^-1 (f - k(u)), u += h v.
struct ExplicitRun {
  ExplicitRun(sim::FemModel& m, double step, Eigen::VectorXd load) : model(m), h(step), f(std::move(load)), state(m.rest()) {
    inverse_mass = Eigen::VectorXd::Zero(m.size());
    for (const int dof : m.free_dofs()) inverse_mass[dof] = 1 / m.lumped_mass()[dof];
  }

  void step() {
    model.internal_forces(state.u, k);
    state.v += h * inverse_mass.cwiseProduct(f - k);
    state.u += h * state.v;
  }

  sim::FemModel& model;
  double h;
  Eigen::VectorXd f, inverse_mass, k;
  sim::FemState state;
};

/// 1 N downwards in the middle of the top.
inline Eigen::VectorXd slab_load(const sim::FemModel& model) {
  Eigen::VectorXd f = Eigen::VectorXd::Zero(model.size());
  f[3 * kSlabCentre + 2] = -1;
  return f;
}

}  // namespace tactus::testing
