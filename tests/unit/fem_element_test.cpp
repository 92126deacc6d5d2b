// SPDX-License-Identifier: Apache-2.0
/// Forces, energy and their derivatives: patch test, null space, finite differences, conservation, closed forms.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <cmath>
#include <vector>

#include <tactus/sim/fem/model.h>
#include <tactus/sim/random.h>
#include "tests/unit/fem_fixture.h"

namespace tactus::sim {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kCell = 0.01, kYoung = 1e4, kPoisson = 0.45;
constexpr double kMu = kYoung / (2 * (1 + kPoisson)), kLambda = kYoung * kPoisson / ((1 + kPoisson) * (1 - 2 * kPoisson));
constexpr double kForce = kYoung * kCell * kCell;  // what 100 % strain of a cell takes [N]: the scale of all tolerances

FemOptions free_options(Elasticity elasticity = Elasticity::corotated) {
  FemOptions options;
  options.materials = {{kYoung, kPoisson, 1e3}};
  options.elasticity = elasticity;
  return options;
}

/// 3 x 4 x 2 cells whose inner vertices, and those of the surface too, are a little out of place.
TetMesh crooked_block() {
  TetMesh mesh = make_slab(3, 4, 2, kCell);
  Random random(11);
  for (Vec3& x : mesh.vertices)
    x = x + Vec3{random.uniform(-1e-3, 1e-3), random.uniform(-1e-3, 1e-3), random.uniform(-1e-3, 1e-3)};
  return mesh;
}

double volume_of(const TetMesh& mesh) {
  double sum = 0;
  for (std::size_t i = 0; i < mesh.tets.size(); ++i) sum += volume(mesh, i);
  return sum;
}

Vector3d position(const TetMesh& mesh, std::size_t v) { return {mesh.vertices[v].x, mesh.vertices[v].y, mesh.vertices[v].z}; }

/// Displacements of x -> A x + b.
VectorXd affine(const TetMesh& mesh, const Matrix3d& a, const Vector3d& b = Vector3d::Zero()) {
  VectorXd u(3 * static_cast<Eigen::Index>(mesh.vertices.size()));
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    u.segment<3>(3 * static_cast<Eigen::Index>(v)) = a * position(mesh, v) + b - position(mesh, v);
  return u;
}

VectorXd random_vector(Eigen::Index n, double size, std::uint64_t seed) {
  Random random(seed);
  return VectorXd::NullaryExpr(n, [&] { return random.uniform(-size, size); });
}

VectorXd forces(FemModel& model, const VectorXd& u) {
  VectorXd k;
  model.internal_forces(u, k);
  return k;
}

MatrixXd dense_stiffness(FemModel& model, const VectorXd& u) {
  SparseMatrix K;
  model.stiffness(u, K);
  return K;
}

MatrixXd dense_tangent(FemModel& model, const VectorXd& u) {
  SparseMatrix K;
  model.tangent(u, K);
  return K;
}

const Matrix3d kStrange = (Matrix3d() << 1.3, -0.4, 0.2, 0.5, 0.8, -0.3, 0.1, 0.6, 1.1).finished();

std::vector<std::uint32_t> border(const TetMesh& mesh) { return surface(mesh).vertex; }

TEST(FemElements, PatchOfConstantStrainIsInEquilibrium) {
  for (const Elasticity elasticity : {Elasticity::corotated, Elasticity::linear}) {
    const TetMesh mesh = crooked_block();
    FemOptions options = free_options(elasticity);
    options.fixed = border(mesh);
    FemModel model = testing::make_model(mesh, options);
    ASSERT_FALSE(model.free_dofs().empty());
    EXPECT_LT(forces(model, affine(mesh, kStrange, {1, 2, 3})).norm(), 1e-10 * kForce);
  }
}

TEST(FemElements, InnerVerticesFollowAnAffineBorder) {
  const TetMesh mesh = crooked_block();
  FemOptions options = free_options(Elasticity::linear);
  options.fixed = border(mesh);
  FemModel model = testing::make_model(mesh, options);
  const VectorXd exact = affine(mesh, kStrange, {0.01, 0.02, 0.03});
  VectorXd u = exact;
  for (const int dof : model.free_dofs()) u[dof] = 0;

  SparseMatrix K;
  model.stiffness(u, K);
  const VectorXd k = forces(model, u);
  const VectorXd residual =
      -VectorXd::NullaryExpr(K.rows(), [&](Eigen::Index i) { return k[model.free_dofs()[static_cast<std::size_t>(i)]]; });
  const VectorXd inner = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(K).solve(residual);
  for (Eigen::Index i = 0; i < inner.size(); ++i) u[model.free_dofs()[static_cast<std::size_t>(i)]] = inner[i];
  EXPECT_LT((u - exact).norm(), 1e-10 * exact.norm());
}

TEST(FemElements, StiffnessKnowsSixMotionsWithoutForceAndNoOther) {
  const TetMesh mesh = crooked_block();
  FemModel model = testing::make_model(mesh, free_options());
  const MatrixXd K = dense_stiffness(model, model.rest().u);
  EXPECT_LT((K - K.transpose()).norm(), 1e-14 * K.norm());
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d n = Vector3d::Unit(axis);
    const VectorXd moved = affine(mesh, Matrix3d::Identity(), n);
    Matrix3d spin;
    spin << 0, -n.z(), n.y(), n.z(), 0, -n.x(), -n.y(), n.x(), 0;
    const VectorXd turned = affine(mesh, Matrix3d::Identity() + spin);
    EXPECT_LT((K * moved).norm(), 1e-10 * K.norm() * moved.norm());
    EXPECT_LT((K * turned).norm(), 1e-10 * K.norm() * turned.norm());
  }
  const VectorXd eigenvalues = Eigen::SelfAdjointEigenSolver<MatrixXd>(K).eigenvalues();
  EXPECT_LT(std::abs(eigenvalues[0]), 1e-10 * eigenvalues.maxCoeff());
  EXPECT_LT(eigenvalues[5], 1e-10 * eigenvalues.maxCoeff());
  EXPECT_GT(eigenvalues[6], 1e-4 * eigenvalues.maxCoeff());
}

