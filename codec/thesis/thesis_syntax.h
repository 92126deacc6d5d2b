// SPDX-License-Identifier: Apache-2.0
/// Meshes of profile thesis: a list of vertices and their displacement errors, quantised over the packet's range (thesis 3.3.1, figure
/// 3.17). spec/85-thesis.md section 2. Shared by encoder and decoder, internal to the library.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <tactus/base/fixed.h>
#include <tactus/base/range_coder.h>
#include <tactus/packet/substream.h>
#include <tactus/scene/scene_objects.h>

namespace tactus {

inline constexpr std::size_t kIndexModels = 255;  // an 8-bit symbol
inline constexpr std::uint32_t kGapEscape = 255;

struct ThesisState {
  std::int64_t tick = 0;
  std::vector<Vec3i> displacement;  ///< by vertex, x 2^-position_exp m
  std::vector<BitModel> models;     ///< with models_kept: index models, then displacement models
};

ThesisState initial_thesis_state(const DeformableObject& object);
std::uint64_t state_hash(const DeformableObject& object, const ThesisState& state) noexcept;

/// Order-0 models: the index list's symbol, then the displacements' symbol of quant_bits bits.
std::vector<BitModel> initial_thesis_models(const DeformableObject& object);

struct ThesisHead : PacketHead {
  std::uint32_t count = 0;       ///< vertices in the packet
  std::uint32_t list_bytes = 0;  ///< of the coded index list
  std::int32_t lowest = 0;       ///< quantiser range, grid units
  std::uint32_t range = 0;       ///< highest - lowest
};

template <class Coder>
std::uint32_t code_symbol(Coder& coder, std::span<BitModel> models, unsigned bits, std::uint32_t value) noexcept {
  std::uint32_t node = 1;
  for (unsigned i = bits; i-- > 0;) node = 2 * node + (coder.bit(models[node - 1], (value >> i) & 1u) ? 1u : 0u);
  return node - (1u << bits);
}

/// Run of skipped vertices: symbol 255 adds 255 and continues the run. Stops above `limit`.
template <class Coder>
std::uint32_t code_gap(Coder& coder, std::span<BitModel> models, std::uint32_t gap, std::uint32_t limit) noexcept {
  std::uint32_t out = 0;
  while (out <= limit) {
    const std::uint32_t part = code_symbol(coder, models.first(kIndexModels), 8, std::min(gap - out, kGapEscape));
    out += part;
    if (part < kGapEscape) break;
  }
  return out;
}

/// Quantised error <-> grid units.
constexpr std::uint32_t quantise_error(std::int32_t error, const ThesisHead& head, unsigned bits) noexcept {
  if (head.range == 0) return 0;
  const std::int64_t levels = (std::int64_t{1} << bits) - 1;
  return static_cast<std::uint32_t>(round_div((std::int64_t{error} - head.lowest) * levels, head.range));
}
constexpr std::int32_t restore_error(std::uint32_t symbol, const ThesisHead& head, unsigned bits) noexcept {
  const std::int64_t levels = (std::int64_t{1} << bits) - 1;
  return static_cast<std::int32_t>(head.lowest + round_div(std::int64_t{symbol} * head.range, levels));
}

/// Upper bound of the size of any packet, without its substream's number [bytes].
constexpr std::size_t max_thesis_packet(std::size_t vertices, unsigned quant_bits) noexcept {
  constexpr std::size_t kHead = 96;                   // fields, tails
  return kHead + (17u + 6u * quant_bits) * vertices;  // a gap and three symbols at 15 bits per adaptive bit
}

}  // namespace tactus
