// SPDX-License-Identifier: Apache-2.0
/// Newton directions from the current matrix, assembled in every iteration (once when elasticity is linear).
#pragma once

#include <tactus/sim/fem/cholesky.h>
#include <tactus/sim/fem/newton.h>

namespace tactus::sim {

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

}  // namespace tactus::sim
