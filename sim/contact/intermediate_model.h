// SPDX-License-Identifier: Apache-2.0
/// What is touched of a deformable object between two of its deformation steps: an exact cut-out of the mesh, m rings around the
/// touched triangle. Thesis 2.3.4.2, figure 2.7, and 3.3.2.
///
/// Every deformation step cuts out anew. Vertices then go in a straight line from where they are shown to where the step put them
/// and are there when the next one is due. Nothing jumps, because every vertex starts where it was: one that was cut out before
/// where it was shown, any other where the last step had put it. Triangles and vertices keep their numbers in the mesh, so the
/// proxy goes from cut-out to cut-out without noticing.
///
/// A proxy that is about to leave the outermost ring below the surface goes only a part of the way, or waits, until the next cut-out
/// has it in the middle.
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
  /// time O(triangles of all cut-outs); allocates all there is to allocate
  IntermediateModel(const TriMesh& mesh, const MeshTopology& topology, const IntermediateModelOptions& options);

  /// Put the probe there without history, on the mesh as it is now.   as update()
  ProxyTouch place(const Vec3& probe, std::span<const Vec3> vertices, const AabbTree& tree) noexcept;
  /// A deformation step is done: cut out around the proxy; what is shown does not change. A free proxy that is inside of the object
  /// by now, because it came to where nothing was cut out, is put on the surface.
  /// in   vertices  of the whole mesh; the tree is fitted to them
  /// time O(n); no allocation
  void update(std::span<const Vec3> vertices, const AabbTree& tree) noexcept;
  /// A deformation step is done and moved nothing: what update() does then.   time O(cut-out) where the proxy went on, else O(log n)
  void update_at_rest(std::span<const Vec3> vertices, const AabbTree& tree) noexcept;
  /// One tick of haptic rendering.   pre  place()   time O(cut-out), about 2 us for three rings; no allocation
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
  std::vector<std::uint8_t> is_rim_;     // by triangle: around one of its corners the mesh goes on beyond the cut-out
  std::vector<Vec3> from_, to_;          // by vertex: start and end of this period
  std::vector<Vec3> shown_, next_;       // next_: in this tick, of the cut-out
  double reach_ = 0;                     // [m] at most so far does a vertex of the cut-out move in a tick of this period
  std::uint32_t tick_ = 0;               // since the last deformation step
  std::uint32_t still_ = 0;              // deformation steps in a row in which nothing moved
  std::uint32_t cut_around_triangle_ = MeshTopology::kNone;  // in the middle of the cut-out
};

}  // namespace tactus::sim
