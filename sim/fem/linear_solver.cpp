// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/fem/linear_solver.h>

#include <Eigen/LU>

#include <algorithm>

#include <tactus/base/rule.h>

namespace tactus::sim {
namespace {

SparseMatrix stiffness_at_rest(FemModel& model) {
  SparseMatrix K;
  model.stiffness(Eigen::VectorXd::Zero(model.size()), K);
  return K;
}

}  // namespace

Diagnostic not_positive_definite() {
  return {
      .error = fail(Errc::internal, "R-FEM-7").value(),
      .remedy =
          "the numbers of this object span more than a double can hold: look for slivers and for materials 1e12 times stiffer "
          "than others"};
}

SystemMatrix::SystemMatrix(FemModel& model)
    : model_(model), K_(stiffness_at_rest(model)), A_(K_), mass_(Eigen::VectorXd::Zero(K_.nonZeros())) {
  const SparseMatrix& M = model.mass_matrix();
  for (int row = 0; row < M.outerSize(); ++row) {
    const int* begin = K_.innerIndexPtr() + K_.outerIndexPtr()[row];
    const int* end = K_.innerIndexPtr() + K_.outerIndexPtr()[row + 1];
    for (SparseMatrix::InnerIterator it(M, row); it; ++it)
      mass_[std::lower_bound(begin, end, static_cast<int>(it.col())) - K_.innerIndexPtr()] = it.value();
  }
}

const SparseMatrix& SystemMatrix::assemble(const Eigen::VectorXd& u, double mass, double stiffness) {
  model_.stiffness(u, K_);
  Eigen::Map<Eigen::VectorXd>(A_.valuePtr(), A_.nonZeros()) =
      mass * mass_ + stiffness * Eigen::Map<const Eigen::VectorXd>(K_.valuePtr(), K_.nonZeros());
  return A_;
}

ConjugateGradients::ConjugateGradients(Eigen::Index size, double tolerance)
    : tolerance_(tolerance), inverse_(static_cast<std::size_t>(size / 3)), r_(size), z_(size), p_(size), q_(size) {}

void ConjugateGradients::prepare(const SparseMatrix& A) {
  for (int vertex = 0; vertex < static_cast<int>(inverse_.size()); ++vertex) {
    Eigen::Matrix3d block = Eigen::Matrix3d::Zero();
    for (int i = 0; i < 3; ++i) {
      for (SparseMatrix::InnerIterator it(A, 3 * vertex + i); it; ++it)
        if (it.col() / 3 == vertex) block(i, it.col() % 3) = it.value();
    }
    inverse_[static_cast<std::size_t>(vertex)] = block.inverse();
  }
}

void ConjugateGradients::precondition(const Eigen::VectorXd& r, Eigen::VectorXd& z) const {
  for (std::size_t i = 0; i < inverse_.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(3 * i);
    z.segment<3>(at).noalias() = inverse_[i] * r.segment<3>(at);
  }
}

int ConjugateGradients::solve(const SparseMatrix& A, const Eigen::VectorXd& b, Eigen::VectorXd& x) {
  constexpr int kMost = 2000;
  const double wanted = tolerance_ * tolerance_ * b.squaredNorm();
  r_ = b;
  r_.noalias() -= A * x;
  if (!(r_.squaredNorm() < b.squaredNorm())) {
    x.setZero();
    r_ = b;
  }
  precondition(r_, z_);
  p_ = z_;
  double product = r_.dot(z_);
  for (int iteration = 0; iteration < kMost; ++iteration) {
    if (r_.squaredNorm() <= wanted) return iteration;
    q_.noalias() = A * p_;
    const double along = product / p_.dot(q_);
    x += along * p_;
    r_ -= along * q_;
    precondition(r_, z_);
    const double before = product;
    product = r_.dot(z_);
    p_ = z_ + (product / before) * p_;
  }
  return kMost;
}

NewtonDirection::NewtonDirection(FemModel& model, const IntegratorOptions& options)
    : matrix_(model),
      direct_(options.solver == LinearSolver::cholesky),
      constant_(model.options().elasticity == Elasticity::linear),
      gradients_(matrix_.matrix().rows(), options.solver_tolerance),
      b_(matrix_.matrix().rows()),
      guess_(Eigen::VectorXd::Zero(matrix_.matrix().rows())) {
  if (direct_) cholesky_.analyse(matrix_.matrix());
}

tl::expected<int, Diagnostic> NewtonDirection::find(StageSystem& system, const Stage& stage, const Eigen::VectorXd& r,
                                                    Eigen::VectorXd& d) {
  const SparseMatrix& A = matrix_.matrix();
  if (!constant_ || prepared_ != stage.c) {
    matrix_.assemble(system.ahead(), system.mass_factor(stage.c), system.stiffness_factor(stage.c));
    if (direct_ && !cholesky_.factor(A)) return tl::unexpected(not_positive_definite());
    if (!direct_) gradients_.prepare(A);
    prepared_ = stage.c;
  }
  b_ = -r;
  if (direct_) {
    cholesky_.solve(b_, d);
    return 1;
  }
  const int iterations = gradients_.solve(A, b_, guess_);
  d = guess_;
  return iterations;
}

}  // namespace tactus::sim
