// SPDX-License-Identifier: Apache-2.0
/// Tree of axis-aligned boxes over the triangles of a mesh. Thesis 2.3.3, figure 2.5.
///
/// Built once by splitting at the median of the longest side. When vertices move, refit() updates the boxes and keeps the tree.
/// Boxes are single precision, enlarged by 2^-22 of the coordinates, so that pruning loses no result of the double precision
/// arithmetic: every query returns, bit for bit, what trying all triangles returns. Results do not depend on the order of
/// triangles, vertices or corners, except for ties: of several triangles at the same point the lowest number wins.
///
/// The caller owns the vertices and hands in those that the boxes were fitted to.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include <tactus/base/geometry.h>
#include <tactus/base/tri_mesh.h>
#include <tactus/sim/contact/triangle.h>

namespace tactus::sim {

// ==== aabb tree ====

enum class Feature : std::uint8_t { vertex = 1, edge = 2, face = 3 };

/// A point on a mesh.
struct SurfacePoint {
  std::uint32_t triangle = MeshTopology::kNone;
  std::array<double, 3> weights{};  ///< of the triangle's corners, sum 1; exactly zero where a corner has no part in it
  Vec3 point;                       ///< [m]
  double distance = 0;              ///< [m] from the point asked for

  Feature feature() const noexcept { return static_cast<Feature>((weights[0] != 0) + (weights[1] != 0) + (weights[2] != 0)); }
};

/// Where a segment or a moving sphere first meets the mesh.
struct SurfaceHit {
  double t = 0;     ///< fraction of the path, 0..1
  double rest = 0;  ///< fraction of the path, 0..t, up to which a sphere keeps its slack
  SurfacePoint at;  ///< point met; its distance is to the sphere's centre at that time
};

/// The earlier of two contacts; at the same time, that of the triangle with the lower number.
inline bool earlier(const SurfaceHit& hit, const std::optional<SurfaceHit>& first) noexcept {
  return !first || hit.t < first->t || (hit.t == first->t && hit.at.triangle < first->at.triangle);
}

class AabbTree {
 public:
  AabbTree() = default;
  /// Tree over a whole mesh.   time O(n log n), 60 ms for 100 000 triangles
  explicit AabbTree(const TriMesh& mesh);

  /// Reserve memory for trees over up to `triangles` of a mesh's `numbers` triangles; build() then allocates nothing.
  void reserve(std::size_t triangles, std::size_t numbers);
  /// Tree over some triangles of a mesh, which keep their numbers.   time O(n log n)
  /// pre  the numbers in `chosen` are distinct
  void build(std::span<const Triangle> triangles, std::span<const std::uint32_t> chosen, std::span<const Vec3> vertices);
  /// Fit the boxes to moved vertices. Queries then return what a new tree would (up to rounding of points, because corners keep
  /// the order of the positions when built).   time O(n), 9 us for 1424 triangles; no allocation
  void refit(std::span<const Vec3> vertices) noexcept;

  /// Closest point of the mesh that is no further than `within` [m].   time O(log n) near the surface, no allocation
  std::optional<SurfacePoint> closest(const Vec3& point, std::span<const Vec3> vertices,
                                      double within = std::numeric_limits<double>::infinity()) const noexcept;
  /// First contact of a moving sphere with any triangle but those left out.   time O(log n + triangles near the path), no allocation
  std::optional<SurfaceHit> sweep(const Sweep& sphere, std::span<const Vec3> vertices,
                                  std::span<const std::uint32_t> left_out = {}) const noexcept;
  /// The same with one triangle of the tree.
  std::optional<SurfaceHit> sweep(const Sweep& sphere, std::span<const Vec3> vertices, std::uint32_t triangle) const noexcept;
  /// Call visit(triangle, corners) for every triangle whose box reaches into a sphere, in no particular order.
  template <class Visit>
  void visit_sphere(const Vec3& centre, double radius, std::span<const Vec3> vertices, Visit&& visit) const;

  /// True if a moving sphere stays outside of the box around all triangles.   time O(1)
  bool is_far(const Sweep& sphere) const noexcept {
    return nodes_.empty() || !near_segment(nodes_[0].box, sphere.from, sphere.displacement, sphere.radius + sphere.slack);
  }
  bool contains(std::uint32_t triangle) const noexcept { return triangle < leaf_of_.size() && leaf_of_[triangle] != kAbsent; }
  std::size_t size() const noexcept { return leaves_.size(); }
  /// Vertices of a triangle of the tree, in the mesh's order.
  Triangle triangle(std::uint32_t number) const noexcept;

 private:
  friend class TriangleCache;

