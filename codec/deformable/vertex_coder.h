// SPDX-License-Identifier: Apache-2.0
/// The loop over vertices, shared by encoder and decoder: prediction, context and correction of each. spec/50-deformable.md
/// section 7.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include <tactus/deformable/main_state.h>
#include <tactus/deformable/main_syntax.h>
#include <tactus/mesh/graph.h>

namespace tactus {

class VertexCoder {
 public:
  /// pre  `hierarchy` outlives the pass
  VertexCoder(const VertexHierarchy& hierarchy, std::size_t vertices)
      : hierarchy_(hierarchy), correction_(vertices), residual_(vertices), coded_(vertices), inside_(vertices) {
    area_.reserve(vertices);
  }

  /// Set the bounds of the packet, min(visual, haptic) within `reach` rings of the touched triangle and `visual` elsewhere, and its
  /// weights.
  void set_packet(const MainHead& head, Rings& rings, std::uint32_t reach) noexcept {
    for (const std::uint32_t v : area_) inside_[v] = 0;
    area_.clear();
    if (head.touched) {
      rings.triangles_around(head.triangle, reach);
      area_.assign(rings.vertices().begin(), rings.vertices().end());
    }
    for (const std::uint32_t v : area_) inside_[v] = 1;
    const std::uint32_t haptic = head.touched ? haptic_bound(head.haptic) : head.visual;
    bound_ratio_ = bound_ratio_of(haptic, head.visual);
    step_[0] = step_of(head.visual);
    step_[1] = step_of(std::min(head.visual, haptic));
    codes_[0] = head.layer != Layer::haptic;
    codes_[1] = head.layer != Layer::visual;
    use_weights(head.weight_set);
  }
  void use_weights(std::uint32_t set) noexcept { set_ = set; }
  std::span<const std::uint32_t> area() const noexcept { return area_; }  ///< of interest, from the touched triangle outwards
  bool is_inside(std::uint32_t vertex) const noexcept { return inside_[vertex] != 0; }
  /// Whether the packet codes this vertex; the others keep the temporal prediction.
  bool codes(std::uint32_t vertex) const noexcept { return codes_[inside_[vertex]]; }

