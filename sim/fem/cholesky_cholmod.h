// SPDX-License-Identifier: Apache-2.0
/// The factorisation of cholesky.h by CHOLMOD, for comparison: built and used in place of ours with TACTUS_WITH_CHOLMOD.
///
/// CHOLMOD's simplicial method, ordered by minimum degree: it calls no BLAS, so that its bits do not depend on which one a machine
/// has installed, and its solves are as fast at the sizes of a haptic scene as those of the supernodal one with the fastest BLAS.
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <memory>

#include <tactus/sim/fem/model.h>

namespace tactus::sim {

class CholmodCholesky {
 public:
  CholmodCholesky();
  ~CholmodCholesky();
  CholmodCholesky(CholmodCholesky&&) noexcept;
  CholmodCholesky& operator=(CholmodCholesky&&) noexcept;

  // As those of LdlCholesky.
  void analyse(const SparseMatrix& A);
  bool factor(const SparseMatrix& A) noexcept;
  void solve(const Eigen::VectorXd& b, Eigen::VectorXd& x) noexcept;
  std::int64_t fill() const noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;  // none: nothing to solve for
};

}  // namespace tactus::sim
