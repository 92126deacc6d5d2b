// SPDX-License-Identifier: Apache-2.0
/// The walk over the vertices that encoder and decoder share: where each is expected, in which context, what follows from its
/// residual. spec/60-mesh.md section 7.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/mesh/mesh_graph.h"
#include "codec/mesh/mesh_state.h"
#include "codec/mesh/mesh_syntax.h"

namespace tactus {

class MeshPass {
 public:
  /// pre  `hierarchy` outlives the pass
  MeshPass(const MeshHierarchy& hierarchy, std::size_t vertices)
      : hierarchy_(hierarchy), innovation_(vertices), coded_(vertices), tight_(vertices) {
    area_.reserve(vertices);
  }

  /// Bounds of the packet at hand: `haptic` for the vertices of the area of interest, where it is the tighter one.
  void set_bounds(std::uint32_t visual, std::uint32_t haptic, std::span<const std::uint32_t> area) noexcept {
    for (const std::uint32_t v : area_) tight_[v] = 0;
    bound_[0] = visual;
    bound_[1] = std::min(visual, haptic);
    area_.clear();
    if (haptic < visual) area_.assign(area.begin(), area.end());
    tightness_ = tightness_of(haptic, visual);
    for (const std::uint32_t v : area_) tight_[v] = 1;
    for (std::size_t i = 0; i < 2; ++i) step_[i] = step_of(bound_[i]);
  }
  std::uint32_t bound_of(std::uint32_t vertex) const noexcept { return bound_[tight_[vertex]]; }

  /// in   expected  displacement by prediction in time
  /// out  decoded   displacement; may not alias `expected`
  ///      residual(vertex, context, place, bound, step) returns the vertex's residual in steps
  template <class Residual>
  void run(std::span<const Vec3i> expected, std::span<Vec3i> decoded, Residual&& residual) noexcept {
    for (std::size_t i = 0; i < hierarchy_.order.size(); ++i) {
      const std::uint32_t v = hierarchy_.order[i];
      std::array<std::int64_t, 3> sum{};
      unsigned parents = 0;
      for (const MeshParent& p : hierarchy_.parents[i]) {
        for (std::size_t axis = 0; axis < 3; ++axis)
          sum[axis] += static_cast<std::int64_t>(p.weight) * innovation_[p.vertex][axis];
        parents += coded_[p.vertex];
      }
      Vec3i place{};
      for (std::size_t axis = 0; axis < 3; ++axis)
        place[axis] = limited_displacement(expected[v][axis] + round_shift(sum[axis], 15));
      const std::size_t tight = tight_[v];
      const VertexContext context{static_cast<std::uint8_t>(tight ? tightness_ : 0),
                                  static_cast<std::uint8_t>(std::min(parents, 2u)),
                                  std::min<std::uint8_t>(hierarchy_.level[v], 2)};
      const Vec3i r = residual(v, context, place, bound_[tight], step_[tight]);
      coded_[v] = r != Vec3i{} ? 1 : 0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        decoded[v][axis] = limited_displacement(place[axis] + r[axis] * step_[tight]);
        innovation_[v][axis] = decoded[v][axis] - expected[v][axis];
      }
    }
  }

 private:
  const MeshHierarchy& hierarchy_;
  std::vector<Vec3i> innovation_;    // decoded - expected
  std::vector<std::uint8_t> coded_;  // had a residual
  std::vector<std::uint8_t> tight_;
  std::vector<std::uint32_t> area_;
  std::uint32_t bound_[2]{};
  std::int64_t step_[2]{1, 1};
  std::uint8_t tightness_ = 0;
};

}  // namespace tactus