TEST(FemElements, NoForceAtRestNorAfterAnyRigidMotion) {
  const TetMesh mesh = crooked_block();
  FemModel model = testing::make_model(mesh, free_options());
  EXPECT_EQ(forces(model, model.rest().u).cwiseAbs().maxCoeff(), 0);
  EXPECT_EQ(model.energy(model.rest().u), 0);
  Random random(2);
  for (int i = 0; i < 100; ++i) {
    const Vector3d axis = Vector3d::NullaryExpr([&] { return random.uniform(-1, 1); }).normalized();
    const double angle = i < 10 ? M_PI : random.uniform(-M_PI, M_PI);
    const VectorXd u = affine(mesh, Eigen::AngleAxisd(angle, axis).toRotationMatrix(), 0.1 * axis);
    EXPECT_LT(forces(model, u).norm(), 1e-10 * kForce);
    EXPECT_LT(model.energy(u), 1e-20 * kForce * kCell);
  }
}

/// States from small strain to half of the elements inside out.
std::vector<VectorXd> states(const TetMesh& mesh) {
  const auto n = 3 * static_cast<Eigen::Index>(mesh.vertices.size());
  std::vector<VectorXd> out;
  for (const double size : {0.01, 0.1, 0.5, 1.0})
    out.push_back(affine(mesh, kStrange) + random_vector(n, size * kCell, static_cast<std::uint64_t>(100 * size)));
  return out;
}

TEST(FemElements, ForceIsTheGradientOfTheEnergy) {
  for (const Elasticity elasticity : {Elasticity::corotated, Elasticity::linear}) {
    const TetMesh mesh = crooked_block();
    FemModel model = testing::make_model(mesh, free_options(elasticity));
    for (const VectorXd& u : states(mesh)) {
      for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        const VectorXd d = random_vector(u.size(), kCell, seed);
        const double e = 1e-6, rise = (model.energy(u + e * d) - model.energy(u - e * d)) / (2 * e);
        const VectorXd k = forces(model, u);
        EXPECT_NEAR(rise, k.dot(d), 1e-8 * k.norm() * d.norm());
      }
    }
  }
}

