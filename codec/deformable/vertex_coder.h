// SPDX-License-Identifier: Apache-2.0
/// The walk over the vertices that encoder and decoder share: where each is expected, in which context, what follows from its
/// residual. spec/60-mesh.md section 7.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include <tactus/deformable/graph.h>
#include <tactus/deformable/main_syntax.h>
#include <tactus/deformable/state.h>

namespace tactus {

class VertexCoder {
 public:
  /// pre  `hierarchy` outlives the pass
  VertexCoder(const VertexHierarchy& hierarchy, std::size_t vertices)
      : hierarchy_(hierarchy), innovation_(vertices), coded_(vertices), inside_(vertices) {
    area_.reserve(vertices);
  }

  /// Bounds of the packet at hand: `haptic` for the vertices of the area of interest, where it is the tighter one.
  void set_bounds(std::uint32_t visual, std::uint32_t haptic, std::span<const std::uint32_t> area, Layer half) noexcept {
    for (const std::uint32_t v : area_) inside_[v] = 0;
    area_.assign(area.begin(), area.end());
    for (const std::uint32_t v : area_) inside_[v] = 1;
    bound_[0] = visual;
    bound_[1] = std::min(visual, haptic);
    tightness_ = tightness_of(haptic, visual);
    for (std::size_t i = 0; i < 2; ++i) step_[i] = step_of(bound_[i]);
    codes_[0] = half != Layer::haptic;
    codes_[1] = half != Layer::visual;
  }
  std::uint32_t bound_of(std::uint32_t vertex) const noexcept { return bound_[inside_[vertex]]; }
  /// The packet says where the vertex is; the others follow the prediction in time.
  bool codes(std::uint32_t vertex) const noexcept { return codes_[inside_[vertex]]; }

  /// Before run() of a half: what it does not code is where prediction in time puts it. Where a haptic half was before it in this tick
  /// that is known from there, and `expected` becomes again what that half expected.
  void begin_half(const DeformableState& base, bool completes, std::span<Vec3i> expected, std::span<Vec3i> decoded) noexcept {
    std::copy(expected.begin(), expected.end(), decoded.begin());
    std::fill(coded_.begin(), coded_.end(), std::uint8_t{0});
    if (!completes) return;
    for (const std::uint32_t v : area_) {
      for (std::size_t axis = 0; axis < 3; ++axis) expected[v][axis] -= base.felt[v][axis];
      coded_[v] = base.felt[v] != Vec3i{} ? 1 : 0;
    }
  }
  /// What the visual half of the same tick must know of a haptic half.
  void keep_felt(Layer half, DeformableState& next) const noexcept {
    std::fill(next.felt.begin(), next.felt.end(), Vec3i{});
    if (half != Layer::haptic) return;
    for (const std::uint32_t v : area_) next.felt[v] = innovation_[v];
  }

  /// in   expected  displacement by prediction in time
  /// out  decoded   displacement; may not alias `expected`; in halves only of vertices that the packet codes
  ///      residual(vertex, context, place, bound, step) returns the vertex's residual in steps
  template <class Residual>
  void run(std::span<const Vec3i> expected, std::span<Vec3i> decoded, Residual&& residual) noexcept {
    for (std::size_t i = 0; i < hierarchy_.order.size(); ++i) {
      const std::uint32_t v = hierarchy_.order[i];
      if (!codes(v)) {
        for (std::size_t axis = 0; axis < 3; ++axis) innovation_[v][axis] = decoded[v][axis] - expected[v][axis];
        continue;
      }
      std::array<std::int64_t, 3> sum{};
      unsigned parents = 0;
      for (const VertexParent& p : hierarchy_.parents[i]) {
        for (std::size_t axis = 0; axis < 3; ++axis)
          sum[axis] += static_cast<std::int64_t>(p.weight) * innovation_[p.vertex][axis];
        parents += coded_[p.vertex];
      }
      Vec3i place{};
      for (std::size_t axis = 0; axis < 3; ++axis)
        place[axis] = limited_displacement(expected[v][axis] + round_shift(sum[axis], 15));
      const std::size_t inside = inside_[v];
      const VertexContext context{static_cast<std::uint8_t>(inside ? tightness_ : 0),
                                  static_cast<std::uint8_t>(std::min(parents, 2u)),
                                  std::min<std::uint8_t>(hierarchy_.level[v], 2)};
      const Vec3i r = residual(v, context, place, bound_[inside], step_[inside]);
      coded_[v] = r != Vec3i{} ? 1 : 0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        decoded[v][axis] = limited_displacement(place[axis] + r[axis] * step_[inside]);
        innovation_[v][axis] = decoded[v][axis] - expected[v][axis];
      }
    }
  }

 private:
  const VertexHierarchy& hierarchy_;
  std::vector<Vec3i> innovation_;     // decoded - expected
  std::vector<std::uint8_t> coded_;   // had a residual
  std::vector<std::uint8_t> inside_;  // in the area of interest
  std::vector<std::uint32_t> area_;
  std::uint32_t bound_[2]{};  // outside, inside
  std::int64_t step_[2]{1, 1};
  bool codes_[2]{true, true};  // outside, inside
  std::uint8_t tightness_ = 0;
};

}  // namespace tactus
