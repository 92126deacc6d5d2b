// SPDX-License-Identifier: Apache-2.0
#include "sim/fem/modal.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/fem/linear_solver.h"
#include "sim/random.h"

namespace tactus {
namespace {

constexpr Eigen::Index kDense = 300;  ///< problems this small are solved whole
constexpr double kAccuracy = 1e-10;
constexpr int kIterations = 300;

Modes dense_modes(const SparseMatrix& K, const SparseMatrix& M, Eigen::Index count) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver{Eigen::MatrixXd(K), Eigen::MatrixXd(M)};
  return {solver.eigenvalues().head(count).cwiseMax(0.0), solver.eigenvectors().leftCols(count)};
}

/// exp of the step's matrix, by scaling and squaring of its Taylor series; lambda and damping of any size, zero and critical too.
Eigen::Matrix<double, 2, 3> exact_step(double lambda, double damping, double h) {
  Eigen::Matrix3d A;
  A << 0, 1, 0, -lambda * h * h, -damping * h, 1, 0, 0, 0;
  const double size = A.cwiseAbs().rowwise().sum().maxCoeff();
  const int halvings = std::max(0, static_cast<int>(std::ceil(std::log2(size))) + 2);
  A /= std::ldexp(1.0, halvings);
  Eigen::Matrix3d sum = Eigen::Matrix3d::Identity(), term = sum;
  for (int i = 1; i <= 16; ++i) {
    term = term * A / i;
    sum += term;
  }
  for (int i = 0; i < halvings; ++i) sum = sum * sum;
  return sum.topRows<2>();
}

}  // namespace

tl::expected<Modes, FemError> slowest_modes(FemModel& model, int count) {
  SparseMatrix K;
  model.stiffness(Eigen::VectorXd::Zero(model.size()), K);
  const SparseMatrix& M = model.mass_matrix();
  const Eigen::Index n = K.rows(), size = std::min<Eigen::Index>(n, std::max(2 * count, count + 8));
  if (n <= kDense || 2 * size > n) return dense_modes(K, M, count);

  const double fastest = model.largest_frequency(), shift = 1e-8 * fastest * fastest;
  SystemMatrix matrix(model);
  Cholesky cholesky;
  cholesky.analyse(matrix.matrix());
  if (!cholesky.factor(matrix.assemble(Eigen::VectorXd::Zero(model.size()), shift, 1)))
    return tl::unexpected(not_positive_definite());

  Random random(1);
  Eigen::MatrixXd X(n, size), MX(n, size);
  for (double& x : X.reshaped()) x = random.uniform(-1, 1);
  Eigen::VectorXd column(n), before = Eigen::VectorXd::Zero(size), values(size);
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    for (Eigen::Index j = 0; j < size; ++j) {
      column = M * X.col(j);
      cholesky.solve(column, column);
      X.col(j) = column;
    }
    MX.noalias() = M * X;
    const Eigen::MatrixXd KX = K * X;
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> ritz(X.transpose() * KX, X.transpose() * MX);
    X = X * ritz.eigenvectors();
    values = ritz.eigenvalues();
    const auto change = ((values - before).head(count).array().abs() / (values.head(count).array().abs() + shift)).maxCoeff();
    if (change < kAccuracy) break;
    before = values;
  }
  return Modes{values.head(count).cwiseMax(0.0), X.leftCols(count)};
}

tl::expected<std::unique_ptr<Integrator>, FemError> Modal::create(FemModel& model, const IntegratorOptions& options) {
  auto modes = slowest_modes(model, options.modes);
  if (!modes) return tl::unexpected(modes.error());
  return std::unique_ptr<Integrator>(new Modal(model, options, std::move(*modes)));
}

Modal::Modal(FemModel& model, const IntegratorOptions& options, Modes modes)
    : Guarded(model, options),
      modes_(std::move(modes)),
      weighted_(model.mass_matrix() * modes_.shapes),
      q_(Eigen::VectorXd::Zero(modes_.squares.size())),
      rate_(q_),
      force_(q_),
      free_(modes_.shapes.rows()) {
  for (const double lambda : modes_.squares)
    recurrence_.push_back(
        exact_step(lambda, model.options().mass_damping + model.options().stiffness_damping * lambda, options.step));
}

tl::expected<StepReport, FemError> Modal::advance(const Eigen::VectorXd& f, const FemState& state, FemState& next) {
  const auto dofs = model().free_dofs();
  const auto gather = [&](const Eigen::VectorXd& full) {
    for (std::size_t i = 0; i < dofs.size(); ++i) free_[static_cast<Eigen::Index>(i)] = full[dofs[i]];
  };
  const auto expand = [&](const Eigen::VectorXd& q, Eigen::VectorXd& full) {
    free_.noalias() = modes_.shapes * q;
    full.setZero();
    for (std::size_t i = 0; i < dofs.size(); ++i) full[dofs[i]] = free_[static_cast<Eigen::Index>(i)];
  };
  if (edited()) {
    gather(state.u);
    q_.noalias() = weighted_.transpose() * free_;
    gather(state.v);
    rate_.noalias() = weighted_.transpose() * free_;
  }
  gather(f);
  force_.noalias() = modes_.shapes.transpose() * free_;
  for (std::size_t i = 0; i < recurrence_.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const Eigen::Vector2d after = recurrence_[i] * Eigen::Vector3d(q_[k], h() * rate_[k], h() * h() * force_[k]);
    q_[k] = after[0];
    rate_[k] = after[1] / h();
  }
  expand(q_, next.u);
  expand(rate_, next.v);
  return StepReport{};
}

}  // namespace tactus
