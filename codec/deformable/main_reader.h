// SPDX-License-Identifier: Apache-2.0
/// Reads a packet of profile main from any symbol source: the decoder's range decoder, or one that counts (tests/tools). Internal to
/// the library. spec/50-deformable.md sections 5 to 7.
#pragma once

#include <cstdint>
#include <vector>

#include <tactus/base/rule.h>
#include <tactus/deformable/main_syntax.h>
#include <tactus/deformable/vertex_coder.h>

namespace tactus {

class MainReader {
 public:
  /// pre  `object` outlives the reader
  explicit MainReader(const DeformableObject& object)
      : object_(object),
        hierarchy_(vertex_hierarchy(object)),
        rings_(object),
        predictor_(object),
        coder_(hierarchy_, object.rest.size()),
        expected_(object.rest.size()),
        coefficients_(object.basis.steps.size()) {}

  /// Everything after key, baseline and tick.
  /// out  next     the state after the packet; after an error undefined
  ///      returns  vertices with a residual
  template <class Coder>
  Result<std::uint32_t> read(Coder& coder, MainModels& models, MainHead& head, const MainState& base, MainState& next) noexcept {
    code_main_head(coder, models, object_, rings_, base, head);
    if (coder.too_wide()) return fail(Errc::malformed, "R-RNG-4");
    if (head.touched && head.triangle >= object_.triangles.size()) return fail(Errc::invalid, "R-DEF-9");
    if (head.haptic > kMaxHapticIndex || head.visual > kMaxVisualBound) return fail(Errc::invalid, "R-DEF-10");
    if (head.weight_set >= hierarchy_.parents.size()) return fail(Errc::invalid, "R-DEF-14");
    const std::int64_t tick = base.tick + head.tick_delta;
    predictor_.predict(base, tick, expected_);
    coder_.set_packet(head, rings_, object_.rings);
    coder_.fade(object_, base, tick, expected_, next);
    if (object_.layered) coder_.begin_layer(base, head.same_frame, expected_, next.displacement);
    if (head.layer == Layer::haptic) {
      keep_motion(base, next);
    } else {
      code_coefficients(coder, models, coefficients_);
      if (coder.too_wide()) return fail(Errc::malformed, "R-RNG-4");
      scale_coefficients(object_, mode_reach(head), coefficients_);
      predictor_.add_modes(coefficients_, expected_);
      predictor_.update(base, tick, next);
    }
    const std::uint32_t updates = read_vertices(coder, models, head, next);
    if (coder.too_wide()) return fail(Errc::malformed, "R-RNG-4");
    coder_.keep_off_basis(base, head.same_frame, next);
    coder_.keep_haptic_correction(head.layer, next);
    keep_head(head, base, next);
    return updates;
  }

  /// Displacement that a state predicts for a tick.   Valid until the next call.
  std::span<const Vec3i> predict(const MainState& state, std::int64_t tick) noexcept {
    predictor_.predict(state, tick, expected_);
    return expected_;
  }

 private:
  /// After a residual that is too wide, the loop continues with zeros.
  template <class Coder>
  std::uint32_t read_vertices(Coder& coder, MainModels& models, const MainHead& head, MainState& next) noexcept {
    std::uint32_t updates = 0;
    coder_.run(expected_, next.displacement,
               [&](std::uint32_t, const VertexContext& context, const Vec3i&, std::uint32_t, std::int64_t) noexcept {
                 Vec3i residual{};
                 if (!coder.too_wide()) code_vertex(coder, models, head.density, context, residual);
                 updates += is_zero(residual) ? 0u : 1u;
                 return residual;
               });
    return updates;
  }

  const DeformableObject& object_;
  VertexHierarchy hierarchy_;
  Rings rings_;
  ShapePredictor predictor_;
  VertexCoder coder_;
  std::vector<Vec3i> expected_;
  std::vector<std::int32_t> coefficients_;
};

}  // namespace tactus
