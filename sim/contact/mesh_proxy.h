// SPDX-License-Identifier: Apache-2.0
/// Haptic rendering of triangle meshes: virtual proxy (god object) with friction cone. Thesis 2.3.4.1, figure 2.6.
///
/// The proxy is a sphere that moves towards the probe as far as the mesh lets it, never through a triangle:
///   1. It sweeps along the straight line to its goal; the first triangle that it meets stops it and adds a plane.
///   2. The goal is the point nearest to the probe above the planes met so far: one holds it on a face, two in a groove, three in
///      a corner (constraints.h). A triangle is convex, so it cannot be crossed by a proxy that stays above its plane.
///   3. Friction: D is the sum of the depths below the active planes. Within mu D of the goal the proxy stays (static friction),
///      else it follows to that distance (dynamic friction).
///   4. When no plane is new, the planes are dropped and met again: beyond a convex edge the old one no longer holds.
/// The distance to the probe never grows, so this ends. After a bounded number of sweeps the rest waits for the next call.
///
/// Triangles have two sides; on an open mesh the proxy touches the side that it came from.
///
/// A point probe is a sphere, too: of radius `skin`, 2^-24 of the largest coordinate (6 nm at 0.1 m), a million times the rounding of
/// positions. Every proxy keeps that distance on top of its radius. A sphere is placed to within 2^-14 of its radius (0.3 um of 5
/// mm).
///
/// Moving surfaces: the proxy first moves with the surface point that holds it or, if free, with the one that expect() found. A
/// surface that was announced to expect() therefore never passes over the proxy, and friction carries the proxy.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include <tactus/sim/contact/aabb_tree.h>
#include <tactus/sim/contact/surroundings.h>

namespace tactus::sim {

struct MeshProxyOptions {
  double friction = 0;  ///< mu >= 0
  double radius = 0;    ///< [m] of the probe, 0: a point
};

/// What a probe touches.
struct ProxyTouch {
  bool touched = false;  ///< false: the proxy is at the probe, and the other fields have no meaning
  std::uint32_t triangle = MeshTopology::kNone;
  std::array<double, 3> weights{};  ///< of its corners: the point touched
  Vec3 proxy;                       ///< [m] x_p, centre of the sphere
  Vec3 normal{0, 0, 1};             ///< of unit length, along the sum of the normal forces, away from the surface
};

class MeshProxy {
 public:
  /// in  extent  [m] largest absolute coordinate of the mesh
  MeshProxy(const MeshProxyOptions& options, double extent) noexcept;

  /// Place the probe without history. Inside the mesh or too close to it, the closest point of the surface holds it.
  ProxyTouch move_to(const Vec3& probe, const InsideTest& inside, std::span<const Vec3> vertices, const AabbTree& tree) noexcept;
  /// Move the probe. The first call places it, on whichever side of the surface that is. A position that is not finite is
  /// ignored.
  /// in   vertices  where they are now; the tree is fitted to them. All in the frame of the mesh
  /// time O(log n) per triangle crossed, on a mesh of 100 000 about 0.1 us in free space and 1.5 us in contact (4 us for a sphere
  ///      larger
  ///      than the triangles, 20 us for 1 % of the calls); at most 16 sweeps, the rest waits for the next call; no allocation
  ProxyTouch move(const Vec3& probe, std::span<const Vec3> vertices, const AabbTree& tree) noexcept;

  /// Announce a motion of the surface. A free proxy that it may pass over will move with the triangle that comes farthest past
  /// it.
  /// in   reach     [m] longest displacement of a vertex
  ///      vertices  positions before the motion; the tree is fitted to them
  ///      next      positions after it
  /// time O(log n + triangles within reach), O(1) if far; no allocation
  void expect(double reach, std::span<const Vec3> vertices, std::span<const Vec3> next, const AabbTree& tree) noexcept;
  /// Move with the surface, but not towards the probe: the first part of move().   time O(1) if nothing moved
  void carry(std::span<const Vec3> vertices, const AabbTree& tree) noexcept;

  const Vec3& position() const noexcept { return centre_; }
  double skin() const noexcept { return skin_; }

 private:
  struct Plane {
    SurfacePoint at;
    Vec3 normal;
  };
  /// Where on the surface the proxy is, and how the triangle lay then.
  struct Anchor {
    std::uint32_t triangle = MeshTopology::kNone;
    std::array<double, 3> weights{};
    Corners corners;
  };

  double distance() const noexcept { return options_.radius + skin_; }
  Sweep towards(const Vec3& goal) const noexcept;
  bool lets_move(const SurfaceHit& hit, const Vec3& displacement) const noexcept;
  std::optional<SurfaceHit> first_contact(const Vec3& goal, const AabbTree& tree, TriangleCache& around) const noexcept;
  std::optional<Vec3> wanted(const Vec3& probe) noexcept;
  void hold(const Plane& plane) noexcept;
  bool is_far(const Vec3& probe, const AabbTree& tree) const noexcept;
  void release() noexcept;
  void keep_distance(std::span<const Vec3> vertices, const AabbTree& tree) noexcept;
  void follow(const Vec3& probe, std::span<const Vec3> vertices, const AabbTree& tree) noexcept;
  ProxyTouch settle(const Vec3& probe, std::span<const Vec3> vertices, const AabbTree& tree) noexcept;

  MeshProxyOptions options_;
  double skin_, slack_, settled_;
  Vec3 centre_, probe_;
  bool placed_ = false;
  std::array<Plane, kMaxHalfspaces> planes_;
  std::array<std::uint32_t, kMaxHalfspaces> held_by_{};  // triangles of planes_
  std::size_t held_ = 0;
  std::array<double, kMaxHalfspaces> depth_{};  // below each plane
  std::array<std::uint32_t, 4> recent_{MeshTopology::kNone, MeshTopology::kNone, MeshTopology::kNone, MeshTopology::kNone};
  Anchor anchor_;
};

}  // namespace tactus::sim
