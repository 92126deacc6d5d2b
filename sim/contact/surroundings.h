// SPDX-License-Identifier: Apache-2.0
/// Cache of the triangles around a sphere that makes many small moves: collected from the tree once, then queried without it.
///
/// Most of them need no distance query. A triangle is convex: for any direction n, it lies wholly behind the plane across n
/// through its foremost corner. A sphere meets no point of the triangle if its path starts and ends before that plane by more
/// than its radius. The direction from the triangle's closest point gives the best plane and is kept once that point was
/// computed. Until then the direction from the box of the tree's leaf is used.
///
/// Results are those of the tree, bit for bit: a triangle is left out only if it is farther than contact by half the slack, which
/// is a million times the rounding of positions.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include <tactus/base/geometry.h>
#include <tactus/sim/contact/aabb_tree.h>

namespace tactus::sim {

// ==== constraints ====
// The constraint planes of a virtual proxy, and its goal among them (thesis 2.3.4.1): one plane on a face, two in a groove,
// three in a corner.
//
//   minimise |x - goal|  with  n_i . x >= o_i        x = goal + sum lambda_i n_i,  lambda_i >= 0
// lambda_i [m] is the part of the probe's depth that plane i resists; times the stiffness, it is the force of that plane.

/// n . x >= offset, n of unit length
struct Halfspace {
  Vec3 normal;
  double offset = 0;
};

inline constexpr std::size_t kMaxHalfspaces = 6;

struct Constrained {
  Vec3 point;                                   ///< x
  std::array<double, kMaxHalfspaces> lambda{};  ///< per half-space; at most three are not zero
  double sum() const noexcept;                  ///< of lambda
};

/// Nearest point to the goal in the intersection, found by trying sets of active planes.
/// in   planes  at most kMaxHalfspaces
///      slack   [m] tolerated depth below a plane: rounding is no contact
/// out  nothing when rounding hides the answer (nearly parallel planes)
/// time O(1): at most 42 sets of planes are tried; no allocation
std::optional<Constrained> nearest_within(std::span<const Halfspace> planes, const Vec3& goal, double slack) noexcept;

// ==== surroundings ====

class TriangleCache {
 public:
  /// in   reach  [m] how far the sphere's centre is expected to go
  /// pre  tree and vertices outlive this object and do not change meanwhile
  TriangleCache(const AabbTree& tree, std::span<const Vec3> vertices, double reach) noexcept
      : tree_(tree), vertices_(vertices), wanted_reach_(reach) {
    known_.fill(MeshTopology::kNone);
  }

  /// As AabbTree::sweep, with contacts up to a fraction `limit` of the path.
  /// time O(log n) at a new position; then 5 ns per triangle around and 0.1 us per one close by; no allocation
  std::optional<SurfaceHit> sweep(const Sweep& sphere, std::span<const std::uint32_t> left_out, double limit = 1) noexcept;
  /// The same with one triangle of the tree.
  std::optional<SurfaceHit> sweep_one(const Sweep& sphere, std::uint32_t triangle) noexcept;

 private:
  /// A triangle lies where n . p <= offset, n of unit length. Plain numbers: an array of Vec3 would be set to zero every time.
  struct Plane {
    double x, y, z, offset;
  };
  struct Candidate {
    std::uint32_t leaf;
    Plane plane;
  };
  static constexpr std::size_t kRoom = 512;   // candidates
  static constexpr std::size_t kKnown = 128;  // planes by closest points, by number of the leaf

  static Plane plane_before(const Vec3& normal, const Corners& v) noexcept;
  static bool clears(const Plane& plane, const Sweep& sphere, double limit) noexcept;
  bool knows(std::uint32_t leaf) const noexcept { return known_[leaf % kKnown] == leaf; }
  std::optional<SurfaceHit> ask(std::uint32_t number, const Sweep& sphere, double limit) noexcept;
  bool collect(const Vec3& centre, double reach, const Sweep& sphere) noexcept;
  double covered(const Sweep& sphere) const noexcept;
  double cover(const Sweep& sphere, double limit) noexcept;
  std::optional<SurfaceHit> first_around(const Sweep& sphere, std::span<const std::uint32_t> left_out, double limit) noexcept;

  const AabbTree& tree_;
  std::span<const Vec3> vertices_;
  double wanted_reach_;
  bool is_of_use_ = true;  // false if there are too many triangles, or the sphere goes too far
  Vec3 centre_;
  double reach_ = -1;  // [m] within this distance of centre_ the candidates are complete
  std::size_t count_ = 0;
  std::array<Candidate, kRoom> candidates_;
  std::array<std::uint32_t, kKnown> known_;
  std::array<Plane, kKnown> planes_;
};

}  // namespace tactus::sim
