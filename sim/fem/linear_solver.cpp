// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/fem/linear_solver.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include <tactus/base/rule.h>

namespace tactus::sim {

// ==== linear solver ====

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

// ==== prefactored ====

namespace {

constexpr std::size_t kParts = 4;

Eigen::Index dof(std::size_t vertex) { return static_cast<Eigen::Index>(3 * vertex); }

}  // namespace

VertexRotations::VertexRotations(const FemModel& model) {
  const TetMesh& mesh = model.mesh();
  for (const Vec3& x : mesh.vertices) rest_.emplace_back(x.x, x.y, x.z);
  std::vector<std::vector<int>> around(rest_.size());
  for (const Tet& tet : mesh.tets)
    for (const std::uint32_t i : tet)
      for (const std::uint32_t j : tet)
        if (i != j) around[i].push_back(static_cast<int>(j));
  begin_.push_back(0);
  for (std::uint32_t i = 0; i < rest_.size(); ++i) {
    if (model.is_fixed(i)) continue;
    std::sort(around[i].begin(), around[i].end());
    neighbours_.insert(neighbours_.end(), around[i].begin(), std::unique(around[i].begin(), around[i].end()));
    begin_.push_back(neighbours_.size());
    vertex_.push_back(static_cast<int>(i));
  }
  rotation_.assign(vertex_.size(), Eigen::Matrix3d::Identity());
  for (const Eigen::Vector3d& x : rest_) middle_ += x / static_cast<double>(rest_.size());
  for (const Eigen::Vector3d& x : rest_) size_ += (x - middle_).squaredNorm();
}

void VertexRotations::follow(const Eigen::VectorXd& u, std::size_t parts) noexcept {
  turn_all(u);
  const std::size_t count = (vertex_.size() + parts - 1) / parts;
  for (std::size_t i = 0; i < count; ++i) {
    turn(next_, u);
    next_ = next_ + 1 == vertex_.size() ? 0 : next_ + 1;
  }
}

/// One step of R towards the rotation in `moments` (Mueller et al. 2016): a turn by omega = sum_i r_i x c_i / |sum_i r_i . c_i|, with
/// r_i and c_i the columns of R and of the moments.
Eigen::Quaterniond VertexRotations::nearer(const Eigen::Matrix3d& R, const Eigen::Matrix3d& moments, double size) noexcept {
  Eigen::Vector3d omega = Eigen::Vector3d::Zero();
  double along = 0;
  for (int i = 0; i < 3; ++i) {
    omega += R.col(i).cross(moments.col(i));
    along += R.col(i).dot(moments.col(i));
  }
  omega /= std::abs(along) + 1e-9 * size;
  const double angle = omega.norm();
  if (angle < 1e-9 || !std::isfinite(angle)) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, omega / angle));
}

/// Turn all vertices at once by one step towards the rotation of the whole body.
void VertexRotations::turn_all(const Eigen::VectorXd& u) noexcept {
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < rest_.size(); ++i) middle += rest_[i] + u.segment<3>(dof(i));
  middle /= static_cast<double>(rest_.size());
  for (std::size_t i = 0; i < rest_.size(); ++i)
    moments.noalias() += (rest_[i] + u.segment<3>(dof(i)) - middle) * (rest_[i] - middle_).transpose();
  const Eigen::Quaterniond turned = nearer(whole_, moments, size_);
  const Eigen::Matrix3d step = turned.toRotationMatrix();
  whole_ = (turned * Eigen::Quaterniond(whole_)).normalized().toRotationMatrix();
  for (Eigen::Matrix3d& R : rotation_) R = step * R;
}

