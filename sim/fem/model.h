// SPDX-License-Identifier: Apache-2.0
/// Linear tetrahedra, co-rotated (stiffness warping, Mueller and Gross 2004) or linear. Thesis 2.3.2.2, eq. 2.5:
///   M u'' + D u' + k(u) = f,   D = mass_damping M + stiffness_damping K
///
/// symbol  shape       unit   meaning
/// u, v    3N          m, m/s displacement and velocity of every vertex, x y z of vertex 0 first; zero at fixed vertices
/// f       3N          N      forces on vertices; what acts on fixed ones is ignored
/// k(u)    3N          N      sum over elements of R_e K_e (R_e^T x - X), R_e the rotation nearest to the deformation gradient F
/// W(u)    1           J      sum over elements of V (mu |e|^2 + lambda/2 tr(e)^2), e = sym(R_e^T F) - I; linear: R_e = I
///
/// k is exactly the gradient of W, rotations included: for linear tetrahedra with optimal R_e the variation of R_e drops out
/// (sim/fem/element.h). The exception is an optimum that is not unique, when the two smallest signed singular values of F sum to
/// zero: W has a kink there and k is one of its slopes. The forces of a body sum to zero, and so do their moments about the
/// deformed positions. fem_element_test checks each of these sentences.
///
/// Elements are processed several at a time in the widest vectors of the machine (chosen at run time); each lane does the same
/// operations in the same order without contraction, so every instruction set yields the same bits.
///
/// rule      class            broken when
/// R-TET-n                    the mesh (tet_mesh.h)
/// R-FEM-1   invalid          Young's modulus or density not in (0, 1e15], Poisson's ratio not in (-1, 0.5), or none of them finite
/// R-FEM-2   invalid          neither one material nor one per tetrahedron
/// R-FEM-3   invalid          a fixed vertex that does not exist; all vertices fixed is allowed
/// R-FEM-4   invalid          a damping that is negative or not finite
/// R-FEM-5   invalid_argument a force, displacement or step that is not finite, or a vector of the wrong length; state unchanged
/// R-FEM-6   invalid_argument a step diverged, being too long for the object or its forces: the state before it is kept
/// R-FEM-7   internal         the system matrix cannot be factored (not positive definite), or its slowest modes are not found
/// R-FEM-8   invalid_argument the method cannot do this: number of modes, tolerance, step outside [1e-9, 1] s
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <tactus/sim/tets/tet_mesh.h>

namespace tactus::sim {

struct Material {
  double young = 1e4;     ///< E [N/m^2]
  double poisson = 0.45;  ///< nu
  double density = 1000;  ///< [kg/m^3]
};

enum class Elasticity : std::uint8_t { corotated, linear };
enum class MassMatrix : std::uint8_t { lumped, consistent };

struct FemOptions {
  std::vector<Material> materials;   ///< one for all or one per tetrahedron
  std::vector<std::uint32_t> fixed;  ///< vertices
  Elasticity elasticity = Elasticity::corotated;
  MassMatrix mass = MassMatrix::lumped;
  double mass_damping = 0;       ///< [1/s]
  double stiffness_damping = 0;  ///< [s]
};

struct FemState {
  Eigen::VectorXd u;  ///< 3N [m]
  Eigen::VectorXd v;  ///< 3N [m/s]
};

/// Row-major so that a product with a vector can be split by rows; only the free degrees of freedom (free_dofs()).
using SparseMatrix = Eigen::SparseMatrix<double, Eigen::RowMajor, int>;

class FemModel {
 public:
  /// err  R-TET-n, R-FEM-1..4
  static tl::expected<FemModel, Diagnostic> create(TetMesh mesh, FemOptions options);

  const TetMesh& mesh() const noexcept;
  const FemOptions& options() const noexcept;
  Eigen::Index size() const noexcept;               ///< 3N
  std::span<const int> free_dofs() const noexcept;  ///< their numbers in u, ascending
  bool is_fixed(std::uint32_t vertex) const noexcept;
  FemState rest() const;                                ///< zero displacement, zero velocity
  const Eigen::VectorXd& lumped_mass() const noexcept;  ///< 3N [kg], row sums
  const SparseMatrix& mass_matrix() const noexcept;     ///< free x free, diagonal when lumped [kg]
  double total_mass() const noexcept;                   ///< [kg]

  /// k(u) [N]; zero at fixed vertices. Rotations are stored as the start of the next call. This saves time and changes k by at
  /// most 1e-13 of its size (except where the rotation is not unique); from the second call at the same u on, its bits are the
  /// same. Non-finite entries of u propagate to k and do not update the warm start.
  /// time O(tets), 18 ns each (AVX-512; AVX2 21, SSE2 42), linear 8; 0.5 us more each where R is not unique; no allocation.
  void internal_forces(const Eigen::VectorXd& u, Eigen::VectorXd& k) noexcept;
  /// W(u) [J], fixed vertices' elements included. Stores no rotation, so that later forces do not depend on this call.
  /// time as internal_forces; no allocation.
  double energy(const Eigen::VectorXd& u) noexcept;
  /// Sum over elements of R_e K_e R_e^T with the rotations at u [N/m], free x free. `matrix` gets the pattern once, later calls only
  /// rewrite its values; it is empty or one that this model has filled.
  /// time O(tets), 0.2 us each; no allocation after the first call with this matrix.
  void stiffness(const Eigen::VectorXd& u, SparseMatrix& matrix);
  /// The tangent dk/du with the derivative of the rotations, made positive semidefinite element by element where it is not.
  /// time O(tets), 0.5 us each; no allocation after the first call with this matrix.
  void tangent(const Eigen::VectorXd& u, SparseMatrix& matrix);
  /// Largest angular frequency [rad/s] of K against M at rest, by Lanczos' refinement of power iteration; at most 1e-3 too large,
  /// not too small. 0 when nothing is free.   time 4 ms for 2000 tets; allocates.
  double largest_frequency() const;
  /// First tetrahedron whose corners are not finite, or farther apart than 1e3 times their rest distance; -1: none.
  std::int64_t broken_element(const Eigen::VectorXd& u) const noexcept;

  FemModel(FemModel&&) noexcept;
  FemModel& operator=(FemModel&&) noexcept;
  ~FemModel();

 private:
  struct Impl;
  explicit FemModel(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

/// A force at a point inside a tetrahedron (weights of its four corners) or on a surface triangle, added to f.
void add_force(std::span<const std::uint32_t> corners, std::span<const double> weights, const Vec3& force,
               Eigen::VectorXd& f) noexcept;

}  // namespace tactus::sim
