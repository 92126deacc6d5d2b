// SPDX-License-Identifier: Apache-2.0
/// The equations of an elastic body: the order of its vertices, its elements, and the matrix that they add up to. Internal to the library.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <tactus/mesh/deformable_object.h>

namespace tactus {

/// The vertices at rest [m], those of the object first.
std::vector<Vec3> elastic_rest(const DeformableObject& object, unsigned position_exp);

// ==== elimination ====
// In which order the vertices of an elastic body are eliminated, and how long the rows of its matrix are: reverse Cuthill and McKee.
// spec/55-elastic.md section 3.2.

struct Elimination {
  static constexpr std::uint32_t kFixed = 0xffffffff;
  std::vector<std::uint32_t> order;        ///< free vertices
  std::vector<std::uint32_t> order_index;  ///< by vertex: its index in `order`; kFixed
  std::vector<std::uint32_t> first;        ///< by order index: the lowest one that shares a tetrahedron with it
};

/// in   vertices  of the object and inner ones.   pre  corners and fixed vertices exist.   time O(tets log tets); allocates
Elimination elimination(const ElasticBody& body, std::size_t vertices);

inline constexpr int kStabilitySteps = 24;  ///< of the power method that looks whether an explicit method is stable
/// Work of factoring the matrix of an implicit method. spec/55-elastic.md section 1.3
std::uint64_t elastic_work(const Elimination& elimination) noexcept;
/// Of a body on so many vertices, inner ones among them, whatever its method.
std::uint64_t elastic_work(const ElasticBody& body, std::size_t vertices);

// ==== elastic elements ====
// The co-rotated tetrahedra of an elastic body. spec/55-elastic.md sections 3.1 and 5.1.
// binary64 in the written order: both ends must agree on every bit. Elements are computed several at a time and added one by one.

using Rotation = std::array<double, 9>;  ///< rows

/// The orthogonal matrix nearest to a matrix, after so many steps of Newton's method: a rotation if its determinant is above 0.
Rotation nearest_rotation(const Rotation& of, int steps) noexcept;
/// The rotation nearest to the deformation gradient of an element, which may be thin or inside out.
Rotation element_rotation(const Rotation& of) noexcept;

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
  static void turn(Block& block, const std::array<Lanes, 9>& gradient) noexcept;  // rotation = nearest to the gradient
  template <Of of>
  static void add_forces(const Block& block, const std::array<Lanes, 9>& gradient, std::span<double> k) noexcept;

  std::vector<Block> blocks_;
  std::vector<double> mass_;
};

/// Whether velocity Verlet is stable with steps of this length [s] in the body's sub-steps; always true of the other methods (R-ELA-5).
/// spec/55-elastic.md section 3.4.   pre  the body breaks no other rule.   time 1 us per tetrahedron; allocates
bool is_stable(const ElasticBody& body, std::span<const Vec3> rest, double step);

// ==== elastic matrix ====
// The matrix of an elastic body's step at rest, factored into L D L^T within its envelope. spec/55-elastic.md section 3. Internal to the
// library. binary64 in the written order: both ends must agree on every bit.

class ElasticMatrix {
 public:
  /// mass_factor M + stiffness_factor K.   time 10 ms for 700 vertices; allocates
  ElasticMatrix(const ElasticBody& body, const Elimination& elimination, const ElasticElements& elements, double mass_factor,
                double stiffness_factor);

  /// Replace b by A^-1 b, both 3 per order index of the elimination.   time 0.5 ns per number in the envelope
  void solve(std::span<double> b) const noexcept;

 private:
  double* row(std::size_t i) noexcept { return lower_.data() + start_[i]; }
  const double* row(std::size_t i) const noexcept { return lower_.data() + start_[i]; }
  void add(const ElasticBody& body, const Elimination& elimination, const ElasticElements& elements, double factor) noexcept;
  void factor() noexcept;

  std::vector<std::size_t> first_, start_;  // by row: its first column; where that is in lower_
  std::vector<double> lower_, diagonal_;    // L, D
};

}  // namespace tactus
