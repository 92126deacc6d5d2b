// SPDX-License-Identifier: Apache-2.0
/// How well shaped tetrahedra are: flat ones make a simulation inaccurate and its highest frequency large.
#pragma once

#include <tactus/sim/tets/tet_mesh.h>

namespace tactus::sim {

struct TetQuality {
  /// A figure and the tetrahedron it belongs to, the first of equals.
  struct Worst {
    double value = 0;
    std::uint32_t tet = 0;
  };
  Worst smallest_angle;  ///< [rad] between two faces; regular: 1.231 (70.5 degrees)
  Worst largest_angle;   ///< [rad]
  /// 12 (3 V)^(2/3) / (sum of the six squared edges): 1 regular, 0 flat. [Liu and Joe 1994, mean ratio]
  Worst shape;
  double mean_shape = 0;
};

/// pre  the mesh passed check() and is not empty.   time O(n)
TetQuality quality(const TetMesh& mesh);

}  // namespace tactus::sim
