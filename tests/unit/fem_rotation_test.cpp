// SPDX-License-Identifier: Apache-2.0
/// The best rotation of any matrix, from the robust method and from the vector kernel, against Eigen's singular values.
#include <tactus/sim/fem/rotation.h>

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include <algorithm>
#include <cmath>
#include <vector>

#include <tactus/sim/fem/element.h>
#include <tactus/sim/random.h>
#include "tests/unit/fem_fixture.h"

namespace tactus::sim {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr std::size_t kMatrices = 20000;

Matrix3d eigen(const Matrix3& m) { return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(&m.m[0][0]); }

Matrix3 matrix3(const Matrix3d& m) {
  Matrix3 out;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) out.m[i][j] = m(i, j);
  return out;
}

Matrix3d random_matrix(Random& random, double size = 1) {
  return size * Matrix3d::NullaryExpr([&] { return random.uniform(-1, 1); });
}

Quat random_rotation(Random& random) {
  Eigen::Vector4d q;
  do {
    q = Eigen::Vector4d::NullaryExpr([&] { return random.uniform(-1, 1); });
  } while (q.norm() > 1 || q.norm() < 0.1);
  q.normalize();
  return {q[0], q[1], q[2], q[3]};
}

/// Every fourth nearly rigid, every fourth inverted, every fourth flat, the rest anything.
std::vector<Matrix3d> matrices() {
  Random random(7);
  std::vector<Matrix3d> out;
  for (std::size_t i = 0; i < kMatrices; ++i) {
    const Matrix3d r = eigen(to_matrix(random_rotation(random)));
    Matrix3d f = random_matrix(random);
    if (i % 4 == 0) f = r * (Matrix3d::Identity() + 0.1 * f);
    if (i % 4 == 1 && f.determinant() > 0) f = -f;
    if (i % 4 == 2) f = r * Vector3d(1, random.uniform(0, 1), 0).asDiagonal() * f;
    out.push_back(f);
  }
  return out;
}

struct Best {
  Vector3d sigma;  // the smallest with the sign of the determinant
  double trace() const { return sigma.sum(); }
};

Best best(const Matrix3d& f) {
  const Eigen::JacobiSVD<Matrix3d> svd(f);
  Vector3d sigma = svd.singularValues();
  if (f.determinant() < 0) sigma[2] = -sigma[2];
  return {sigma};
}

void expect_best_rotation(const Matrix3d& f, const Quat& q, double tolerance) {
  const Matrix3d r = eigen(to_matrix(q));
  EXPECT_LT((r.transpose() * r - Matrix3d::Identity()).norm(), 1e-14);
  EXPECT_NEAR(r.determinant(), 1, 1e-14);
  EXPECT_GE((r.transpose() * f).trace(), best(f).trace() - tolerance * f.norm());
}

TEST(Rotation, IsTheBestOneOfAnyMatrix) {
  Random random(1);
  for (const Matrix3d& f : matrices()) expect_best_rotation(f, nearest_rotation(matrix3(f), random_rotation(random)), 1e-14);
}

TEST(Rotation, HasNoUnit) {
  for (const Matrix3d& f : matrices()) {
    const Quat q = nearest_rotation(matrix3(f), {});
    const Best b = best(f);
    if (b.sigma[1] + b.sigma[2] < 1e-3 * b.sigma[0]) continue;  // nearly many answers: rounding decides
    for (const double scale : {1e-6, 1e6, 1e-200, 1e200})
      EXPECT_LT(angle_between(nearest_rotation(matrix3(scale * f), {}), q), 1e-11);
  }
}

// A curve through inverted and flat states turns as slowly as F changes, wherever the best rotation is unique.
TEST(Rotation, ChangesContinuouslyAcrossInversion) {
  Random random(3);
  int crossed = 0;
  for (int curve = 0; curve < 100; ++curve) {
    const Matrix3d turn = eigen(to_matrix(random_rotation(random))), noise = 0.1 * random_matrix(random);
    Quat before = nearest_rotation(matrix3(turn * (Matrix3d(Vector3d(1, 0.8, 0.5).asDiagonal()) + noise)), {});
    double sign = 1;
    for (int i = 0; i <= 1000; ++i) {
      const Matrix3d f = turn * (Matrix3d(Vector3d(1, 0.8, 0.5 - 1e-3 * i).asDiagonal()) + noise);
      const Quat now = nearest_rotation(matrix3(f), before);
      const Vector3d sigma = best(f).sigma;
      EXPECT_LT(angle_between(now, before), 3e-3 / (sigma[1] + sigma[2]));
      crossed += static_cast<int>(sign * sigma[2] < 0);
      sign = sigma[2];
      before = now;
    }
  }
  EXPECT_GE(crossed, 100);
}

