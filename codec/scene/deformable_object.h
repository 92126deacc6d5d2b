// SPDX-License-Identifier: Apache-2.0
/// A deformable object as a scene declares it. spec/20-scene.md section 4.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <tactus/base/list_of_lists.h>
#include <tactus/base/result.h>
#include <tactus/base/tri_mesh.h>
#include <tactus/scene/elastic_body.h>

namespace tactus {

enum class DeformableProfile : std::uint8_t { thesis = 0, main = 1 };

/// Which vertices a packet codes: those in the area of interest, the rest, or all.
enum class Layer : std::uint8_t { haptic = 0, visual = 1, all = 2 };

/// Where a cluster has a share of a vertex: the values there of its four functions, which it has for each axis.
struct ClusterShare {
  std::uint8_t cluster = 0;
  std::array<std::int16_t, 4> values{};  ///< x 2^-11: entries of the modes 12 * cluster + 3 * i + axis
  friend bool operator==(const ClusterShare&, const ClusterShare&) = default;
};

/// Basis vectors of displacements, known to both ends (vibration modes, principal components, maps of clusters).
struct ModeBasis {
  static constexpr std::size_t kMaxModes = 64;  ///< but for clusters, which have kClusterModes each
  static constexpr std::size_t kClusterModes = 12;
  static constexpr std::int32_t kMaxEntry = 2047;  ///< so that a sum of 64 products with 15-bit factors fits 32 bits

  std::vector<std::int16_t> entries;   ///< modes x vertices x 3, x 2^-11, |entry| <= kMaxEntry; empty: no basis
  ListOfLists<ClusterShare> shares{};  ///< by vertex, in place of `entries`, which are mostly 0
  std::vector<std::uint16_t> steps;    ///< one per mode: quantiser step of its coefficient, x 2^-12 of the visual bound; >= 1
  friend bool operator==(const ModeBasis&, const ModeBasis&) = default;
};

/// A basis that nobody declares: both ends compute the slowest modes of a network of springs. spec/50-deformable.md section 10
struct SpringBasis {
  std::uint8_t modes = 0;            ///< K, 0: none
  std::vector<std::uint32_t> fixed;  ///< vertices that do not move, ascending
  friend bool operator==(const SpringBasis&, const SpringBasis&) = default;
};

/// A basis for bodies that turn and walk: both ends compute it from the cluster of each vertex. spec/50-deformable.md section 11
struct ClusterBasis {
  static constexpr std::size_t kMaxClusters = 64;
  static constexpr std::uint8_t kMaxBlend = 32;

  std::uint8_t count = 0;              ///< 0: none
  std::uint8_t blend = 0;              ///< rounds of blending: clusters reach about sqrt(blend) edges into each other
  std::vector<std::uint8_t> clusters;  ///< by vertex, each below `count`
  friend bool operator==(const ClusterBasis&, const ClusterBasis&) = default;
};

/// Round a vector to the next mode of a basis; scale and step are those of make_mode_basis().   pre  finite
void append_mode(ModeBasis& basis, std::span<const double> vector, double coarseness = 1.5);

/// Makes a basis from vectors (modes x vertices x 3, any scale). Entries are scaled to the largest one. Quantiser steps are
/// chosen so that rounding any coefficient moves the mesh by the same root mean square: `coarseness` visual bounds in the norm of
/// the whole mesh.
/// err  invalid_argument R-API-1 an entry is not finite, or a vector is zero; R-API-9 more modes than ModeBasis::kMaxModes.
Result<ModeBasis> make_mode_basis(std::span<const double> vectors, std::size_t modes, double coarseness = 1.5);

/// Displacements are multiples of 2^-position_exp m like all positions of the stream, |component| <= kMaxDisplacement.
struct DeformableObject {
  static constexpr std::int32_t kMaxDisplacement = 1 << 27;
  static constexpr std::uint32_t kMaxRings = 32;
  static constexpr unsigned kMaxQuantBits = 12;
  static constexpr std::uint32_t kMaxFramePeriod = 1u << 28;
  static constexpr unsigned kWeightSets = 3;  ///< of parents: for a nugget of 2, 5 and 30 %

  std::string name;  ///< UTF-8, 1..255 bytes, unlike any other object's
  DeformableProfile profile = DeformableProfile::main;
  std::uint8_t rings = 3;            ///< m: size of the area of interest around the touched triangle (thesis 3.3.1.1)
  std::uint8_t quant_bits = 8;       ///< thesis: q, 1..12
  bool models_kept = false;          ///< thesis: entropy models are part of the state and not restarted in every packet
  std::uint32_t frame_period = 256;  ///< main: ticks between frames, x 2^-8; with a basis also the step of motion prediction
  bool layered = false;              ///< main: each packet belongs to the haptic or the visual layer
  std::uint16_t fade = 0;            ///< main: share of the corrections outside the basis that fades per frame, x 2^-16
  std::uint8_t weight_sets = 1;      ///< main: bit i: packets may name set i of kWeightSets; at least one
  std::vector<std::array<std::int32_t, 3>> rest;  ///< vertices, x 2^-position_exp m
  std::vector<Triangle> triangles;
  ModeBasis basis;             ///< main
  SpringBasis spring_basis;    ///< main: in place of `basis`, which a Scene then computes
  ClusterBasis cluster_basis;  ///< main: the same
  std::vector<std::uint8_t>
      stiffness;                    ///< levels (stiffness_level), one per vertex: what clients with delay need; empty: not told
  std::optional<ElasticBody> body;  ///< main, not layered: what it is made of; none: not told
  friend bool operator==(const DeformableObject&, const DeformableObject&) = default;
};

/// Level of the stiffness [N/m] of a vertex: the nearest, within 3.6 % from 0.016 N/m to 690 kN/m, else the first or last of them;
/// 0 for an infinite one, a vertex that does not move. spec/20-scene.md section 7
/// err  invalid_argument R-API-4: not above 0
Result<std::uint8_t> stiffness_level(double stiffness) noexcept;
/// [N/m]
double stiffness_of_level(std::uint8_t level) noexcept;
/// [N/m] At a point of a triangle, by barycentric weights; infinite where a corner that does not move has one.   time O(1)
/// pre  the object tells its stiffness
double stiffness_at(const DeformableObject& object, std::uint32_t triangle, const std::array<double, 3>& weights) noexcept;

/// A surface on a scene's grid; all other fields keep their defaults.
/// err  invalid_argument R-API-1 a coordinate is not finite; R-API-2 it leaves the grid's range; R-API-10 a triangle has no area
///      on the grid: a replica's trace could not hold it
Result<DeformableObject> make_deformable_object(std::string name, const TriMesh& surface, unsigned position_exp);

}  // namespace tactus