TEST(FemElements, LinearForcesAreStiffnessTimesDisplacement) {
  const TetMesh mesh = crooked_block();
  FemModel model = testing::make_model(mesh, free_options(Elasticity::linear));
  const MatrixXd K = dense_stiffness(model, model.rest().u);
  for (const VectorXd& u : states(mesh)) {
    EXPECT_LT((forces(model, u) - K * u).norm(), 1e-13 * K.norm() * u.norm());
    EXPECT_EQ(dense_stiffness(model, u), K);
    EXPECT_EQ(dense_tangent(model, u), K);
  }
}

TEST(FemElements, WarpedStiffnessIsThatOfTheTurnedBody) {
  const TetMesh mesh = crooked_block();
  FemModel model = testing::make_model(mesh, free_options());
  const MatrixXd K = dense_stiffness(model, model.rest().u);
  const Matrix3d r = Eigen::AngleAxisd(1.1, Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  MatrixXd turn = MatrixXd::Zero(K.rows(), K.cols());
  for (Eigen::Index i = 0; i < K.rows(); i += 3) turn.block<3, 3>(i, i) = r;
  EXPECT_LT((dense_stiffness(model, affine(mesh, r)) - turn * K * turn.transpose()).norm(), 1e-12 * K.norm());
}

// Where nothing is compressed the exact tangent is positive semidefinite and is not clamped.
TEST(FemElements, TangentIsTheDerivativeOfTheForces) {
  const TetMesh mesh = crooked_block();
  FemModel model = testing::make_model(mesh, free_options());
  const Matrix3d r = Eigen::AngleAxisd(0.8, Vector3d(1, -2, 2).normalized()).toRotationMatrix();
  const VectorXd u = affine(mesh, r * Vector3d(1.3, 1.2, 1.4).asDiagonal()) +
                     random_vector(3 * static_cast<Eigen::Index>(mesh.vertices.size()), 0.02 * kCell, 5);
  const MatrixXd T = dense_tangent(model, u);
  EXPECT_LT((T - T.transpose()).norm(), 1e-14 * T.norm());
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const VectorXd d = random_vector(u.size(), kCell, seed);
    const double e = 1e-5;
    const VectorXd slope = (forces(model, u + e * d) - forces(model, u - e * d)) / (2 * e);
    EXPECT_LT((T * d - slope).norm(), 1e-8 * slope.norm());
    EXPECT_GT((dense_stiffness(model, u) * d - slope).norm(), 1e-3 * slope.norm());  // what the rotations' derivative adds
  }
}

TEST(FemElements, TangentIsPositiveSemidefiniteInEveryState) {
  const TetMesh mesh = crooked_block();
  FemModel model = testing::make_model(mesh, free_options());
  std::vector<VectorXd> all = states(mesh);
  for (const Vector3d& d : {Vector3d(1, 1, 0.5), Vector3d(0.5, 0.5, 0.5), Vector3d(1, 1, 0), Vector3d(1, 0, 0), Vector3d(0, 0, 0),
                            Vector3d(1, 1, -1), Vector3d(-1, -1, -1), Vector3d(3, 3, -2.99), Vector3d(9, 0, 0)})
    all.push_back(affine(mesh, d.asDiagonal()));
  for (const VectorXd& u : all) {
    for (const MatrixXd& T : {dense_tangent(model, u), dense_stiffness(model, u)}) {
      ASSERT_TRUE(T.allFinite());
      const VectorXd eigenvalues = Eigen::SelfAdjointEigenSolver<MatrixXd>(T).eigenvalues();
      EXPECT_GT(eigenvalues[0], -1e-12 * eigenvalues.maxCoeff());
    }
  }
}

// Newton's third law; moments vanish about the deformed positions when warped, about the rest positions when linear.
TEST(FemElements, ForcesHaveNoSumAndNoMoment) {
  for (const Elasticity elasticity : {Elasticity::corotated, Elasticity::linear}) {
    const TetMesh mesh = crooked_block();
    FemModel model = testing::make_model(mesh, free_options(elasticity));
    for (const VectorXd& u : states(mesh)) {
      const VectorXd k = forces(model, u);
      Vector3d sum = Vector3d::Zero(), moment = Vector3d::Zero();
      for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        const auto dof = 3 * static_cast<Eigen::Index>(v);
        Vector3d at = position(mesh, v);
        if (elasticity == Elasticity::corotated) at += u.segment<3>(dof);
        sum += k.segment<3>(dof);
        moment += at.cross(k.segment<3>(dof));
      }
      EXPECT_LT(sum.norm(), 1e-13 * k.norm());
      EXPECT_LT(moment.norm(), 1e-12 * kCell * k.norm());
    }
  }
}

