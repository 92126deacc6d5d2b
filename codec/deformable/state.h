// SPDX-License-Identifier: Apache-2.0
/// What packets of a mesh build on, and how it continues without packets. spec/60-mesh.md sections 3, 5 and 6. Integers only.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include <tactus/base/fixed.h>
#include <tactus/base/range_coder.h>
#include <tactus/deformable/graph.h>
#include <tactus/deformable/motion.h>
#include <tactus/scene/deformable_object.h>

namespace tactus {

inline constexpr std::uint32_t kNoTriangle = 0xffffffff;

struct DeformableState {
  std::int64_t tick = 0;
  std::vector<Vec3i> displacement;       ///< by vertex, x 2^-position_exp m
  ModeMotion motion;                     ///< main
  std::int64_t motion_tick = 0;          ///< main: `motion` has learnt up to here; haptic halves leave it behind `tick`
  std::vector<Vec3i> felt;               ///< main, split: by vertex, how far the haptic half moved it that was the last packet
  std::uint32_t triangle = kNoTriangle;  ///< main: the last one touched
  std::uint32_t visual = 0;              ///< main: visual bound, grid units
  std::uint32_t haptic = 0;              ///< main: level of the last haptic bound
  std::uint32_t density = 0;             ///< main: of the last packet, with touched: contexts of the next
  bool touched = false;                  ///< main: the last packet had a triangle
  std::vector<BitModel> models;          ///< thesis with models_kept: index models, then displacement models
};

DeformableState initial_state(const DeformableObject& mesh);
std::uint64_t state_hash(const DeformableObject& mesh, const DeformableState& state) noexcept;

/// Frames between two ticks, rounded.
std::uint32_t frame_steps(const DeformableObject& mesh, std::int64_t ticks) noexcept;

/// floor(2^((level - 1) / 6)) for level >= 1, 0 for level 0.   pre  level <= kMaxHapticLevel
std::uint32_t haptic_bound(std::uint32_t level) noexcept;
inline constexpr std::uint32_t kMaxHapticLevel = 168;  ///< 2^27.8
inline constexpr std::uint32_t kMaxVisualBound = 1u << 28;

constexpr std::int32_t limited_displacement(std::int64_t v) noexcept {
  return static_cast<std::int32_t>(
      std::clamp<std::int64_t>(v, -DeformableObject::kMaxDisplacement, DeformableObject::kMaxDisplacement));
}

inline std::int64_t coefficient_step(const DeformableObject& mesh, std::uint32_t visual, std::size_t mode) noexcept {
  return std::clamp<std::int64_t>((std::int64_t{mesh.basis.steps[mode]} * visual) >> 12, 1, kMaxVisualBound);
}

/// Coefficients from quantiser steps to grid units: step k is steps[k] * visual * 2^-12, at least 1.
inline void scale_coefficients(const DeformableObject& mesh, std::uint32_t visual,
                               std::span<std::int32_t> coefficients) noexcept {
  for (std::size_t k = 0; k < coefficients.size(); ++k)
    coefficients[k] = limited_displacement(coefficients[k] * coefficient_step(mesh, visual, k));
}

/// Quantiser step for a bound: rounding each component moves a point by at most the bound.
constexpr std::int64_t step_of(std::uint32_t bound) noexcept {
  return std::max<std::int64_t>(1, (std::int64_t{bound} * 37837) >> 15);  // 2 / sqrt(3) * 2^15, rounded down
}

/// Adds motion and modes to displacements. Holds scratch space; allocates at creation only.
class ShapePredictor {
 public:
  /// pre  `mesh` outlives the predictor
  explicit ShapePredictor(const DeformableObject& mesh);

  /// out = the displacement that `state` leads to at a tick not before its own. Without a basis: the same.
  void predict(const DeformableState& state, std::int64_t tick, std::span<Vec3i> out) noexcept;
  /// out += sum of modes times coefficients [grid units at a mode's entry of 1].
  void add_modes(std::span<const std::int32_t> coefficients, std::span<Vec3i> out) noexcept;
  /// The motion of `next`, a packet at `tick` after `base`: what the last predict() and add_modes() came to is learnt.
  void learn(const DeformableState& base, std::int64_t tick, DeformableState& next) const noexcept;

 private:
  void combine(std::span<const std::int32_t> coefficients, std::span<Vec3i> out) noexcept;

  const DeformableObject& mesh_;
  std::vector<std::int32_t> increments_;  // by mode, of the packet at hand, since motion_tick
  std::vector<std::int32_t> ahead_;       // by mode, since the state's tick where that is another
  std::vector<std::int32_t> sum_;         // by component
};

}  // namespace tactus
