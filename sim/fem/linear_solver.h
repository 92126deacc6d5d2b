// SPDX-License-Identifier: Apache-2.0
/// The linear systems of implicit steps, and what solves them.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <utility>

#include <tactus/sim/fem/cholesky.h>
#include <tactus/sim/fem/newton.h>

namespace tactus::sim {

// ==== linear solver ====
// Newton directions from the current matrix, assembled in every iteration (once when elasticity is linear).

/// mass M + stiffness K(u) in one pattern.
class SystemMatrix {
 public:
  explicit SystemMatrix(FemModel& model);

  /// Rotations at u [3N].   no allocation.
  const SparseMatrix& assemble(const Eigen::VectorXd& u, double mass, double stiffness);
  const SparseMatrix& matrix() const noexcept { return A_; }

 private:
  FemModel& model_;
  SparseMatrix K_, A_;
  Eigen::VectorXd mass_;  // M's values where K has them
};

/// Conjugate gradients with the inverses of the 3 x 3 blocks of the diagonal, and no allocation.
class ConjugateGradients {
 public:
  ConjugateGradients(Eigen::Index size, double tolerance);

  /// pre  A is symmetric positive definite with full 3 x 3 blocks on its diagonal
  void prepare(const SparseMatrix& A);
  /// Solve A x = b to |b - A x| <= tolerance |b|, from the x given when that is better than zero.
  /// ret  iterations, at most 2000
  int solve(const SparseMatrix& A, const Eigen::VectorXd& b, Eigen::VectorXd& x);

 private:
  void precondition(const Eigen::VectorXd& r, Eigen::VectorXd& z) const;

  double tolerance_;
  std::vector<Eigen::Matrix3d> inverse_;
  Eigen::VectorXd r_, z_, p_, q_;
};

class NewtonDirection final : public DescentDirection {
 public:
  NewtonDirection(FemModel& model, const IntegratorOptions& options);

  tl::expected<int, Diagnostic> find(StageSystem& system, const Stage& stage, const Eigen::VectorXd& r,
                                     Eigen::VectorXd& d) override;
  void moved(const Eigen::VectorXd& /*s*/, const Eigen::VectorXd& /*y*/) override {}

 private:
  SystemMatrix matrix_;
  bool direct_, constant_;  // constant: linear elasticity
  double prepared_ = 0;     // c of a constant matrix that is ready
  Cholesky cholesky_;
  ConjugateGradients gradients_;
  Eigen::VectorXd b_, guess_;
};

Diagnostic not_positive_definite();

// ==== prefactored ====
// Quasi-Newton directions from one factorisation of A0 = mass M + stiffness K(0), made at the start (Liu, Bouaziz and Kavan 2017).
//
// The factor is that of the rest shape. Two corrections adapt it to the current shape:
//   turning   d = -Q A0^-1 Q^T r; Q turns each vertex with its surroundings. For any rotations in Q the product is symmetric
//             positive definite. One iteration of Mueller et al. 2016 on a quarter of the vertices per stage is enough.
//   memory    the last pairs (s, y) of steps and changes of r correct it along past steps (L-BFGS, Nocedal and Wright 7.4)

/// Rotation of each vertex's surroundings against the rest shape.
class VertexRotations {
 public:
  explicit VertexRotations(const FemModel& model);

  /// Update the next of `parts` parts of the free vertices.   in  u [3N]   time O(vertices / parts)
  void follow(const Eigen::VectorXd& u, std::size_t parts) noexcept;
  /// out = Q^T in.   in, out: free degrees of freedom
  void to_rest(const Eigen::VectorXd& in, Eigen::VectorXd& out) const noexcept;
  /// out = Q in.
  void to_shape(const Eigen::VectorXd& in, Eigen::VectorXd& out) const noexcept;

 private:
  static Eigen::Quaterniond nearer(const Eigen::Matrix3d& R, const Eigen::Matrix3d& moments, double size) noexcept;
  void turn_all(const Eigen::VectorXd& u) noexcept;
  void turn(std::size_t vertex, const Eigen::VectorXd& u) noexcept;

  std::vector<Eigen::Vector3d> rest_;  // all vertices
  std::vector<int> vertex_;            // free ones
  std::vector<std::size_t> begin_;     // their neighbours, in neighbours_
  std::vector<int> neighbours_;
  std::vector<Eigen::Matrix3d> rotation_;  // of free ones
  std::size_t next_ = 0;
  Eigen::Matrix3d whole_ = Eigen::Matrix3d::Identity();  // of the body
  Eigen::Vector3d middle_ = Eigen::Vector3d::Zero();     // mean of rest_
  double size_ = 0;                                      // sum of squares about it
};

class PrefactoredDirection final : public DescentDirection {
 public:
  /// pre  stages have this c.   err  R-FEM-7
  static tl::expected<std::unique_ptr<DescentDirection>, Diagnostic> create(FemModel& model, double c);

  tl::expected<int, Diagnostic> find(StageSystem& system, const Stage& stage, const Eigen::VectorXd& r,
                                     Eigen::VectorXd& d) override;
  void moved(const Eigen::VectorXd& s, const Eigen::VectorXd& y) override;
  void forget() override;

 private:
  explicit PrefactoredDirection(const FemModel& model);
  void to_rest(Eigen::VectorXd& x) const;

  struct Pair {
    Eigen::VectorXd s, y;
    double inverse = 0;  // 1 / (s . y); 0: none yet
    double weight = 0;
  };
  static constexpr std::size_t kMemory = 5;

  Cholesky cholesky_;
  VertexRotations rotations_;
  bool turning_;
  std::array<Pair, kMemory> pairs_;
  std::size_t newest_ = 0;
  Eigen::VectorXd turned_;
};

}  // namespace tactus::sim
