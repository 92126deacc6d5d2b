// SPDX-License-Identifier: Apache-2.0
/// The thesis's membrane with 1 cm cells, and other objects that tests and benches of the finite elements share.
#pragma once

#include <vector>

#include "sim/fem/model.h"
#include "sim/mesh/tet_mesh.h"

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

inline FemOptions slab_options(double young = 1e4, double poisson = 0.45) {
  FemOptions options;
  options.materials = {{young, poisson, 1e4}};
  options.fixed = slab_corners();
  return options;
}

inline FemModel make_model(TetMesh mesh, FemOptions options) {
  return FemModel::create(std::move(mesh), std::move(options)).value();
}

inline FemModel slab_model(FemOptions options = slab_options()) {
  return make_model(make_slab(kSlabX, kSlabY, 1, 0.01), std::move(options));
}

}  // namespace tactus::testing