TEST(Rotation, StaysAtTheStartWhereAllAreEquallyGood) {
  Random random(5);
  for (int i = 0; i < 1000; ++i) {
    const Quat start = random_rotation(random);
    EXPECT_LT(angle_between(nearest_rotation({}, start), start), 1e-14);
    // A line: best is what takes its source direction a to its image b; of those, the one closest to the start.
    const Vector3d a = random_matrix(random).col(0), b = random_matrix(random).col(0);
    const Matrix3d f = b * a.transpose();
    const Quat q = nearest_rotation(matrix3(f), start);
    expect_best_rotation(f, q, 1e-14);
    const Matrix3d r = eigen(to_matrix(start));
    const Vector3d carried = r * a.normalized();
    const double apart = std::atan2(carried.cross(b.normalized()).norm(), carried.dot(b.normalized()));
    EXPECT_NEAR(angle_between(q, start), apart, 1e-7);
  }
}

TEST(Rotation, OfWhatIsNotFiniteIsTheStart) {
  const Quat start{0.5, 0.5, 0.5, 0.5};
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL, 1e308, 1e-308}) {
    Matrix3 f;
    f.m[1][2] = bad;
    f.m[2][0] = bad;
    EXPECT_EQ(nearest_rotation(f, start), start);
  }
}

/// One tetrahedron for each matrix, apart from the others, and displacements that give it this deformation.
struct Scattered {
  TetMesh mesh;
  Eigen::VectorXd u;
};

