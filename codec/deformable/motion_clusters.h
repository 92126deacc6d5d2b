// SPDX-License-Identifier: Apache-2.0
/// Encoder side: clusters of vertices that move alike, found on shapes of a recording. spec/guide.md section 5.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <tactus/base/tri_mesh.h>
#include <tactus/scene/scene_objects.h>

namespace tactus {

inline constexpr std::size_t kClusterShapes = 40;  ///< of a recording are enough, if they are spread over it

/// Lloyd's method: a cluster has, for each shape, the affine map of the rest positions that fits its vertices best; a vertex belongs
/// to the cluster that fits it best, of all in the first rounds, then of those of its neighbours. A cluster begins around the vertex
/// that those before it fit worst.
/// in   rest    V vertices [m];  shapes  displacements [m], x y z of vertex 0 first, 3 V numbers each
/// out  at most `count` clusters, fewer where the mesh is small
/// err  invalid_argument R-API-4 count is not 1..64; R-API-5 no shape, or one of another size; R-API-1 a number is not finite;
///      limit_exceeded R-API-11 memory
/// time about 0.1 us per vertex, shape and cluster: 2 s for 7000 vertices, 40 shapes and 40 clusters; allocates
Result<ClusterBasis> motion_clusters(const TriMesh& rest, std::span<const std::vector<float>> shapes, std::size_t count);

}  // namespace tactus
