// SPDX-License-Identifier: Apache-2.0
/// What a deformable object is made of, told so that a client can work out how its own device deforms it. spec/55-elastic.md section 2.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <tactus/base/geometry.h>

namespace tactus {

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
  static constexpr std::uint32_t kMostTicks = 1024;  ///< of a frame

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
  friend bool operator==(const ElasticBody&, const ElasticBody&) = default;
};

}  // namespace tactus
