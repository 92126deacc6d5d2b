// SPDX-License-Identifier: Apache-2.0
/// What a stream may make a receiver allocate.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include <tactus/scene/scene.h>

namespace tactus::testing {

/// By a declaration of so many bytes, parsed, and the receiver of its scene [bytes]. Names, objects and states all take bytes of the
/// declaration (spec/95-security.md section 3).
inline std::uint64_t earned(std::size_t bytes, const SceneSpec& spec) {
  const std::uint64_t span = spec.baseline_span;
  const std::uint64_t vectors = spec.loads ? (2 + std::uint64_t{spec.loads->users}) * spec.objects.size() : 0;
  const std::uint64_t loads = spec.loads ? 1024 + vectors * (40 + 12 * (span + 3)) + 128 * (span + 3) : 0;
  if (spec.deformables.empty()) return 8192 + bytes * (24 + 3 * span) + loads;
  std::uint64_t out = bytes * (640 + 10 * span) + loads;
  for (const DeformableObject& object : spec.deformables) {
    const bool has_models = object.profile == DeformableProfile::thesis;
    const std::uint64_t models = has_models ? 254 + (std::uint64_t{1} << object.quant_bits) : 0;
    out += 4096 + 256 * span + 4 * (span + 4) * models;
    out += 48 * (span + 4) * ModeBasis::kClusterModes * object.cluster_basis.count;
    if (const std::uint64_t modes = object.spring_basis.modes; modes > 0) {
      const std::uint64_t vertices = object.rest.size(), columns = modes + 16;
      out += vertices * (1024 + 6 * modes) + std::min<std::uint64_t>(vertices, 1024) * (8192 + 200 * columns) +
             512 * columns * columns + 48 * (span + 2) * modes;
    }
  }
  return out;
}

/// By one that is refused.
inline std::uint64_t earned_by_refused(std::size_t bytes, bool deformables) {
  SceneSpec spec;
  if (deformables) spec.deformables.resize(1);
  return earned(bytes, spec);
}

}  // namespace tactus::testing