  /// After predict(): of the vertices that the packet codes, take back what fades of earlier corrections. Packets of the haptic layer
  /// fade nothing.
  /// out  next.off_basis  what is left;  expected  less the difference
  void fade(const DeformableObject& object, const MainState& base, std::int64_t tick, std::span<Vec3i> expected,
            MainState& next) noexcept {
    if (object.fade == 0) return;
    if (!codes_[0]) {
      std::copy(base.off_basis.begin(), base.off_basis.end(), next.off_basis.begin());
      return;
    }
    if (!codes_[1])
      for (const std::uint32_t v : area_) correction_[v] = expected[v];
    const std::uint32_t frames = std::min(frame_steps(object, tick - base.motion_tick), ModeMotion::kMaxSteps);
    std::int64_t left = 1 << 16;
    for (std::uint32_t n = 0; n < frames; ++n) left = (left * ((1 << 16) - object.fade)) >> 16;
    const double fraction = static_cast<double>(left) / 65536;  // its products with 28 bits are exact
    for (std::size_t v = 0; v < expected.size(); ++v) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::int32_t before = base.off_basis[v][axis];
        const auto after = static_cast<std::int32_t>(before * fraction);
        next.off_basis[v][axis] = after;
        expected[v][axis] = std::clamp(expected[v][axis] - before + after, -kMost, kMost);
      }
    }
    if (codes_[1]) return;
    for (const std::uint32_t v : area_) {
      expected[v] = correction_[v];
      next.off_basis[v] = base.off_basis[v];
    }
  }

  /// Before run() of a layered object: vertices that the packet does not code keep the temporal prediction. If the baseline is the
  /// haptic packet of this tick, its corrections are subtracted from `expected`, so that both packets share one prediction.
  void begin_layer(const MainState& base, bool same_frame, std::span<Vec3i> expected, std::span<Vec3i> decoded) noexcept {
    std::copy(expected.begin(), expected.end(), decoded.begin());
    std::fill(coded_.begin(), coded_.end(), std::uint8_t{0});
    if (!same_frame) return;
    for (const std::uint32_t v : area_) {
      for (std::size_t axis = 0; axis < 3; ++axis) expected[v][axis] -= base.haptic_correction[v][axis];
      coded_[v] = is_zero(base.haptic_correction[v]) ? 0 : 1;
      residual_[v] = {};
    }
  }
  /// Store the haptic correction for the visual packet of the same tick.
  void keep_haptic_correction(Layer layer, MainState& next) const noexcept {
    std::fill(next.haptic_correction.begin(), next.haptic_correction.end(), Vec3i{});
    if (layer != Layer::haptic) return;
    for (const std::uint32_t v : area_) next.haptic_correction[v] = correction_[v];
  }

  /// Add the corrections of the packet to what has faded. A visual packet of a haptic packet's tick replaces those of that packet.
  void keep_off_basis(const MainState& base, bool same_frame, MainState& next) const noexcept {
    for (std::size_t v = 0; v < next.off_basis.size(); ++v)
      for (std::size_t axis = 0; axis < 3; ++axis)
        next.off_basis[v][axis] = std::clamp(next.off_basis[v][axis] + correction_[v][axis], -kMost, kMost);
    if (!same_frame || next.off_basis.empty()) return;
    for (const std::uint32_t v : area_)
      for (std::size_t axis = 0; axis < 3; ++axis)
        next.off_basis[v][axis] = std::clamp(next.off_basis[v][axis] - base.haptic_correction[v][axis], -kMost, kMost);
  }

  /// in   expected  displacement by temporal prediction
  /// out  decoded   displacement; may not alias `expected`; of layered objects only of vertices that the packet codes
  ///      residual(vertex, context, axes, predicted, step) returns the vertex's residual in steps; axes() is for those that are not 0
  template <class Residual>
  void run(std::span<const Vec3i> expected, std::span<Vec3i> decoded, Residual&& residual) noexcept {
    const ListOfLists<VertexParent>& parents_of = hierarchy_.parents[set_];
    for (std::size_t i = 0; i < hierarchy_.order.size(); ++i) {
      const std::uint32_t v = hierarchy_.order[i];
      if (!codes(v)) {
        for (std::size_t axis = 0; axis < 3; ++axis) correction_[v][axis] = decoded[v][axis] - expected[v][axis];
        continue;
      }
      const std::span<const VertexParent> parents = parents_of[i];
      std::array<std::int64_t, 3> sum{};
      unsigned coded = 0;
      for (const VertexParent& p : parents) {
        for (std::size_t axis = 0; axis < 3; ++axis)
          sum[axis] += static_cast<std::int64_t>(p.weight) * correction_[p.vertex][axis];
        coded += coded_[p.vertex];
      }
      Vec3i predicted{};
      for (std::size_t axis = 0; axis < 3; ++axis)
        predicted[axis] = limited_displacement(expected[v][axis] + round_shift(sum[axis], 15));
      const std::size_t inside = inside_[v];
      const VertexContext context{static_cast<std::uint8_t>(inside ? bound_ratio_ : 0),
                                  static_cast<std::uint8_t>(std::min(coded, 2u)), std::min<std::uint8_t>(hierarchy_.depth[v], 2)};
      const std::int64_t step = step_[inside];
      const auto axes = [&]() noexcept { return axis_contexts(parents, sum, step); };
      const Vec3i r = residual(v, context, axes, predicted, step);
      coded_[v] = is_zero(r) ? 0 : 1;
      residual_[v] = r;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        decoded[v][axis] = limited_displacement(predicted[axis] + r[axis] * step);
        correction_[v][axis] = decoded[v][axis] - expected[v][axis];
      }
    }
  }

 private:
  AxisContexts axis_contexts(std::span<const VertexParent> parents, const std::array<std::int64_t, 3>& corrections,
                             std::int64_t step) const noexcept {
    std::array<std::int64_t, 3> residuals{};
    for (const VertexParent& p : parents) {
      if (coded_[p.vertex] == 0) continue;
      for (std::size_t axis = 0; axis < 3; ++axis)
        residuals[axis] += static_cast<std::int64_t>(p.weight) * residual_[p.vertex][axis];
    }
    AxisContexts out;
    for (std::size_t axis = 0; axis < 3; ++axis) out[axis] = axis_context(residuals[axis], corrections[axis], step);
    return out;
  }

  static constexpr std::int32_t kMost = DeformableObject::kMaxDisplacement;

  const VertexHierarchy& hierarchy_;
  std::vector<Vec3i> correction_;     // decoded - expected
  std::vector<Vec3i> residual_;       // [steps]
  std::vector<std::uint8_t> coded_;   // had a residual
  std::vector<std::uint8_t> inside_;  // in the area of interest
  std::vector<std::uint32_t> area_;
  std::int64_t step_[2]{1, 1};  // outside, inside
  bool codes_[2]{true, true};   // outside, inside
  std::uint8_t bound_ratio_ = 0;
  std::uint32_t set_ = 0;  // of weights
};

}  // namespace tactus
