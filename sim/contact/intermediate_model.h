// SPDX-License-Identifier: Apache-2.0
/// The local surface that probes touch between two deformation steps of an object: an exact cut-out of the mesh, m rings around
/// the touched triangle. Thesis 2.3.4.2, figure 2.7, and 3.3.2.
///
/// Every deformation step makes a new cut-out. Its vertices then move linearly from where they are shown to the result of the
/// step, and arrive when the next step is due. Every vertex starts where it was, so that nothing jumps: a vertex of the previous
/// cut-out where it was shown, any other at the result of the previous step. Triangles and vertices keep their numbers in the
/// mesh, so that the proxy passes from cut-out to cut-out unchanged.
///
/// A proxy that is about to leave the outermost ring below the surface moves only a part of its displacement, or waits, until the next
/// cut-out is centred on it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <tactus/sim/contact/mesh_proxy.h>

namespace tactus::sim {

struct IntermediateModelOptions {
  unsigned rings = 3;       ///< m
  std::uint32_t ticks = 1;  ///< of haptic rendering per deformation step, N >= 1 (thesis figure 4.14)
  MeshProxyOptions proxy;
};

class IntermediateModel {
 public:
  /// in   mesh, topology  outlive this object; the mesh as it is at rest
  /// time O(triangles of all cut-outs); the only function that allocates
  IntermediateModel(const TriMesh& mesh, const MeshTopology& topology, const IntermediateModelOptions& options);

  /// Place the probe without history, on the mesh as it is now.   as update()
  ProxyTouch move_to(const Vec3& probe, std::span<const Vec3> vertices, const AabbTree& tree) noexcept;
  /// Take over a deformation step: cut out around the proxy. The shown surface does not change. A free proxy that is now inside
  /// the object, because it moved beyond the previous cut-out, is put on the surface.
  /// in   vertices  of the whole mesh; the tree is fitted to them
  /// time O(n); no allocation
  void update(std::span<const Vec3> vertices, const AabbTree& tree) noexcept;
  /// update() for a deformation step that moved nothing.   time O(cut-out) if the proxy has moved on, else O(log n)
  void update_at_rest(std::span<const Vec3> vertices, const AabbTree& tree) noexcept;
  /// One tick of haptic rendering.   pre  move_to()   time O(cut-out), about 2 us for three rings; no allocation
  ProxyTouch move(const Vec3& probe) noexcept;

  std::span<const std::uint32_t> triangles() const noexcept { return cut_; }  ///< of the cut-out, ring by ring
  /// Where vertices are shown; only those of the cut-out follow the deformation from tick to tick.
  std::span<const Vec3> vertices() const noexcept { return shown_; }

 private:
  bool falls_off(const ProxyTouch& touch, const Vec3& probe) const noexcept;
  void cut_around(std::uint32_t triangle) noexcept;
  void recut(std::span<const Vec3> vertices, const AabbTree& tree) noexcept;
  void approach() noexcept;

  const TriMesh& mesh_;
  const MeshTopology& topology_;
  IntermediateModelOptions options_;
  InsideTest inside_;
  MeshProxy proxy_;
  AabbTree tree_;
  ProxyTouch touch_;                     // of the last tick
  std::vector<std::uint32_t> cut_;       // triangles
  std::vector<std::uint32_t> moving_;    // vertices of them
  std::vector<std::uint8_t> is_moving_;  // by vertex
  std::vector<std::uint8_t> is_rim_;     // by triangle: at one of its corners the mesh continues beyond the cut-out
  std::vector<Vec3> from_, to_;          // by vertex: start and end of this period
  std::vector<Vec3> shown_, next_;       // next_: in this tick, of the cut-out
  double reach_ = 0;                     // [m] bound on a cut-out vertex's motion per tick of this period
  std::uint32_t tick_ = 0;               // since the last deformation step
  std::uint32_t still_ = 0;              // deformation steps in a row in which nothing moved
  std::uint32_t cut_around_triangle_ = MeshTopology::kNone;  // in the middle of the cut-out
};

}  // namespace tactus::sim
