// SPDX-License-Identifier: Apache-2.0
/// Bases of a deformable object that both ends compute: from springs along its edges, or from clusters of vertices. Internal to the library.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <tactus/base/fixed.h>
#include <tactus/mesh/deformable_object.h>
#include <tactus/mesh/graph.h>

namespace tactus {

// ==== spring network ====
// A network of springs between vertices near each other. spec/50-deformable.md section 10.2.
//   energy x = sum over springs of (n . d)^2 + |d|^2 / 256,  d the difference of the displacements of its ends, n its direction at rest
// The first part is that of springs; the second keeps a flat sheet from moving out of its plane without effort.
// binary64 in the written order: both ends must agree on every bit.

/// A few columns of displacements, row by row: 3 rows for each vertex. Columns are padded with zeros to a multiple of kLanes.
struct Columns {
  static constexpr std::size_t kLanes = 8;

  Columns() = default;
  Columns(std::size_t height, std::size_t width)
      : rows(height), columns(width), stride((width + kLanes - 1) / kLanes * kLanes), values(rows * stride) {}
  double* row(std::size_t i) noexcept { return values.data() + i * stride; }
  const double* row(std::size_t i) const noexcept { return values.data() + i * stride; }

  std::size_t rows = 0, columns = 0, stride = 0;
  std::vector<double> values;
};

class SpringNetwork {
 public:
  static constexpr std::size_t kNear = 24;

  /// in   rest   all vertices of the object;  members  those of the network;  free  by member
  /// pre  2^20 vertices at most.   time 5 ns * members^2, allocates
  SpringNetwork(std::span<const Vec3i> rest, std::span<const std::uint32_t> members, std::span<const std::uint8_t> free);

  /// An upper bound of the largest eigenvalue of K, at least 1.
  double bound() const noexcept { return bound_; }
  /// K x, zero where a member is not free.   pre  both have three rows for each member.   time O(springs * columns)
  void multiply(const Columns& x, Columns& out) const noexcept;

 private:
  struct Spring {
    std::array<std::uint32_t, 2> ends;  // indices into `members`
    std::array<double, 3> direction;
  };

  void find_bound(std::size_t members);

  std::vector<Spring> springs_;
  std::vector<std::uint32_t> fixed_;  // indices
  double bound_ = 1;
};

// ==== ritz ====
// The eigenvectors of K in the space of a few columns: Rayleigh-Ritz. spec/50-deformable.md section 10.4.
// binary64 in the written order: both ends must agree on every bit.

/// Replace the columns of x by vectors of the same space that are orthonormal and diagonalise x^T K x, the smallest first.
/// in   product  K x
/// ret  the diagonal.   time O(rows * columns^2), allocates
std::vector<double> rotate_to_ritz_vectors(Columns& x, const Columns& product);

// ==== spring basis ====
// The basis that both ends compute from the rest mesh and the fixed vertices: about the slowest modes of a network of springs.
// spec/50-deformable.md section 10.
//
// The modes are found on at most kBasisCore vertices, from coarse to fine in the coding order, by subspace iteration with Chebyshev
// polynomials. The other vertices get theirs from their parents.

inline constexpr std::size_t kBasisCore = 1024;   ///< vertices among which springs are laid
inline constexpr std::size_t kBasisAnchors = 64;  ///< fixed vertices that a network takes in beside its own

/// pre  the object breaks no rule, and asks for a computed basis
/// time 80 ms for 48 modes of 700 vertices, 160 ms of 50 000; allocates
ModeBasis spring_basis(const DeformableObject& object);

// ==== cluster basis ====
// The basis of an object whose vertices are in clusters: affine maps of the clusters, blended where they meet.
// spec/50-deformable.md section 11.

/// The cluster that a vertex is expected to be in, from those of the vertices below it. spec/50-deformable.md section 1.2
/// in  near  the neighbours of `vertex`;  clusters  of the vertices below it at least
std::uint8_t expected_cluster(std::span<const std::uint32_t> near, std::span<const std::uint8_t> clusters,
                              std::uint32_t vertex) noexcept;

/// pre  the object breaks no rule, and has clusters
/// time about 0.1 us per vertex and round of blending; 40 ms for 7000 vertices and 16 rounds; allocates
ModeBasis cluster_basis(const DeformableObject& object);

}  // namespace tactus
