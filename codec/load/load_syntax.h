// SPDX-License-Identifier: Apache-2.0
/// Syntax of a packet of loads: shared by encoder and decoder, internal to the library. spec/45-load.md 4
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>

#include <tactus/base/fixed.h>
#include <tactus/base/range_coder.h>
#include <tactus/load/load_state.h>
#include <tactus/packet/substream.h>

namespace tactus {

inline constexpr std::size_t kLoadKinds = 3;     // external, hold, pushes
inline constexpr std::size_t kLoadContexts = 5;  // 0: the first component of a vector; 1..4: how large those before it were

/// Every adaptive model of a packet, initial in each.
struct LoadModels {
  BitModel key;
  MagnitudeModel baseline;
  MagnitudeModel tick_delta;
  MagnitudeModel count;
  MagnitudeModel gap;
  TreeModel<3> level;
  std::array<BitModel, kLoadKinds> changed;
  std::array<std::array<MagnitudeModel, kLoadContexts>, kLoadKinds> step;
};

struct LoadHead : PacketHead {
  std::uint32_t count = 1;  ///< objects
};

template <class Coder>
void code_head(Coder& coder, LoadModels& models, const Scene& scene, LoadHead& head) noexcept {
  code_baseline(coder, models, scene.baseline_span, head);
  head.tick_delta = coder.magnitude(models.tick_delta, head.tick_delta);
  if (scene.moving().size() > 1) head.count = coder.magnitude(models.count, head.count);
}

/// Steps of a vector from its baseline, in units of 4^level grid steps; `changed` false: none.
struct LoadStep {
  bool changed = false;
  Vec3i steps{};
};

/// in, out  steps  one per vector of the object
template <class Coder>
void code_load(Coder& coder, LoadModels& models, std::uint8_t& level, std::span<LoadStep> steps) noexcept {
  level = static_cast<std::uint8_t>(coder.template tree<3>(models.level, level));
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const std::size_t kind = std::min(i, kLoadKinds - 1);
    LoadStep& step = steps[i];
    step.changed = coder.bit(models.changed[kind], step.changed ? 1u : 0u);
    if (!step.changed) continue;
    std::size_t context = 0;
    std::uint32_t largest = 0;
    for (std::int32_t& value : step.steps) {
      value = coder.signed_value(models.step[kind][context], value);
      largest = std::max(largest, static_cast<std::uint32_t>(value < 0 ? -value : value));
      const auto width = static_cast<unsigned>(std::bit_width(largest));
      context = width == 0 ? 1 : width < 3 ? 2 : width < 6 ? 3 : 4;
    }
  }
}

/// A vector after its step. spec 45-load 4
inline Vec3i after_step(const Vec3i& base, const Vec3i& steps, unsigned level) noexcept {
  const unsigned shift = 2 * level;
  Vec3i out{};
  for (std::size_t a = 0; a < 3; ++a) out[a] = saturate32((round_shift(base[a], shift) + steps[a]) << shift);
  return out;
}

/// Upper bound of the size of any packet of a scene's loads, without its substream's number [bytes].   pre  the scene has loads
inline std::size_t max_load_packet(const Scene& scene) noexcept {
  constexpr std::size_t kHead = 64, kObject = 16, kVector = 48;  // 15 bits per adaptive bit
  return kHead + (kObject + kVector * vectors_of_load(scene)) * scene.moving().size();
}

}  // namespace tactus
