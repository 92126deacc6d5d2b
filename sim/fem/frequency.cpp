// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/fem/frequency.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include <tactus/sim/random.h>

namespace tactus::sim {
namespace {

struct Bound {
  double value = 0, residual = 0;
};

/// Largest Ritz value of the tridiagonal matrix and the norm of its residual.
Bound top(const std::vector<double>& diagonal, const std::vector<double>& off) {
  const auto n = static_cast<Eigen::Index>(diagonal.size());
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
  solver.computeFromTridiagonal(Eigen::Map<const Eigen::VectorXd>(diagonal.data(), n),
                                Eigen::Map<const Eigen::VectorXd>(off.data(), n - 1));
  return {solver.eigenvalues()[n - 1], off.back() * std::abs(solver.eigenvectors()(n - 1, n - 1))};
}

}  // namespace

double largest_frequency(const SparseMatrix& stiffness, const SparseMatrix& mass) {
  constexpr int kMostSteps = 400;
  constexpr double kAccuracy = 2e-3;  // of omega^2
  const Eigen::Index n = stiffness.rows();
  if (n == 0) return 0;
  const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor(mass);
  Random random(1);
  Eigen::VectorXd p(n), q, z, before = Eigen::VectorXd::Zero(n);  // p = M q, q of length one in M
  for (double& x : p) x = random.uniform(-1, 1);
  q = factor.solve(p);
  double beta = std::sqrt(p.dot(q));
  std::vector<double> diagonal, off;
  Bound bound;
  for (int step = 0; step < std::min<Eigen::Index>(kMostSteps, n); ++step) {
    q /= beta;
    p /= beta;
    z = stiffness * q - (step > 0 ? beta : 0) * before;
    const double alpha = z.dot(q);
    z -= alpha * p;
    before = p;
    p = z;
    q = factor.solve(z);
    diagonal.push_back(alpha);
    beta = std::sqrt(std::max(p.dot(q), 0.0));
    off.push_back(beta);
    if (step % 8 != 7 && step + 1 < n && beta > 0) continue;
    bound = top(diagonal, off);
    if (bound.residual <= kAccuracy * bound.value || beta == 0) break;
  }
  return std::sqrt(std::max(bound.value + bound.residual, 0.0));
}

}  // namespace tactus::sim
