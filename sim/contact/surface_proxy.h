// SPDX-License-Identifier: Apache-2.0
/// Virtual proxy of one probe on a rigid object's triangle mesh (mesh_proxy.h), with what all probes on it share.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>

#include <tactus/sim/contact/mesh_proxy.h>

namespace tactus::sim {

/// A mesh that keeps its shape, ready to be touched.   pre  the mesh passed check()
class TouchSurface {
 public:
  explicit TouchSurface(TriMesh mesh) : mesh_(std::move(mesh)), topology_(mesh_), inside_(mesh_, topology_), tree_(mesh_) {
    for (const Vec3& v : mesh_.vertices) extent_ = std::max({extent_, std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  }
  TouchSurface(const TouchSurface&) = delete;
  TouchSurface& operator=(const TouchSurface&) = delete;

  const InsideTest& inside() const noexcept { return inside_; }
  std::span<const Vec3> vertices() const noexcept { return mesh_.vertices; }
  const AabbTree& tree() const noexcept { return tree_; }
  double extent() const noexcept { return extent_; }  ///< [m] largest absolute coordinate

 private:
  TriMesh mesh_;
  MeshTopology topology_;
  InsideTest inside_;
  AabbTree tree_;
  double extent_ = 0;
};

/// Everything in the object's frame, as with BoxProxy.   time O(log triangles), about 1.5 us in contact; no allocation
class SurfaceProxy {
 public:
  SurfaceProxy(std::shared_ptr<const TouchSurface> surface, double friction)
      : surface_(std::move(surface)), proxy_({.friction = friction}, surface_->extent()) {}

  /// Put the probe there without history; inside the mesh the closest point holds it.
  void move_to(const Vec3& probe) noexcept {
    touch_ = proxy_.move_to(probe, surface_->inside(), surface_->vertices(), surface_->tree());
  }
  /// Move the probe there.
  void move(const Vec3& probe) noexcept { touch_ = proxy_.move(probe, surface_->vertices(), surface_->tree()); }

  bool touches() const noexcept { return touch_.touched; }
  const Vec3& position() const noexcept { return touch_.proxy; }
  const Vec3& normal() const noexcept { return touch_.normal; }

 private:
  std::shared_ptr<const TouchSurface> surface_;
  MeshProxy proxy_;
  ProxyTouch touch_;
};

}  // namespace tactus::sim
