// SPDX-License-Identifier: Apache-2.0
#include <tactus/base/elementary.h>
#include <tactus/sim/fem/newton.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <tactus/base/rule.h>

namespace tactus::sim {
namespace {

constexpr double kAge = 0.8;        ///< each use of the remembered shrinkage raises it to this power
constexpr double kDiverged = 0.01;  ///< of the motion
constexpr double kNothing = 1e-10;  ///< of the motion: below rounding, and invisible even after a thousand steps

}  // namespace

StageSystem::StageSystem(FemModel& model)
    : model_(model), ahead_(Eigen::VectorXd::Zero(model.size())), k_(ahead_), v_(Eigen::VectorXd::Zero(size())), Mv_(v_) {
  SparseMatrix K;
  model.stiffness(ahead_, K);
  double longest = 0;
  for (const Tet& tet : model.mesh().tets)
    longest = std::max(longest, norm(model.mesh().vertices[tet[1]] - model.mesh().vertices[tet[0]]));
  const double stiffest = K.size() == 0 ? 0.0 : K.diagonal().maxCoeff();
  rounding_ = std::numeric_limits<double>::epsilon() * std::sqrt(static_cast<double>(size())) * stiffest * longest;
}

void StageSystem::gather(const Eigen::VectorXd& full, Eigen::VectorXd& free) const noexcept {
  const auto dofs = model_.free_dofs();
  for (std::size_t i = 0; i < dofs.size(); ++i) free[static_cast<Eigen::Index>(i)] = full[dofs[i]];
}

void StageSystem::scatter(const Eigen::VectorXd& free, Eigen::VectorXd& full) const noexcept {
  const auto dofs = model_.free_dofs();
  for (std::size_t i = 0; i < dofs.size(); ++i) full[dofs[i]] = free[static_cast<Eigen::Index>(i)];
}

void StageSystem::forces(const Eigen::VectorXd& u, const Eigen::VectorXd& v, Eigen::VectorXd& k) {
  k = u + beta() * v;
  scatter(k, ahead_);
  model_.internal_forces(ahead_, k_);
  gather(k_, k);
}

void StageSystem::residual(const Stage& stage, const Eigen::VectorXd& u, Eigen::VectorXd& r) {
  v_ = (u - stage.a) / stage.c;
  forces(u, v_, r);
  r -= stage.f + stage.Mb / stage.c;
  v_ *= 1 / stage.c + alpha();
  r.noalias() += model_.mass_matrix() * v_;
}

void StageSystem::balanced_forces(const Stage& stage, const Eigen::VectorXd& v, Eigen::VectorXd& k) {
  v_ = (1 / stage.c + alpha()) * v;
  k = stage.f + stage.Mb / stage.c;
  k.noalias() -= model_.mass_matrix() * v_;
}

double StageSystem::motion(const Stage& stage, const Eigen::VectorXd& u) {
  v_ = (u - stage.a) / stage.c;
  Mv_.noalias() = model_.mass_matrix() * v_;
  return v_.dot(Mv_);
}

Newton::Newton(FemModel& model, const IntegratorOptions& options, std::unique_ptr<DescentDirection> direction)
    : system_(model),
      direction_(std::move(direction)),
      iterations_(options.newton_iterations),
      tolerance_(options.newton_tolerance),
      r_(system_.size()),
      next_r_(system_.size()),
      d_(Eigen::VectorXd::Zero(system_.size())) {}

tl::expected<StepReport, Diagnostic> Newton::solve(const Stage& stage, Eigen::VectorXd& u) {
  StepReport report{0, 0, false};
  diverged_ = false;
  system_.residual(stage, u, r_);
  const double motion = system_.motion(stage, u);  // square of an energy norm, as the others here
  double first = 0;
  while (report.newton_iterations < iterations_) {
    const double residual = r_.norm();
    if (!std::isfinite(residual)) return tl::unexpected(Diagnostic{fail(Errc::invalid_argument, "R-FEM-6").value()});
    if (residual <= system_.rounding()) {
      report.converged = true;
      break;
    }
    TACTUS_TRY(const auto found, direction_->find(system_, stage, r_, d_));
    const double decrease = -d_.dot(r_);  // square of the update's energy norm
    if (report.newton_iterations == 0) first = decrease;
    ++report.newton_iterations;
    report.solver_iterations += found;
    u += d_;
    const double enough = std::max(tolerance_ * tolerance_ * first, kNothing * kNothing * motion);
    report.converged = decrease <= enough;
    if (report.newton_iterations == 1 && shrinkage_ * decrease <= enough) {
      // Earlier stages predict what a second iteration would add (Hairer and Wanner 1996, IV.8).
      report.converged = true;
      shrinkage_ = power(shrinkage_, kAge);
    }
    if (report.converged || iterations_ == 1) break;
    if (!search(stage, decrease, u)) direction_->forget();
    // The next update would shrink about as much as the residual did.
    const double shrinkage = next_r_.squaredNorm() / (residual * residual);
    if (report.newton_iterations == 1) shrinkage_ = std::min(shrinkage, 1.0);
    report.converged = shrinkage * decrease <= enough;
    diverged_ = shrinkage * decrease > kDiverged * kDiverged * std::max(motion, first);
    next_r_.swap(r_);
    next_r_ = r_ - next_r_;
    direction_->moved(d_, next_r_);
    if (report.converged) break;
  }
  diverged_ = diverged_ && !report.converged;
  return report;
}

/// Shorten the step just taken while the slope at its end shows that it overshot the minimum by more than half.
/// Afterwards d is the step in its final length and next_r its residual.   ret  false when it had to be shortened
bool Newton::search(const Stage& stage, double decrease, Eigen::VectorXd& u) {
  constexpr int kMost = 4;
  for (int i = 0;; ++i) {
    system_.residual(stage, u, next_r_);
    const double slope = d_.dot(next_r_);
    if (i == kMost || !(slope > 0.5 * decrease)) return i == 0;
    const double shorter = std::max(0.1, decrease / (decrease + slope));
    u -= (1 - shorter) * d_;
    d_ *= shorter;
    decrease *= shorter;
  }
}

}  // namespace tactus::sim
