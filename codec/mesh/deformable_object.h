// SPDX-License-Identifier: Apache-2.0
/// What a scene declares of a deformable object: its mesh, how it is coded, what it is made of. spec/50-deformable.md section 1.2.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <tactus/base/geometry.h>
#include <tactus/base/result.h>
#include <tactus/base/tri_mesh.h>

namespace tactus {

// ==== elastic body ====
// What a deformable object is made of, told so that a client can work out how its own device deforms it. spec/55-elastic.md section 2.

struct ElasticMaterial {
  double young = 0;    ///< E [N/m^2], above 0, up to 1e15
  double poisson = 0;  ///< nu, above -1, below 0.5
  double density = 0;  ///< [kg/m^3], above 0, up to 1e15
  friend bool operator==(const ElasticMaterial&, const ElasticMaterial&) = default;
};

/// Tetrahedra between the vertices of the object and others inside of it, and the device's proxy on its surface.
struct ElasticBody {
  using Tet = std::array<std::uint32_t, 4>;
  static constexpr std::size_t kMaxMaterials = 255;
  static constexpr double kLargest = 1e15;           ///< of any constant
  static constexpr double kMostPoisson = 0.4999;     ///< beyond, a fixed number of iterations is not enough
  static constexpr std::uint32_t kMostTicks = 1024;  ///< of a frame
  static constexpr std::uint8_t kMostSubSteps = 255;

  /// Of a step, spec/55-elastic.md section 5.2: values on the wire.
  enum class Method : std::uint8_t { backward_euler = 1, tr_bdf2 = 2, velocity_verlet = 3 };

  /// At rest, x 2^-position_exp m. Their numbers follow those of the object's vertices.
  std::vector<std::array<std::int32_t, 3>> inner;
  std::vector<Tet> tets;                   ///< (b - a) x (c - a) . (d - a) > 0
  std::vector<ElasticMaterial> materials;  ///< 1..kMaxMaterials
  std::vector<std::uint8_t> material;      ///< of each tetrahedron
  std::vector<std::uint32_t> fixed;        ///< vertices that do not move, ascending; one is free at least
  double mass_damping = 0;                 ///< [1/s]
  double stiffness_damping = 0;            ///< [s]
  Vec3 gravity{};                          ///< [m/s^2]
  double coupling = 0;                     ///< [N/m] between device and proxy, above 0
  double friction = 0;                     ///< of the proxy on the surface
  Method method = Method::backward_euler;
  std::uint8_t sub_steps = 1;  ///< of velocity_verlet, which is stable with them; 1 of the others
  friend bool operator==(const ElasticBody&, const ElasticBody&) = default;
};

// ==== deformable object ====
// A deformable object as a scene declares it. spec/50-deformable.md section 1.2.

enum class DeformableProfile : std::uint8_t { thesis = 0, main = 1 };

/// Which vertices a packet codes: those in the area of interest, the rest, or all.
enum class Layer : std::uint8_t { haptic = 0, visual = 1, all = 2 };

/// Where a vertex has a weight of a cluster: the values there of the cluster's four functions, which it has for each axis.
struct ClusterEntry {
  std::uint8_t cluster = 0;
  std::array<std::int16_t, 4> values{};  ///< x 2^-11: entries of the modes 12 * cluster + 3 * i + axis
  friend bool operator==(const ClusterEntry&, const ClusterEntry&) = default;
};

/// Basis vectors of displacements, known to both ends (vibration modes, principal components, maps of clusters).
struct ModeBasis {
  static constexpr std::size_t kMaxModes = 64;  ///< but for clusters, which have kClusterModes each
  static constexpr std::size_t kClusterModes = 12;
  static constexpr std::int32_t kMaxEntry = 2047;  ///< so that a sum of 64 products with 15-bit factors fits 32 bits

  std::vector<std::int16_t> entries;            ///< modes x vertices x 3, x 2^-11, |entry| <= kMaxEntry; empty: no basis
  ListOfLists<ClusterEntry> cluster_entries{};  ///< by vertex, in place of `entries`, which are mostly 0
  std::vector<std::uint16_t> steps;  ///< one per mode: quantiser step of its coefficient, x 2^-12 of the visual bound; >= 1
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
  bool layered =
      false;  ///< each packet belongs to the haptic or the visual layer; thesis: not declared, as decoders need not know
  std::uint16_t fade = 0;        ///< main: fraction of the corrections outside the basis that fades per frame, x 2^-16
  std::uint8_t weight_sets = 1;  ///< main: bit i: packets may name set i of kWeightSets; at least one
  std::vector<std::array<std::int32_t, 3>> rest;  ///< vertices, x 2^-position_exp m
  std::vector<Triangle> triangles;
  ModeBasis basis;             ///< main
  SpringBasis spring_basis;    ///< main: in place of `basis`, which a Scene then computes
  ClusterBasis cluster_basis;  ///< main: the same
  std::vector<std::uint8_t>
      stiffness;  ///< levels (stiffness_level), one per vertex: what clients with delay need; empty: not declared
  std::optional<ElasticBody> body;  ///< main, not layered: what it is made of; none: not declared
  friend bool operator==(const DeformableObject&, const DeformableObject&) = default;
};

/// Level of the stiffness [N/m] of a vertex: the nearest, within 3.6 % from 0.016 N/m to 690 kN/m, else the first or last of them;
/// 0 for an infinite one, a vertex that does not move. spec/50-deformable.md section 1.6
/// err  invalid_argument R-API-4: not above 0
Result<std::uint8_t> stiffness_level(double stiffness) noexcept;
/// [N/m]
double stiffness_of_level(std::uint8_t level) noexcept;
/// [N/m] At a point of a triangle, by barycentric weights; infinite where a corner that does not move has one.   time O(1)
/// pre  the object declares its stiffness
double stiffness_at(const DeformableObject& object, std::uint32_t triangle, const std::array<double, 3>& weights) noexcept;

/// A surface on a scene's grid; all other fields keep their defaults.
/// err  invalid_argument R-API-1 a coordinate is not finite; R-API-2 it leaves the grid's range; R-API-10 a triangle has no area
///      on the grid: a replica's trace could not hold it
Result<DeformableObject> make_deformable_object(std::string name, const TriMesh& surface, unsigned position_exp);

}  // namespace tactus
