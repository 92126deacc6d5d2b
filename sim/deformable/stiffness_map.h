// SPDX-License-Identifier: Apache-2.0
/// Local stiffness of a deformable object, by which a client with delay softens its coupling. Thesis 4.3.3.2, figure 4.23.
///
///   k(v) = |f| / |u_v|,  K u = f,  f a unit force at surface vertex v along the normal there
///
/// K is that of the rest shape, factored once; each vertex costs one solve.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <tactus/base/result.h>
#include <tactus/base/tri_mesh.h>
#include <tactus/sim/scene/scene.h>
#include <tactus/trace/frame.h>

namespace tactus::sim {

struct StiffnessMap {
  TriMesh surface;                ///< at rest
  std::vector<double> stiffness;  ///< [N/m] per vertex of the surface; infinite where it is fixed

  /// Stiffness at a point of a triangle, linear between its corners; infinite where a fixed corner has a weight.
  double at(std::uint32_t triangle, const std::array<double, 3>& weights) const noexcept {
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k)
      if (weights[k] != 0) sum += weights[k] * stiffness[surface.triangles[triangle][k]];
    return sum;
  }
};

/// time one factorisation and one solve per surface vertex: 0.2 s for 714 vertices
/// err  internal R-FEM-7: K is singular, as too little is fixed; R-FEM-1..4, R-TET-n: the object is invalid; unsupported R-SIM-2:
///      this build has no finite elements
Result<StiffnessMap> stiffness_map(const SceneDeformable& object);

/// Largest stable sum of couplings [N/m] that press this object at one point: eq. 4.38 with the object's deformation period,
/// k_o = |f| / |u . n| at that point, the effective mass of that triangle, 1 / sum of w^2 / m, and the damping of both. Eq. 4.38
/// assumes that all else rests; here neighbours yield too, so that several times as much may be stable.
/// time one construction of the model and one solve by conjugate gradients: 25 ms for 2000 tetrahedra
/// err  R-FEM-1..4, R-TET-n: the object is invalid; unsupported R-SIM-2: this build has no finite elements
Result<double> critical_stiffness(const SceneDeformable& object, const SurfaceContact& contact);

}  // namespace tactus::sim
