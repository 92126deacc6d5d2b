// SPDX-License-Identifier: Apache-2.0
/// Triangle meshes, and lists of lists in one block of memory.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <tactus/base/diagnostic.h>
#include <tactus/base/geometry.h>

namespace tactus {

// ==== list of lists ====

/// Lists of lists in one array: list i begins at items[first[i]].
template <class T>
struct ListOfLists {
  std::vector<std::uint32_t> first{0};
  std::vector<T> items;

  std::span<const T> operator[](std::size_t i) const noexcept {
    return std::span<const T>(items).subspan(first[i], first[i + 1] - first[i]);
  }
  std::size_t size() const noexcept { return first.size() - 1; }
  void close() { first.push_back(static_cast<std::uint32_t>(items.size())); }
  friend bool operator==(const ListOfLists&, const ListOfLists&) = default;
};

// ==== tri mesh ====
// Triangle meshes: the visible and touchable surface of an object. Open or closed, several components, boundary allowed.
//
// rule      class           element   broken when
// R-SRF-8   invalid         vertex    a coordinate is NaN or infinite, or larger than 1e6 m
// R-SRF-9   invalid         triangle  an index is not that of a vertex
// R-SRF-10  invalid         triangle  two of its corners are the same vertex, or its area is zero in double precision
// R-SRF-11  invalid         triangle  an edge belongs to a third triangle
// R-SRF-12  invalid         triangle  a neighbour across an edge is oriented the other way round (or the triangle stands there twice)
// R-SRF-13  invalid         vertex    its triangles form more than one fan
// R-SRF-14  limit_exceeded  0         more than 2^20 vertices or 2^21 triangles

using Triangle = std::array<std::uint32_t, 3>;  ///< corners counter-clockwise seen from outside

struct TriMesh {
  std::vector<Vec3> vertices;  ///< [m]
  std::vector<Triangle> triangles;
};

inline constexpr std::size_t kMaxMeshVertices = std::size_t{1} << 20;
inline constexpr std::size_t kMaxMeshTriangles = std::size_t{1} << 21;

/// Checks all rules above; reports the first broken one in element order.   time O(n log n); allocates.   err  R-SRF-8..14
tl::expected<void, Diagnostic> check(const TriMesh& mesh);

/// Adjacency: triangles around vertices and across edges. Built once from connectivity alone.
/// pre  the mesh passed check()
class MeshTopology {
 public:
  explicit MeshTopology(const TriMesh& mesh);

  std::span<const std::uint32_t> triangles_of(std::uint32_t vertex) const noexcept;
  /// Triangle across the edge from corner k to corner k+1, or kNone at a boundary.
  std::uint32_t across(std::uint32_t triangle, unsigned k) const noexcept { return across_[triangle][k]; }
  static constexpr std::uint32_t kNone = 0xffffffff;

  /// Triangles within `rings` rings around one, itself first, then ring by ring: ring r+1 holds those that share a vertex with
  /// ring r (thesis 3.3.1.1, the area of interest).   in  out  cleared and filled; its capacity is reused
  void rings_around(std::uint32_t triangle, unsigned rings, std::vector<std::uint32_t>& out) const;

 private:
  std::vector<std::uint32_t> first_triangle_, triangle_list_;
  std::vector<Triangle> corners_;
  std::vector<std::array<std::uint32_t, 3>> across_;
};

}  // namespace tactus
