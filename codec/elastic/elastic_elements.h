// SPDX-License-Identifier: Apache-2.0
/// The co-rotated tetrahedra of an elastic body. spec/55-elastic.md sections 3.1 and 5.1. Internal to the library.
/// binary64 in the written order: both ends must agree on every bit. Elements are computed several at a time and added one by one.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <tactus/scene/elastic_body.h>

namespace tactus {

using Rotation = std::array<double, 9>;  ///< rows

/// The rotation nearest to a matrix, after so many steps of Newton's method.
Rotation nearest_rotation(const Rotation& of, int steps) noexcept;

class ElasticElements {
 public:
  /// in   rest  [m] of all vertices.   pre  the body breaks no rule
  ElasticElements(const ElasticBody& body, std::span<const Vec3> rest);

  /// k = forces [N] at displacements u [m], both 3 per vertex. Keeps each element's rotation.   time 80 ns per element
  void forces(std::span<const double> u, std::span<double> k) noexcept;
  /// k = K p with the rotations of the last forces().   time 30 ns per element
  void multiply(std::span<const double> p, std::span<double> k) noexcept;
  /// A rotation for each vertex: of those of its elements, the stiffer ones counting more.   time 20 ns per element
  void vertex_rotations(std::span<Rotation> out) const noexcept;

  /// [N/m] How corner `row` of an element pulls where corner `column` moves, at rest. In 3 x 3.
  Rotation stiffness(std::size_t element, std::size_t row, std::size_t column) const noexcept;
  std::span<const double> mass() const noexcept { return mass_; }  ///< [kg] by vertex

 private:
  static constexpr std::size_t kLanes = 4;
  using Lanes = std::array<double, kLanes>;
  struct Block {
    std::array<std::array<std::uint32_t, kLanes>, 4> corner{};  // 3 * vertex
    std::array<Lanes, 9> gradient{};                            // [1/m] of corners 1 to 3, x y z
    Lanes two_mu{}, lambda{};                                   // times the volume [J]
    std::array<Lanes, 9> rotation{};
    std::size_t count = 0;  // of elements
  };
  enum class Of : std::uint8_t { shape, increment };

  template <Of of>
  static void gather(const Block& block, std::span<const double> u, std::array<Lanes, 9>& gradient) noexcept;
  static void turn(Block& block, const std::array<Lanes, 9>& gradient) noexcept;
  template <Of of>
  static void add_forces(const Block& block, const std::array<Lanes, 9>& gradient, std::span<double> k) noexcept;

  std::vector<Block> blocks_;
  std::vector<double> mass_;
};

}  // namespace tactus
