// SPDX-License-Identifier: Apache-2.0
/// State of a deformable object, profile main, and how its motion goes on. Internal to the library.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <tactus/base/fixed.h>
#include <tactus/deformable/displacement.h>
#include <tactus/mesh/graph.h>
#include <tactus/scene/scene_objects.h>

namespace tactus {

// ==== motion ====
// Temporal prediction of a few channels, each from its own past: recursive least squares with two coefficients on their
// increments.
// spec/50-deformable.md section 6. Integers only; part of the state that packets build on.

class ModeMotion {
 public:
  static constexpr std::uint32_t kMaxSteps = 8;  ///< after so many frames without a packet the motion stops

  ModeMotion() = default;
  explicit ModeMotion(std::size_t channels) : channels_(channels) {}

  std::size_t size() const noexcept { return channels_.size(); }

  /// Sum of the next `steps` increments of every channel; beyond kMaxSteps there are none.   pre  out.size() == size()
  void predict(std::uint32_t steps, std::span<std::int32_t> out) const noexcept;
  /// Learn the increments of a packet that lies `steps` frames after its baseline.
  void update(std::uint32_t steps, std::span<const std::int32_t> increments) noexcept;

  /// Everything a later prediction depends on, for the state hash.
  template <class Hash>
  void add_to(Hash& hash) const noexcept {
    for (const Channel& c : channels_) {
      hash.add32(c.last);
      hash.add32(c.before);
      for (const std::int64_t s : c.correlations) hash.add64(static_cast<std::uint64_t>(s));
    }
  }

 private:
  struct Channel {
    std::int32_t last = 0, before = 0;           // increments per frame
    std::array<std::int64_t, 5> correlations{};  // fading correlations of products: 11, 12, 22, 01, 02; 0 now, 1 last, 2 before
  };
  std::vector<Channel> channels_;
};

// ==== main state ====
// Profile main: the baseline of packets and the prediction between packets. spec/50-deformable.md sections 3, 5 and 6. Integers
// only.

/// Whether what is shown follows the device, for who knows it (elastic/driven_shape.h), and what becomes of what it differs by from the
/// body that both ends compute.
enum class Following : std::uint8_t { none = 0, kept = 1, fading = 2 };

inline constexpr std::uint32_t kNoTriangle = 0xffffffff;

struct MainState {
  std::int64_t tick = 0;
  std::vector<Vec3i> displacement;  ///< by vertex, x 2^-position_exp m
  ModeMotion motion;                ///< of the basis's coefficients
  std::int64_t motion_tick = 0;     ///< tick of `motion`; packets of the haptic layer do not advance it
  std::vector<Vec3i>
      haptic_correction;         ///< layered: by vertex, correction of the last packet if that was of the haptic layer, else 0
  std::vector<Vec3i> off_basis;  ///< with a fade: by vertex, what corrections have added to the modes' displacement
  std::uint32_t triangle = kNoTriangle;  ///< the last one touched
  std::uint32_t visual = 0;              ///< visual bound, grid units
  std::uint32_t haptic = 0;              ///< index of the last haptic bound
  std::uint32_t density = 0;             ///< of significant vertices in the last packet: context of the next, as is `touched`
  std::uint32_t weight_set = 0;          ///< of the last packet, counted among those declared: context of the next
  bool touched = false;                  ///< the last packet had a triangle
  Following following = Following::none;
};

MainState initial_main_state(const DeformableObject& object);
std::uint64_t state_hash(const DeformableObject& object, const MainState& state) noexcept;

/// Frames between two ticks, rounded.
std::uint32_t frame_steps(const DeformableObject& object, std::int64_t ticks) noexcept;

/// floor(2^((index - 1) / 6)) for index >= 1, 0 for index 0.   pre  index <= kMaxHapticIndex
std::uint32_t haptic_bound(std::uint32_t index) noexcept;
inline constexpr std::uint32_t kMaxHapticIndex = 168;  ///< 2^27.8
inline constexpr std::uint32_t kMaxVisualBound = 1u << 28;

inline std::int64_t coefficient_step(const DeformableObject& object, std::uint32_t reach, std::size_t mode) noexcept {
  return std::clamp<std::int64_t>((std::int64_t{object.basis.steps[mode]} * reach) >> 12, 1, kMaxVisualBound);
}

/// Coefficients from quantiser steps to grid units: step k is steps[k] * reach * 2^-12, at least 1.
inline void scale_coefficients(const DeformableObject& object, std::uint32_t reach,
                               std::span<std::int32_t> coefficients) noexcept {
  for (std::size_t k = 0; k < coefficients.size(); ++k)
    coefficients[k] = limited_displacement(coefficients[k] * coefficient_step(object, reach, k));
}

/// Quantiser step for a bound: rounding each component moves a point by at most the bound.
constexpr std::int64_t step_of(std::uint32_t bound) noexcept {
  return std::max<std::int64_t>(1, (std::int64_t{bound} * 37837) >> 15);  // 2 / sqrt(3) * 2^15, rounded down
}

/// Adds motion and modes to displacements. Holds scratch space; allocates at creation only.
class ShapePredictor {
 public:
  /// pre  `object` outlives the predictor
  explicit ShapePredictor(const DeformableObject& object);

  /// out = the displacement that `state` predicts for a tick not before its own. Without a basis it is the state's displacement.
  void predict(const MainState& state, std::int64_t tick, std::span<Vec3i> out) noexcept;
  /// out += sum of modes times coefficients [grid units at a mode's entry of 1].
  void add_modes(std::span<const std::int32_t> coefficients, std::span<Vec3i> out) noexcept;
  /// Update the motion of `next`, a packet at `tick` after `base`, with the increments of the last predict() and add_modes().
  void update(const MainState& base, std::int64_t tick, MainState& next) const noexcept;

 private:
  void combine(std::span<const std::int32_t> coefficients, std::span<Vec3i> out) noexcept;
  void sum_modes(std::span<const std::int32_t> coefficients, unsigned shift) noexcept;
  void combine_clusters(std::span<const std::int32_t> coefficients, unsigned shift, std::span<Vec3i> out) noexcept;

  const DeformableObject& object_;
  std::vector<std::int32_t> increments_;    // by mode, of the current packet, since motion_tick
  std::vector<std::int32_t> extrapolated_;  // by mode, since the state's tick if that differs from motion_tick
  std::vector<std::int32_t> rounded_;       // by mode of clusters
  std::vector<std::int32_t> sum_;           // by component, but for clusters
};

// ==== followed shape ====
// The shape of an object as the device of a client makes it, for the codec of deformable objects (elastic/driven_shape.h has it). An
// interface, so that a program that knows no device links nothing of elastic bodies.

class FollowedShape {
 public:
  virtual ~FollowedShape() = default;

  /// What a state shows that follows the device: the shape at a tick, and what the state differed by from the shape at its own, or what is
  /// left of it.   out  false: one of the two is not known, and nothing is written
  virtual bool show(const MainState& state, std::int64_t tick, std::span<Vec3i> shown) noexcept = 0;
  /// The shape alone, on the grid.   out  false: it is not known
  virtual bool body_at(std::int64_t tick, std::span<Vec3i> shape) noexcept = 0;
  /// Go on to this tick. To be called at each shape that is not shown either: who is more than 64 behind begins anew at rest.
  virtual void follow(std::int64_t tick) noexcept = 0;
};

}  // namespace tactus
