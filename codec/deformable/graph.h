// SPDX-License-Identifier: Apache-2.0
/// Data that both ends derive from a mesh: neighbours, rings, coding order and parents. spec/50-deformable.md section 4.
/// Integers only: encoder and decoder must agree on every weight.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <tactus/base/list_of_lists.h>
#include <tactus/scene/deformable_object.h>

namespace tactus {

/// A vertex coded earlier, and its share in the prediction of a later one.
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
  std::vector<ListOfLists<VertexParent>> parents;  ///< by declared set of weights, then by place in `order`; roots have none
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