Scattered scatter(const std::vector<Matrix3d>& gradients) {
  Scattered out;
  out.u.resize(12 * static_cast<Eigen::Index>(gradients.size()));
  for (std::size_t i = 0; i < gradients.size(); ++i) {
    const auto first = static_cast<std::uint32_t>(4 * i);
    out.mesh.tets.push_back({first, first + 1, first + 2, first + 3});
    for (const Vec3& x : {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
      const auto dof = 3 * static_cast<Eigen::Index>(out.mesh.vertices.size());
      const Vector3d rest(x.x, x.y, x.z);
      out.u.segment<3>(dof) = gradients[i] * rest - rest;
      out.mesh.vertices.push_back(x);
    }
  }
  return out;
}

TEST(ElementRotation, IsTheBestOneFromAColdAndFromAWarmStart) {
  std::vector<Matrix3d> f = matrices();
  const Scattered cold = scatter(f);
  Elements elements(cold.mesh, std::vector<Lame>(f.size(), {1, 1}), true);
  elements.turn(cold.u.data());
  for (std::size_t i = 0; i < f.size(); ++i) expect_best_rotation(f[i], elements.rotation(i), 1e-13);

  Random random(9);
  for (Matrix3d& m : f) m += 1e-3 * random_matrix(random);
  elements.turn(scatter(f).u.data());
  for (std::size_t i = 0; i < f.size(); ++i) expect_best_rotation(f[i], elements.rotation(i), 1e-13);
}

// Warm and cold agree far better than a trace, which is flat at its maximum, would show.
TEST(ElementRotation, IsTheOneOfTheRobustMethodToTheLastDigits) {
  std::vector<Matrix3d> f = matrices();
  std::erase_if(f, [](const Matrix3d& m) {
    const Vector3d sigma = best(m).sigma;
    return sigma[1] + sigma[2] < 0.1 * sigma[0];
  });
  EXPECT_GT(f.size(), kMatrices / 2);
  const Scattered end = scatter(f);
  Elements elements(end.mesh, std::vector<Lame>(f.size(), {1, 1}), true);
  for (const double part : {0.0, 0.9, 0.99, 0.999, 1.0}) elements.turn((part * end.u).eval().data());
  for (std::size_t i = 0; i < f.size(); ++i)
    EXPECT_LT(angle_between(elements.rotation(i), nearest_rotation(matrix3(f[i]), {})), 2e-12);
}

// A half turn away everything is stationary: no slope is seen, and a curvature that rounding gives either sign.
TEST(ElementRotation, LeavesTheSaddlesOfHalfTurns) {
  Random random(6);
  std::vector<Matrix3d> f;
  for (int i = 0; i < 3000; ++i) {
    const Vector3d axis = i % 2 == 0 ? Vector3d(Vector3d::Unit(i % 3)) : Vector3d(random_matrix(random).col(0).normalized());
    const Matrix3d half_turn = 2 * axis * axis.transpose() - Matrix3d::Identity();
    const Vector3d stretch = i % 4 < 2 ? Vector3d(1, 1, 1) : Vector3d(1.5, 1, 0.5);
    f.emplace_back(half_turn * (stretch + 1e-15 * random_matrix(random).col(0)).asDiagonal());
  }
  const Scattered turned = scatter(f);
  Elements elements(turned.mesh, std::vector<Lame>(f.size(), {1, 1}), true);
  elements.turn(turned.u.data());
  for (std::size_t i = 0; i < f.size(); ++i) expect_best_rotation(f[i], elements.rotation(i), 1e-14);
}

// What rests changes no bit: the sleep of bodies builds on it.
TEST(ElementRotation, IsNotTouchedByASecondLookAtTheSameShape) {
  std::vector<Matrix3d> f = matrices();
  std::erase_if(f, [](const Matrix3d& m) { return best(m).sigma[1] + best(m).sigma[2] < 0.1 * best(m).sigma[0]; });
  const Scattered shape = scatter(f);
  Elements elements(shape.mesh, std::vector<Lame>(f.size(), {3e3, 3e4}), true);
  Eigen::VectorXd first(shape.u.size()), again(first);
  elements.forces(shape.u.data(), again.data());
  elements.forces(shape.u.data(), first.data());
  for (int i = 0; i < 100; ++i) {
    elements.forces(shape.u.data(), again.data());
    ASSERT_TRUE(again == first) << i;
  }
}

// However often an element is turned, its remembered quaternion stays a rotation.
TEST(ElementRotation, DoesNotDriftInAMillionSteps) {
  Elements elements(scatter({Matrix3d::Identity()}).mesh, std::vector<Lame>(1, {1, 1}), true);
  const std::vector<Matrix3d> f = [] {
    std::vector<Matrix3d> out;
    for (int i = 0; i < 1000; ++i)
      out.emplace_back(Eigen::AngleAxisd(2 * M_PI * i / 1000, Vector3d(1, 2, 3).normalized()) *
                       Vector3d(1.2, 0.9, 1.1).asDiagonal());
    return out;
  }();
  std::vector<Eigen::VectorXd> u;
  for (const Matrix3d& m : f) u.push_back(scatter({m}).u);
  for (int turn = 0; turn < 1000; ++turn)
    for (const Eigen::VectorXd& x : u) elements.turn(x.data());
  expect_best_rotation(f.back(), elements.rotation(0), 1e-14);
}

TEST(ElementKernels, ForcesDoNotDependOnHowElementsFillBlocks) {
  for (const std::uint32_t cells : {1U, 2U, 3U, 7U}) {  // 6, 12, 18 and 42 tetrahedra for blocks of 16
    const TetMesh slab = make_slab(cells, 1, 1, 0.01);
    Random random(8);
    Eigen::VectorXd u = Eigen::VectorXd::NullaryExpr(3 * static_cast<Eigen::Index>(slab.vertices.size()),
                                                     [&] { return random.uniform(-0.002, 0.002); });
    Elements whole(slab, std::vector<Lame>(slab.tets.size(), {3e3, 3e4}), true);
    Eigen::VectorXd k(u.size()), sum = Eigen::VectorXd::Zero(u.size()), part(u.size());
    whole.forces(u.data(), k.data());
    double energy = 0;
    for (const Tet& tet : slab.tets) {
      const TetMesh alone{slab.vertices, {tet}};
      Elements one(alone, std::vector<Lame>(1, {3e3, 3e4}), true);
      one.forces(u.data(), part.data());
      sum += part;
      energy += one.energy(u.data());
      EXPECT_EQ(one.corners(0)[3], 3 * tet[3]);
    }
    EXPECT_LT((k - sum).norm(), 1e-14 * k.norm()) << cells;
    EXPECT_NEAR(whole.energy(u.data()), energy, 1e-14 * energy);
    for (std::size_t i = 0; i < slab.tets.size(); ++i) EXPECT_EQ(whole.corners(i)[2], 3 * slab.tets[i][2]);
  }
}

TEST(ElementKernels, AllInstructionSetsYieldTheSameBits) {
  const Scattered strange = scatter(matrices());
  const TetMesh slab = make_slab(5, 7, 3, 0.01);  // 630 tetrahedra: some blocks are not full
  Random random(4);
  const Eigen::VectorXd wild = Eigen::VectorXd::NullaryExpr(3 * static_cast<Eigen::Index>(slab.vertices.size()),
                                                            [&] { return random.uniform(-0.004, 0.004); });
  struct Case {
    const TetMesh& mesh;
    const Eigen::VectorXd& u;
  };
  for (const Case& c : {Case{strange.mesh, strange.u}, Case{slab, wild}}) {
    for (const bool corotated : {true, false}) {
      const std::vector<Lame> moduli(c.mesh.tets.size(), {3e3, 3e4});
      const auto run = [&](InstructionSet set) {
        Elements elements(c.mesh, moduli, corotated);
        elements.use(set);
        std::vector<double> out;
        for (const double part : {0.5, 0.51, 1.0}) {
          const Eigen::VectorXd u = part * c.u;
          Eigen::VectorXd k(u.size());
          elements.forces(u.data(), k.data());
          out.insert(out.end(), k.begin(), k.end());
          out.push_back(elements.energy(u.data()));
        }
        return out;
      };
      const std::vector<double> expected = run(InstructionSet::portable);
      EXPECT_TRUE(std::all_of(expected.begin(), expected.end(), [](double x) { return std::isfinite(x); }));
      for (const InstructionSet set : {InstructionSet::avx2, InstructionSet::avx512}) {
        if (!supported(set)) continue;
        EXPECT_EQ(run(set), expected) << "instruction set " << static_cast<int>(set);
      }
    }
  }
}

TEST(ElementKernels, WatchStatesOfAnyLengthAlikeAndMissNothing) {
  Random random(3);
  const auto numbers = [&](std::size_t n) {
    std::vector<double> out(n);
    for (double& x : out) x = random.uniform(-1, 1);
    return out;
  };
  for (const std::size_t n : std::initializer_list<std::size_t>{0, 1, 3, 7, 8, 9, 15, 24, 30, 2142}) {
    const std::vector<double> f = numbers(n), u0 = numbers(n), u1 = numbers(n), v1 = numbers(n);
    const Motion expected = [&] {
      std::vector<double> u(n), v(n);
      return kernels(InstructionSet::portable).motion(f.data(), u0.data(), u1.data(), v1.data(), u.data(), v.data(), n);
    }();
    double work = 0, farthest = 0;
    for (std::size_t i = 0; i < n; ++i) {
      work += f[i] * (u1[i] - u0[i]);
      farthest = std::max(farthest, std::abs(u1[i] - u0[i]));
    }
    EXPECT_NEAR(expected.work, work, 1e-12);
    EXPECT_EQ(expected.farthest, farthest);
    for (const InstructionSet set : {InstructionSet::portable, InstructionSet::avx2, InstructionSet::avx512}) {
      if (!supported(set)) continue;
      std::vector<double> u(n), v(n);
      const Motion motion = kernels(set).motion(f.data(), u0.data(), u1.data(), v1.data(), u.data(), v.data(), n);
      EXPECT_EQ(motion.work, expected.work);
      EXPECT_EQ(motion.farthest, expected.farthest);
      EXPECT_TRUE(motion.finite && u == u1 && v == v1);
      EXPECT_TRUE(kernels(set).finite(f.data(), n));
      for (std::size_t i = 0; i < std::min<std::size_t>(n, 40); ++i) {
        for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
          std::vector<double> broken = u1;
          broken[i] = bad;
          EXPECT_FALSE(kernels(set).finite(broken.data(), n));
          EXPECT_FALSE(kernels(set).motion(f.data(), u0.data(), broken.data(), v1.data(), u.data(), v.data(), n).finite);
          EXPECT_FALSE(kernels(set).motion(f.data(), u0.data(), u1.data(), broken.data(), u.data(), v.data(), n).finite);
        }
      }
    }
  }
}

}  // namespace
}  // namespace tactus::sim