void VertexRotations::turn(std::size_t vertex, const Eigen::VectorXd& u) noexcept {
  const auto self = static_cast<std::size_t>(vertex_[vertex]);
  const auto own = u.segment<3>(dof(self));
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  double size = 0;
  for (std::size_t k = begin_[vertex]; k < begin_[vertex + 1]; ++k) {
    const auto other = static_cast<std::size_t>(neighbours_[k]);
    const Eigen::Vector3d edge = rest_[other] - rest_[self];
    moments.noalias() += (edge + u.segment<3>(dof(other)) - own) * edge.transpose();
    size += edge.squaredNorm();
  }
  Eigen::Matrix3d& R = rotation_[vertex];
  R = (nearer(R, moments, size) * Eigen::Quaterniond(R)).normalized().toRotationMatrix();
}

void VertexRotations::to_rest(const Eigen::VectorXd& in, Eigen::VectorXd& out) const noexcept {
  for (std::size_t i = 0; i < rotation_.size(); ++i)
    out.segment<3>(dof(i)) = (rotation_[i].transpose() * in.segment<3>(dof(i))).eval();
}

void VertexRotations::to_shape(const Eigen::VectorXd& in, Eigen::VectorXd& out) const noexcept {
  for (std::size_t i = 0; i < rotation_.size(); ++i) out.segment<3>(dof(i)) = (rotation_[i] * in.segment<3>(dof(i))).eval();
}

PrefactoredDirection::PrefactoredDirection(const FemModel& model)
    : rotations_(model), turning_(model.options().elasticity == Elasticity::corotated) {
  turned_.resize(static_cast<Eigen::Index>(model.free_dofs().size()));
  for (Pair& pair : pairs_) pair.s = pair.y = turned_;
}

tl::expected<std::unique_ptr<DescentDirection>, Diagnostic> PrefactoredDirection::create(FemModel& model, double c) {
  std::unique_ptr<PrefactoredDirection> made(new PrefactoredDirection(model));
  SystemMatrix matrix(model);
  const double alpha = model.options().mass_damping, beta = model.options().stiffness_damping;
  const SparseMatrix& A = matrix.assemble(Eigen::VectorXd::Zero(model.size()), (1 + c * alpha) / (c * c), 1 + beta / c);
  made->cholesky_.analyse(A);
  if (!made->cholesky_.factor(A)) return tl::unexpected(not_positive_definite());
  return made;
}

/// The two loops of L-BFGS, the first from the newest pair back, the second up to it, both in the frame of the rest shape.
tl::expected<int, Diagnostic> PrefactoredDirection::find(StageSystem& system, const Stage& /*stage*/, const Eigen::VectorXd& r,
                                                         Eigen::VectorXd& d) {
  if (turning_) rotations_.follow(system.ahead(), kParts);
  turned_ = -r;
  to_rest(turned_);
  for (std::size_t i = 0; i < kMemory; ++i) {
    Pair& pair = pairs_[(newest_ + kMemory - i) % kMemory];
    if (pair.inverse == 0) continue;
    pair.weight = pair.inverse * pair.s.dot(turned_);
    turned_ -= pair.weight * pair.y;
  }
  cholesky_.solve(turned_, turned_);
  for (std::size_t i = 0; i < kMemory; ++i) {
    const Pair& pair = pairs_[(newest_ + 1 + i) % kMemory];
    if (pair.inverse == 0) continue;
    turned_ += (pair.weight - pair.inverse * pair.y.dot(turned_)) * pair.s;
  }
  if (turning_) rotations_.to_shape(turned_, d);
  else d = turned_;
  return 1;
}

void PrefactoredDirection::moved(const Eigen::VectorXd& s, const Eigen::VectorXd& y) {
  const double along = s.dot(y);
  if (!(along > 1e-8 * s.norm() * y.norm())) return;
  newest_ = (newest_ + 1) % kMemory;
  Pair& pair = pairs_[newest_];
  pair.s = s;
  pair.y = y;
  to_rest(pair.s);
  to_rest(pair.y);
  pair.inverse = 1 / along;
}

void PrefactoredDirection::to_rest(Eigen::VectorXd& x) const {
  if (turning_) rotations_.to_rest(x, x);
}

void PrefactoredDirection::forget() {
  for (Pair& pair : pairs_) pair.inverse = 0;
}

}  // namespace tactus::sim