  struct Box {
    std::array<float, 3> low, high;
  };
  struct Node {
    Box box;
    std::uint32_t next = 0;   // inner node: its second child, the first one follows it. Leaf: its first triangle
    std::uint32_t count = 0;  // triangles of a leaf, 0 for an inner node
  };
  struct Leaf {
    Triangle vertices;                  // by position when built, so that results depend on the shape alone
    std::uint32_t triangle = 0;         // its number in the mesh
    std::array<std::uint8_t, 3> order;  // which corner in the mesh each of the vertices is
  };
  static constexpr std::uint32_t kAbsent = 0xffffffff;
  static constexpr std::uint32_t kLeafSize = 2;
  static constexpr std::size_t kMaxDepth = 64;  // of the stack; halving 2^21 triangles needs 22

  void split(std::uint32_t first, std::uint32_t last, std::span<const Vec3> vertices);
  static Corners corners(const Leaf& leaf, std::span<const Vec3> vertices) noexcept {
    return {vertices[leaf.vertices[0]], vertices[leaf.vertices[1]], vertices[leaf.vertices[2]]};
  }
  static SurfacePoint named(const Leaf& leaf, const std::array<double, 3>& weights, const Vec3& point, double distance) noexcept;
  static Vec3 away(const Box& box, const Vec3& point) noexcept;
  static double distance2(const Box& box, const Vec3& point) noexcept { return dot(away(box, point), away(box, point)); }
  /// Call visit(node) for every leaf that reaches into a sphere. Stops and returns false as soon as visit() does.
  template <class Visit>
  bool visit_boxes(const Vec3& centre, double radius, Visit&& visit) const;
  static bool near_segment(const Box& box, const Vec3& from, const Vec3& displacement, double radius) noexcept;
  template <class Test>
  void along(const Vec3& from, const Vec3& displacement, double radius, Test&& test) const noexcept;

  std::vector<Node> nodes_;  // parents before children
  std::vector<Leaf> leaves_;
  std::vector<std::uint32_t> leaf_of_;  // by number of the triangle
};

inline Vec3 AabbTree::away(const Box& box, const Vec3& point) noexcept {
  const auto twice = [](double x) { return x + std::abs(x); };  // of x if positive: comparisons here would be mispredicted
  const auto beyond = [&](double low, double x, double high) { return 0.5 * (twice(x - high) - twice(low - x)); };
  return {beyond(box.low[0], point.x, box.high[0]), beyond(box.low[1], point.y, box.high[1]),
          beyond(box.low[2], point.z, box.high[2])};
}

template <class Visit>
bool AabbTree::visit_boxes(const Vec3& centre, double radius, Visit&& visit) const {
  if (nodes_.empty()) return true;
  const double radius2 = radius * radius;
  std::array<std::uint32_t, kMaxDepth> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const std::uint32_t index = stack[--depth];
    const Node& node = nodes_[index];
    if (distance2(node.box, centre) * (1 - 1e-14) > radius2) continue;
    if (node.count == 0) {
      stack[depth++] = node.next;
      stack[depth++] = index + 1;
    } else if (!visit(node)) {
      return false;
    }
  }
  return true;
}

template <class Visit>
void AabbTree::visit_sphere(const Vec3& centre, double radius, std::span<const Vec3> vertices, Visit&& visit) const {
  visit_boxes(centre, radius, [&](const Node& node) {
    for (const Leaf& leaf : std::span(leaves_).subspan(node.next, node.count)) visit(leaf.triangle, corners(leaf, vertices));
    return true;
  });
}

// ==== inside ====
// Tests which points lie inside a mesh: those below the closest point of a closed component. An open component has no inside.
//
// "Below" refers to the normals around the closest point, each weighted by the angle of its triangle there. Only this weighting
// gives the right sign at every edge and corner (Baerentzen and Aanaes 2005).

class InsideTest {
 public:
  /// pre  both outlive this object.   time O(n); allocates
  InsideTest(const TriMesh& mesh, const MeshTopology& topology);

  /// Normal at a point of the mesh, of unit length, outward; zero where triangles have no area.   time O(triangles there)
  Vec3 normal(const SurfacePoint& at, std::span<const Vec3> vertices) const noexcept;
  /// in  closest  the point of the mesh that is closest to `point`
  bool contains(const Vec3& point, const SurfacePoint& closest, std::span<const Vec3> vertices) const noexcept;

 private:
  const TriMesh& mesh_;
  const MeshTopology& topology_;
  std::vector<bool> closed_;  // per triangle: no boundary anywhere in its component
};

}  // namespace tactus::sim
