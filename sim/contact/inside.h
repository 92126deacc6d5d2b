// SPDX-License-Identifier: Apache-2.0
/// Tests which points lie inside a mesh: those below the closest point of a closed component. An open component has no inside.
///
/// "Below" refers to the normals around the closest point, each weighted by the angle of its triangle there. Only this weighting
/// gives the right sign at every edge and corner (Baerentzen and Aanaes 2005).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <tactus/sim/contact/aabb_tree.h>

namespace tactus::sim {

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
