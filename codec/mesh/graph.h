// SPDX-License-Identifier: Apache-2.0
/// The mesh as a graph: distances at rest, the order in which vertices are coded, from which neighbours each is predicted. Internal to the
/// library.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include <tactus/base/fixed.h>
#include <tactus/base/tri_mesh.h>
#include <tactus/mesh/deformable_object.h>

namespace tactus {

// ==== rest distance ====
// Squared distances of rest positions, on a grid so coarse that they fit 38 bits. spec/50-deformable.md section 4.2. Internal to the
// library.

class RestDistance {
 public:
  explicit RestDistance(std::span<const Vec3i> rest) noexcept {
    std::uint64_t extent = 0;
    for (std::size_t axis = 0; axis < 3 && !rest.empty(); ++axis) {
      const auto [low, high] =
          std::minmax_element(rest.begin(), rest.end(), [axis](const Vec3i& a, const Vec3i& b) { return a[axis] < b[axis]; });
      extent = std::max(extent, static_cast<std::uint64_t>(static_cast<std::int64_t>((*high)[axis]) - (*low)[axis]));
    }
    const auto width = static_cast<unsigned>(std::bit_width(extent));
    shift_ = width > 18 ? width - 18 : 0;
  }
  /// At least 1. Not symmetric.
  std::uint64_t operator()(const Vec3i& a, const Vec3i& b) const noexcept {
    std::uint64_t sum = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::int64_t d = (static_cast<std::int64_t>(a[axis]) - b[axis]) >> shift_;
      sum += static_cast<std::uint64_t>(d * d);
    }
    return std::max<std::uint64_t>(sum, 1);
  }

 private:
  unsigned shift_ = 0;
};

// ==== coding order ====
// In which order vertices are coded, and from which others each may be predicted. spec/50-deformable.md sections 4.2 and 4.3.
//

/// From coarse to fine: vertices in ever finer maximal independent sets.
struct CodingOrder {
  std::vector<std::uint32_t> order;  ///< every vertex once
  std::vector<std::uint8_t> depth;   ///< by vertex: 0 finest; roots have the highest
  ListOfLists<std::uint32_t>
      near;  ///< by index in `order`: at most kParents vertices before it, the nearest first; roots have none
};

/// pre  the triangles name existing vertices, at most 2^20.   time 0.4 us per vertex, allocates
CodingOrder coding_order(const DeformableObject& object);

// ==== graph ====
// Data that both ends derive from a mesh: neighbours, rings, coding order and parents. spec/50-deformable.md section 4.
// Integers only: encoder and decoder must agree on every weight.

/// A vertex coded earlier, and its fraction in the prediction of a later one.
struct VertexParent {
  std::uint32_t vertex = 0;
  std::int32_t weight = 0;  ///< x 2^-15
};

using Neighbours = ListOfLists<std::uint32_t>;

/// Coding order from coarse to fine: vertices in ever finer maximal independent sets, each predicted from near ones before it.
struct VertexHierarchy {
  static constexpr std::size_t kParents = 8;
  static constexpr std::size_t kDepths = 24;

  std::vector<std::uint32_t> order;                ///< every vertex once
  std::vector<std::uint8_t> depth;                 ///< by vertex: 0 finest; roots have the highest
  std::vector<ListOfLists<VertexParent>> parents;  ///< by declared set of weights, then by index in `order`; roots have none
};

/// Two vertices are neighbours if they share an edge, or if they are consecutive among the vertices at one rest position.
/// pre  the triangles name existing vertices.   time O((vertices + triangles) log), allocates
Neighbours neighbours(const DeformableObject& object);
VertexHierarchy vertex_hierarchy(const DeformableObject& object);

/// The area of interest. Holds scratch space, so that queries allocate nothing.
class Rings {
 public:
  explicit Rings(const DeformableObject& object);

  /// Triangles within `rings` rings around `triangle`, itself first, then ring by ring.   time O(size of the rings)
  /// Valid until the next call.
  std::span<const std::uint32_t> triangles_around(std::uint32_t triangle, std::uint32_t rings) noexcept;
  /// Corners of the triangles of the last call, each once.
  std::span<const std::uint32_t> vertices() const noexcept { return vertices_; }

 private:
  void add_corners(std::uint32_t triangle) noexcept;

  std::span<const Triangle> corners_;
  ListOfLists<std::uint32_t> triangles_of_;
  std::vector<std::uint32_t> triangle_mark_, vertex_mark_;
  std::vector<std::uint32_t> triangles_, vertices_;
  std::uint32_t mark_ = 0;
};

}  // namespace tactus