// Inside out the nearest rotation turns the smallest singular value negative: W = V (mu |S - I|^2 + lambda/2 tr(S - I)^2).
TEST(FemElements, EnergyOfUniformStatesInClosedForm) {
  const TetMesh mesh = crooked_block();
  FemModel model = testing::make_model(mesh, free_options());
  const double v = volume_of(mesh);
  struct Row {
    Vector3d stretch, signed_stretch;
  };
  for (const Row& row : {Row{{1.5, 1.5, 1.5}, {1.5, 1.5, 1.5}}, Row{{1.2, 0.7, 1}, {1.2, 0.7, 1}}, Row{{1, 1, 0}, {1, 1, 0}},
                         Row{{0, 1.5, 0}, {1.5, 0, 0}}, Row{{0, 0, 0}, {0, 0, 0}}, Row{{-1, 1, 1}, {1, 1, -1}},
                         Row{{-1, -1, -1}, {1, 1, -1}}, Row{{1, -0.5, 1}, {1, 1, -0.5}}, Row{{-1, -1, 1}, {1, 1, 1}}}) {
    const VectorXd u = affine(mesh, row.stretch.asDiagonal());
    const Vector3d e = row.signed_stretch - Vector3d::Ones();
    const double expected = v * (kMu * e.squaredNorm() + kLambda / 2 * e.sum() * e.sum());
    EXPECT_NEAR(model.energy(u), expected, 1e-12 * v * kLambda) << row.stretch.transpose();
    EXPECT_TRUE(forces(model, u).allFinite());
  }
}

// sigma = E eps along x, nothing across: Hooke.
TEST(FemElements, PulledBlockFollowsHooke) {
  const TetMesh mesh = make_slab(2, 3, 4, kCell);
  FemModel model = testing::make_model(mesh, free_options());
  for (const double strain : {-0.3, -1e-3, 1e-3, 0.3}) {
    const VectorXd k =
        forces(model, affine(mesh, Vector3d(1 + strain, 1 - kPoisson * strain, 1 - kPoisson * strain).asDiagonal()));
    Vector3d end = Vector3d::Zero(), side = Vector3d::Zero();
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      const auto dof = 3 * static_cast<Eigen::Index>(v);
      if (mesh.vertices[v].x > 1.5 * kCell) end += k.segment<3>(dof);
      if (mesh.vertices[v].y > 2.5 * kCell) side += k.segment<3>(dof);
    }
    const double expected = kYoung * strain * (3 * kCell) * (4 * kCell);
    EXPECT_NEAR(end.x(), expected, 1e-11 * kForce);
    EXPECT_NEAR(side.y(), 0, 1e-11 * kForce);
  }
}

TEST(FemElements, EachTetrahedronHasItsMaterial) {
  const TetMesh mesh = crooked_block();
  const Material soft{1e3, 0.3, 1e3}, hard{1e6, 0.45, 2e3};
  const auto with = [&](auto&& material) {
    FemOptions options = free_options();
    options.materials.clear();
    for (std::size_t i = 0; i < mesh.tets.size(); ++i) options.materials.push_back(material(i));
    return testing::make_model(mesh, options);
  };
  FemModel mixed = with([&](std::size_t i) { return i % 3 == 0 ? soft : hard; });
  FemModel other = with([&](std::size_t i) { return i % 3 == 0 ? hard : soft; });
  FemModel all_soft = with([&](std::size_t) { return soft; });
  FemModel all_hard = with([&](std::size_t) { return hard; });
  const VectorXd u = states(mesh)[1];
  const VectorXd sum = forces(all_soft, u) + forces(all_hard, u);
  EXPECT_LT((forces(mixed, u) + forces(other, u) - sum).norm(), 1e-13 * sum.norm());
  EXPECT_GT((forces(mixed, u) - forces(other, u)).norm(), 1e-3 * sum.norm());
  EXPECT_NEAR(mixed.total_mass() + other.total_mass(), 3e3 * volume_of(mesh), 1e-12);
}

}  // namespace
}  // namespace tactus::sim
