// SPDX-License-Identifier: Apache-2.0
/// What a file may make a decoder allocate [bytes].
#pragma once

#include <cstddef>
#include <cstdint>

#include <tactus/scene/scene_syntax.h>

namespace tactus::testing {

/// Names, objects and states, which all take bytes of the header (spec/20-stream.md 5).
inline std::uint64_t earned(std::size_t bytes, std::uint64_t states) { return 4096 + bytes * (24 + 3 * states); }

/// A header of so many bytes, parsed, and the decoder of one of its meshes (spec/60-mesh.md 10).
inline std::uint64_t earned(std::size_t bytes, std::uint64_t span, const DeformableObject& mesh) {
  const std::uint64_t models = mesh.profile == DeformableProfile::thesis ? 254 + (std::uint64_t{1} << mesh.quant_bits) : 0;
  return 4096 + 256 * span + bytes * (640 + 10 * span) + 4 * (span + 4) * models;
}

}  // namespace tactus::testing
