// SPDX-License-Identifier: Apache-2.0
/// All tetrahedra of a deformable object, and the sums over them: forces and energy. Inside of FemModel.
///
/// symbol  meaning                                                    per element
/// F       deformation gradient I + sum_r (u_r - u_0) g_r^T           u_r displacements of corners 0..3
/// g_r     gradient of corner r's shape function [1/m]                rows of the inverse of the rest edges; g_0 = -g_1 -g_2 -g_3
/// R       rotation nearest to F (rotation.h); I when linear          iterated from the stored one
/// e       sym(R^T F) - I                                             strain in the element's own frame
/// W       V (mu |e|^2 + lambda/2 tr(e)^2)                            energy [J]
/// k_r     V R (2 mu e + lambda tr(e) I) g_r                          force of corner r [N] = dW/dx_r, also = R K_e (R^T x - X)
///
/// The warped force is the exact gradient of W: R is a stationary point of trace(R^T F), so dR drops out of both terms of dW
/// ((S - I) S is symmetric, dR^T R antisymmetric). fem_element_test holds it against differences.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <tactus/sim/fem/element_block.h>
#include <tactus/sim/fem/rotation.h>
#include <tactus/sim/tets/tet_mesh.h>

namespace tactus::sim {

struct Lame {
  double mu = 0, lambda = 0;  ///< [N/m^2]
};

class Elements {
 public:
  /// pre  the mesh passed check(); one Lame pair per tetrahedron
  Elements(const TetMesh& mesh, std::span<const Lame> moduli, bool corotated);

  std::size_t size() const noexcept { return size_; }
  /// k = forces at displacements u (both 3N); stores R.   time O(tets), no allocation.
  void forces(const double* u, double* k) noexcept;
  /// Sum of W; computes R without storing it.   time O(tets), no allocation.
  double energy(const double* u) noexcept;
  /// Store R at u; nothing when linear.   time O(tets), no allocation.
  void turn(const double* u) noexcept;

  /// The stored R.
  Quat rotation(std::size_t element) const noexcept;
  /// g_0..g_3 [1/m]
  std::array<Vec3, 4> gradients(std::size_t element) const noexcept;
  /// V mu, V lambda [J]
  Lame moduli(std::size_t element) const noexcept;
  /// F at u.
  Matrix3 deformation(std::size_t element, const double* u) const noexcept;
  /// 3 x the number of each corner: where its displacement begins in u.
  std::array<std::uint32_t, 4> corners(std::size_t element) const noexcept;

  /// Use another instruction set than the widest.   pre  supported(set)
  void use(InstructionSet set) noexcept { kernels_ = kernels(set); }

 private:
  /// Consecutive elements share vertices. They go to consecutive blocks, so that the elements of one block seldom share a vertex
  /// and its sums do not wait for each other. `kDeal` blocks are filled at a time, so that the working set stays in the cache.
  struct Slot {
    std::size_t block, lane;
  };
  Slot slot_of(std::size_t element) const noexcept {
    const std::size_t first = element / (kDeal * kBlockSize) * kDeal, dealt = std::min(kDeal, blocks_.size() - first);
    const std::size_t i = element - first * kBlockSize;
    return {first + i % dealt, i / dealt};
  }
  void spread(const double* u) noexcept;

  static constexpr std::size_t kDeal = 16;
  std::vector<ElementBlock> blocks_;
  std::vector<VertexVector> u_, k_;
  std::size_t size_ = 0;
  bool corotated_ = true;
  ElementKernels kernels_ = kernels(widest());
};

}  // namespace tactus::sim
