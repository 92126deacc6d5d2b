// SPDX-License-Identifier: Apache-2.0
/// Syntax of a packet of profile main: shared by encoder and decoder, internal to the library. spec/50-deformable.md section 5.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>

#include <tactus/base/fixed.h>
#include <tactus/base/range_coder.h>
#include <tactus/deformable/main_state.h>
#include <tactus/mesh/graph.h>
#include <tactus/packet/substream.h>
#include <tactus/scene/scene_objects.h>

namespace tactus {

inline constexpr std::size_t kDensities = 4;

/// Every adaptive model of a packet. Restarted from main_start_models() for each packet.
struct MainModels {
  BitModel key;
  BitModel layer, same_frame;
  MagnitudeModel baseline, tick, late;
  std::array<BitModel, 2> touched;  // context: the baseline's packet was touched
  BitModel same_triangle, near_triangle;
  TreeModel<6> near_index;
  MagnitudeModel haptic;
  BitModel same_visual;
  MagnitudeModel visual;
  std::array<TreeModel<2>, kDensities> density;                        // context: the baseline's density
  std::array<TreeModel<2>, DeformableObject::kWeightSets> weight_set;  // context: the baseline's set
  std::array<BitModel, 2> driven, fades;                               // context: the baseline's packet did
  std::array<std::array<MagnitudeModel, 3>, 4> coefficient;            // by mode, size before
  std::array<std::array<std::array<std::array<BitModel, 3>, 3>, 4>, kDensities>
      significant;  // density, bound ratio, parents, depth
  std::array<std::array<std::array<std::array<MagnitudeModel, 4>, 4>, 3>, 2>
      component;                                // tight, depth, size before (3: z after two zeros), parents' size
  std::array<std::array<BitModel, 5>, 3> sign;  // parents' residual, predicted correction + 2
};

/// Start probabilities, spec/tables/deformable-start-models.csv.
const MainModels& main_start_models() noexcept;

struct MainHead : PacketHead {
  Layer layer = Layer::all;
  bool same_frame = false;  ///< visual packet of the same tick as the baseline's haptic packet
  bool touched = false;
  std::uint32_t triangle = kNoTriangle;
  std::uint32_t haptic = 0;  ///< index, see haptic_bound()
  std::uint32_t visual = 0;  ///< grid units
  std::uint32_t density = 0;
  std::uint32_t weight_set = 0;  ///< among those declared
  Following following = Following::none;
};

/// What the parents say of one component of a residual.
struct AxisContext {
  std::uint8_t size = 0;   ///< level() of their residuals
  std::int8_t like = 0;    ///< sign that is expected, 0: none
  std::uint8_t model = 0;  ///< of MainModels::sign, row-major
};

using AxisContexts = std::array<AxisContext, 3>;

/// 0 to 3: below 1/8, 1/2, 2, or more of `unit`.
constexpr std::uint8_t level_of(std::int64_t value, std::int64_t unit) noexcept {
  const std::int64_t size = value < 0 ? -value : value;
  return 8 * size < unit ? 0 : 2 * size < unit ? 1 : size < 2 * unit ? 2 : 3;
}

/// in   residual    sum of the parents' residuals, weighted, x 2^15
///      correction  predicted, x 2^15 grid units;  step  of the quantiser, grid units
constexpr AxisContext axis_context(std::int64_t residual, std::int64_t correction, std::int64_t step) noexcept {
  const auto sign_of = [](std::int64_t value) noexcept { return value < 0 ? -1 : 1; };
  const std::uint8_t size = level_of(residual, 1 << 15);
  const int by_residual = std::min<int>(size, 2),
            by_correction = std::min<int>(level_of(correction, step << 15), 2) * sign_of(correction);
  if (by_residual == 0 && by_correction == 0) return {size, 0, 0};
  const int like = by_residual != 0 ? sign_of(residual) : sign_of(correction);
  return {size, static_cast<std::int8_t>(like), static_cast<std::uint8_t>(5 * by_residual + by_correction * like + 2)};
}

/// Which models a vertex's symbols use.
struct VertexContext {
  std::uint8_t bound_ratio = 0;  ///< 0: visual bound only; 1, 2, 3: haptic bound above 2/3, above 1/4, below
  std::uint8_t parents = 0;      ///< parents that carried a residual: 0, 1, more
  std::uint8_t depth = 0;        ///< in the hierarchy: 0 finest, 1, coarser
};

/// Bound that the quantiser steps of the modes follow: a tight haptic bound makes them finer, down to a quarter.
inline std::uint32_t mode_reach(const MainHead& head) noexcept {
  if (!head.touched) return head.visual;
  return static_cast<std::uint32_t>(
      std::clamp(8 * std::uint64_t{haptic_bound(head.haptic)}, std::uint64_t{head.visual} >> 2, std::uint64_t{head.visual}));
}

constexpr std::uint8_t bound_ratio_of(std::uint32_t haptic, std::uint32_t visual) noexcept {
  const std::uint64_t h = haptic;
  if (h >= visual) return 0;
  return 3 * h > 2 * std::uint64_t{visual} ? 1 : 4 * h > visual ? 2 : 3;
}

/// The layer of a layered object. A mesh without triangles has only the visual layer.
template <class Coder>
Layer code_layer(Coder& coder, MainModels& models, const DeformableObject& object, Layer layer) noexcept {
  if (!object.layered) return Layer::all;
  if (object.triangles.empty()) return Layer::visual;
  return coder.bit(models.layer, layer == Layer::visual ? 1u : 0u) ? Layer::visual : Layer::haptic;
}

/// Key, baseline, layer and tick: what must be known to find the baseline.
template <class Coder>
void code_main_start(Coder& coder, MainModels& models, const DeformableObject& object, std::uint8_t span,
                     MainHead& head) noexcept {
  code_baseline(coder, models, span, head);
  head.layer = code_layer(coder, models, object, head.layer);
  head.same_frame = head.layer == Layer::visual && !head.key && coder.bit(models.same_frame, head.same_frame ? 1u : 0u);
  if (head.same_frame) {
    head.tick_delta = 0;
    return;
  }
  if (head.key) {
    head.tick_delta = coder.magnitude(models.tick, head.tick_delta);
    return;
  }
  const std::int64_t period = round_shift(object.frame_period, 8);
  const std::int64_t late = coder.signed_value(models.late, static_cast<std::int32_t>(head.tick_delta - period));
  head.tick_delta = static_cast<std::uint32_t>(std::max<std::int64_t>(0, period + late));
}

/// The touched triangle: the same, an index into the rings around the last one, or its number. The number may be out of range.
template <class Coder>
std::uint32_t code_triangle(Coder& coder, MainModels& models, const DeformableObject& object, Rings& rings, std::uint32_t last,
                            std::uint32_t triangle) noexcept {
  constexpr std::uint32_t kNear = 63;
  if (last != kNoTriangle) {
    if (coder.bit(models.same_triangle, triangle == last ? 1u : 0u)) return last;
    auto near = rings.triangles_around(last, 2).subspan(1);
    near = near.first(std::min<std::size_t>(near.size(), kNear));
    std::uint32_t index = 0;
    while (index < near.size() && near[index] != triangle) ++index;
    if (coder.bit(models.near_triangle, index < near.size() ? 1u : 0u)) {
      index = coder.template tree<6>(models.near_index, index);
      return index < near.size() ? near[index] : kNoTriangle;
    }
  }
  const auto bits = static_cast<unsigned>(std::bit_width(object.triangles.size() - 1));
  std::uint32_t out = 0;
  for (unsigned left = bits; left > 0;) {
    const unsigned count = std::min(left, 16u);
    left -= count;
    out = out << count | coder.raw(count, (triangle >> left) & ((1u << count) - 1));
  }
  return out;
}

/// The touched triangle and the bounds.
template <class Coder>
void code_main_bounds(Coder& coder, MainModels& models, const DeformableObject& object, Rings& rings, const MainState& base,
                      MainHead& head) noexcept {
  head.touched = head.layer == Layer::haptic ||
                 (!object.triangles.empty() && coder.bit(models.touched[base.touched ? 1 : 0], head.touched ? 1u : 0u));
  if (head.touched) {
    head.triangle = code_triangle(coder, models, object, rings, base.triangle, head.triangle);
    const std::int64_t change = coder.signed_value(models.haptic, saturate32(std::int64_t{head.haptic} - base.haptic));
    head.haptic = static_cast<std::uint32_t>(std::clamp<std::int64_t>(base.haptic + change, 0, kMaxHapticIndex + 1));
  }
  const bool same = coder.bit(models.same_visual, head.visual == base.visual ? 1u : 0u);
  head.visual = same ? base.visual : coder.magnitude(models.visual, head.visual);
}

template <class Coder>
void code_following(Coder& coder, MainModels& models, Following base, Following& following) noexcept {
  const bool follows = coder.bit(models.driven[base != Following::none ? 1 : 0], following != Following::none ? 1u : 0u) != 0;
  if (!follows) {
    following = Following::none;
    return;
  }
  const bool fades = coder.bit(models.fades[base == Following::fading ? 1 : 0], following == Following::fading ? 1u : 0u) != 0;
  following = fades ? Following::fading : Following::kept;
}

/// The rest of the head, given the baseline.
template <class Coder>
void code_main_head(Coder& coder, MainModels& models, const DeformableObject& object, Rings& rings, const MainState& base,
                    MainHead& head) noexcept {
  if (head.same_frame) {
    head.touched = base.touched;
    head.triangle = base.triangle;
    head.haptic = base.haptic;
    head.visual = base.visual;
  } else {
    code_main_bounds(coder, models, object, rings, base, head);
  }
  head.density = head.layer == Layer::haptic ? base.density : coder.template tree<2>(models.density[base.density], head.density);
  const bool several = std::popcount(object.weight_sets) > 1;
  head.weight_set = several ? coder.template tree<2>(models.weight_set[base.weight_set], head.weight_set) : 0;
  if (object.body) code_following(coder, models, base.following, head.following);
}

/// Store the fields that predict the next packet's head.
inline void keep_head(const MainHead& head, const MainState& base, MainState& next) noexcept {
  next.triangle = head.touched ? head.triangle : base.triangle;
  next.haptic = head.touched ? head.haptic : base.haptic;
  next.visual = head.visual;
  next.density = head.density;
  next.weight_set = head.weight_set;
  next.touched = head.touched;
  next.following = head.following;
}

/// Keep the baseline's motion: only visual packets advance it.
inline void keep_motion(const MainState& base, MainState& next) noexcept {
  next.motion = base.motion;
  next.motion_tick = base.motion_tick;
}

constexpr std::size_t size_class(std::uint32_t magnitude) noexcept { return magnitude == 0 ? 0 : magnitude == 1 ? 1 : 2; }

/// One coefficient per mode, in units of its step.
template <class Coder>
void code_coefficients(Coder& coder, MainModels& models, std::span<std::int32_t> coefficients) noexcept {
  std::size_t before = 0;
  for (std::size_t k = 0; k < coefficients.size(); ++k) {
    const std::size_t group = k < 4 ? 0 : k < 12 ? 1 : k < 24 ? 2 : 3;
    coefficients[k] = coder.signed_value(models.coefficient[group][before], coefficients[k]);
    before = size_class(magnitude_of(coefficients[k]));
  }
}

/// Whether a vertex has a residual that is not 0.
template <class Coder>
bool code_significance(Coder& coder, MainModels& models, std::uint32_t density, const VertexContext& context, bool any) noexcept {
  return coder.bit(models.significant[density][context.bound_ratio][context.parents][context.depth], any ? 1u : 0u) != 0;
}

/// A residual that is not 0, in quantiser steps.
template <class Coder>
void code_residual(Coder& coder, MainModels& models, const VertexContext& context, const AxisContexts& axes,
                   Vec3i& residual) noexcept {
  auto& component = models.component[context.bound_ratio == 0 ? 0 : 1][context.depth];
  auto& [x, y, z] = residual;
  const auto& [of_x, of_y, of_z] = axes;
  const auto sign = [&models](const AxisContext& axis) noexcept -> BitModel& {
    return models.sign[axis.model / 5][axis.model % 5];
  };
  x = coder.signed_value(component[0][of_x.size], sign(of_x), of_x.like, x);
  y = coder.signed_value(component[size_class(magnitude_of(x))][of_y.size], sign(of_y), of_y.like, y);
  const std::size_t before = size_class(std::max(magnitude_of(x), magnitude_of(y)));
  z = before == 0 ? coder.nonzero_value(component[3][of_z.size], sign(of_z), of_z.like, z)
                  : coder.signed_value(component[before][of_z.size], sign(of_z), of_z.like, z);
}

/// Upper bound of the size of any packet, without its substream's number [bytes].
constexpr std::size_t max_main_packet(std::size_t vertices, std::size_t modes) noexcept {
  constexpr std::size_t kHead = 112;        // fields, bounds, weight set, tail
  constexpr std::size_t kCoefficient = 16;  // a signed value at 15 bits per adaptive bit
  constexpr std::size_t kVertex = 44;       // a flag and three values with their signs
  return kHead + kCoefficient * modes + kVertex * vertices;
}

}  // namespace tactus
