// SPDX-License-Identifier: Apache-2.0
/// A deformable object as a stream header declares it. spec/60-mesh.md section 2.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <tactus/base/tri_mesh.h>

namespace tactus {

enum class DeformableProfile : std::uint8_t { thesis = 0, main = 1 };

/// Of which vertices a packet speaks: of those in the area of interest, of the others, or of all.
enum class Layer : std::uint8_t { haptic = 0, visual = 1, all = 2 };

/// Vectors known to both ends that displacements are combined from (vibration modes, principal components).
struct ModeBasis {
  static constexpr std::size_t kMaxModes = 64;
  static constexpr std::int32_t kMaxEntry = 2047;  ///< so that a sum of 64 products with 15-bit factors fits 32 bits

  std::vector<std::int16_t> entries;  ///< modes x vertices x 3, x 2^-11, |entry| <= kMaxEntry; empty: no basis
  std::vector<std::uint16_t> steps;   ///< one per mode: quantiser step of its coefficient, x 2^-12 of the visual bound; >= 1
  friend bool operator==(const ModeBasis&, const ModeBasis&) = default;
};

/// Displacements are multiples of 2^-position_exp m like all positions of the stream, |component| <= kMaxDisplacement.
struct DeformableObject {
  static constexpr std::int32_t kMaxDisplacement = 1 << 27;
  static constexpr std::uint32_t kMaxRings = 32;
  static constexpr unsigned kMaxQuantBits = 12;
  static constexpr std::uint32_t kMaxFramePeriod = 1u << 28;

  std::string name;  ///< UTF-8, 1..255 bytes, unlike any other object's
  DeformableProfile profile = DeformableProfile::main;
  std::uint8_t rings = 3;            ///< m: size of the area of interest around the touched triangle (thesis 3.3.1.1)
  std::uint8_t quant_bits = 8;       ///< thesis: q, 1..12
  bool models_kept = false;          ///< thesis: entropy models are part of the state and not restarted in every packet
  std::uint32_t frame_period = 256;  ///< main: ticks between frames, x 2^-8; with a basis motion is predicted in steps of it
  bool split = false;                ///< main: packets are haptic or visual halves
  std::vector<std::array<std::int32_t, 3>> rest;  ///< vertices, x 2^-position_exp m
  std::vector<Triangle> triangles;
  ModeBasis basis;  ///< main
  friend bool operator==(const DeformableObject&, const DeformableObject&) = default;
};

}  // namespace tactus
