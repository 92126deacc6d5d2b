// SPDX-License-Identifier: Apache-2.0
// What the mesh gets wrong shrinks as theory says: a manufactured solution on a cube, and a beam against Timoshenko's formula.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <Eigen/IterativeLinearSolvers>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>

#include "lab/study/precision_space.h"
#include "lab/study/quadratic_tets.h"

namespace tactus::sim {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr Material kMaterial{.young = 1e4, .poisson = 0.3, .density = 1000};

/// u_i = a_i sin(pi x) sin(pi y) sin(pi z): zero on the surface of the unit cube, where every vertex is fixed.
struct Manufactured {
  Eigen::Vector3d a{1e-3, -2e-3, 5e-4};

  Eigen::Vector3d displacement(const Eigen::Vector3d& p) const {
    return a * std::sin(kPi * p.x()) * std::sin(kPi * p.y()) * std::sin(kPi * p.z());
  }
  /// Row i: gradient of u_i.
  Eigen::Matrix3d gradient(const Eigen::Vector3d& p) const {
    const Eigen::Array3d s = (kPi * p.array()).sin(), c = (kPi * p.array()).cos();
    const Eigen::RowVector3d d{c[0] * s[1] * s[2], s[0] * c[1] * s[2], s[0] * s[1] * c[2]};
    return kPi * a * d;
  }
  /// b = -mu laplace(u) - (lambda + mu) grad(div u)
  Eigen::Vector3d body_force(const Eigen::Vector3d& p) const {
    const double mu = kMaterial.young / (2 * (1 + kMaterial.poisson));
    const double lambda = 2 * mu * kMaterial.poisson / (1 - 2 * kMaterial.poisson);
    const Eigen::Array3d s = (kPi * p.array()).sin(), c = (kPi * p.array()).cos();
    Eigen::Matrix3d second;                                                 // of sin sin sin, over pi^2
    second << -s[0] * s[1] * s[2], c[0] * c[1] * s[2], c[0] * s[1] * c[2],  //
        c[0] * c[1] * s[2], -s[0] * s[1] * s[2], s[0] * c[1] * c[2],        //
        c[0] * s[1] * c[2], s[0] * c[1] * c[2], -s[0] * s[1] * s[2];
    return 3 * kPi * kPi * mu * displacement(p) - kPi * kPi * (lambda + mu) * second * a;
  }
};

/// Points and weights on the reference tetrahedron, sum 1/6, exact for polynomials of degree 5: Gauss-Legendre in collapsed
/// coordinates.
struct QuadraturePoint {
  std::array<double, 4> barycentric;
  double weight;
};
std::vector<QuadraturePoint> quadrature() {
  const double inner = std::sqrt(3.0 / 7 - 2.0 / 7 * std::sqrt(1.2)), outer = std::sqrt(3.0 / 7 + 2.0 / 7 * std::sqrt(1.2));
  const std::array<double, 4> nodes{-outer, -inner, inner, outer};
  const double large = (18 + std::sqrt(30.0)) / 72, small = (18 - std::sqrt(30.0)) / 72;
  const std::array<double, 4> weights{small, large, large, small};
  std::vector<QuadraturePoint> out;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) {
      for (std::size_t k = 0; k < 4; ++k) {
        const double a = (1 + nodes[i]) / 2, b = (1 + nodes[j]) / 2, c = (1 + nodes[k]) / 2;
        const double x = a, y = b * (1 - a), z = c * (1 - a) * (1 - b);
        out.push_back({{1 - x - y - z, x, y, z}, weights[i] * weights[j] * weights[k] * (1 - a) * (1 - a) * (1 - b)});
      }
    }
  }
  return out;
}

Eigen::Vector3d at(const TetMesh& mesh, std::uint32_t vertex) {
  const Vec3& p = mesh.vertices[vertex];
  return {p.x, p.y, p.z};
}

/// Calls visit(tet, point, barycentric coordinates, volume weight) at every quadrature point.
template <class Visit>
void integrate(const TetMesh& mesh, Visit&& visit) {
  const auto rule = quadrature();
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    for (const QuadraturePoint& q : rule) {
      Eigen::Vector3d p = Eigen::Vector3d::Zero();
      for (std::size_t i = 0; i < 4; ++i) p += q.barycentric[i] * at(mesh, mesh.tets[e][i]);
      visit(mesh.tets[e], p, q.barycentric, 6 * volume(mesh, e) * q.weight);
    }
  }
}

/// Gradient of the displacement in a tetrahedron, constant there.
Eigen::Matrix3d gradient(const TetMesh& mesh, const Tet& tet, const Eigen::VectorXd& u) {
  Eigen::Matrix3d edges, moves;
  for (int i = 0; i < 3; ++i) {
    const std::uint32_t v = tet[static_cast<std::size_t>(i) + 1];
    edges.col(i) = at(mesh, v) - at(mesh, tet[0]);
    moves.col(i) = u.segment<3>(3 * Eigen::Index{v}) - u.segment<3>(3 * Eigen::Index{tet[0]});
  }
  return moves * edges.inverse();
}

struct FieldError {
  double l2 = 0, h1 = 0;  ///< relative; h1: of the gradient alone
};

FieldError manufactured_error(std::uint32_t cells) {
  const Manufactured exact;
  const TetMesh mesh = make_slab(cells, cells, cells, 1.0 / cells);
  FemOptions options{.materials = {kMaterial}, .fixed = surface(mesh).vertex, .elasticity = Elasticity::linear};
  auto model = FemModel::create(mesh, options);
  EXPECT_TRUE(model);

  Eigen::VectorXd f = Eigen::VectorXd::Zero(model->size()), u = f;
  integrate(mesh, [&](const Tet& tet, const Eigen::Vector3d& p, const std::array<double, 4>& barycentric, double weight) {
    const Eigen::Vector3d b = exact.body_force(p);
    for (std::size_t i = 0; i < 4; ++i) f.segment<3>(3 * Eigen::Index{tet[i]}) += weight * barycentric[i] * b;
  });
  SparseMatrix stiffness;
  model->stiffness(u, stiffness);
  const auto free = model->free_dofs();
  Eigen::VectorXd right(static_cast<Eigen::Index>(free.size()));
  for (std::size_t i = 0; i < free.size(); ++i) right[static_cast<Eigen::Index>(i)] = f[free[i]];
  Eigen::ConjugateGradient<SparseMatrix, Eigen::Lower | Eigen::Upper> solver(stiffness);
  solver.setTolerance(1e-12);
  const Eigen::VectorXd solution = solver.solve(right);
  for (std::size_t i = 0; i < free.size(); ++i) u[free[i]] = solution[static_cast<Eigen::Index>(i)];

  FieldError error;
  double size = 0, slope = 0;
  integrate(mesh, [&](const Tet& tet, const Eigen::Vector3d& p, const std::array<double, 4>& barycentric, double weight) {
    Eigen::Vector3d found = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < 4; ++i) found += barycentric[i] * u.segment<3>(3 * Eigen::Index{tet[i]});
    error.l2 += weight * (found - exact.displacement(p)).squaredNorm();
    size += weight * exact.displacement(p).squaredNorm();
    error.h1 += weight * (gradient(mesh, tet, u) - exact.gradient(p)).squaredNorm();
    slope += weight * exact.gradient(p).squaredNorm();
  });
  return {std::sqrt(error.l2 / size), std::sqrt(error.h1 / slope)};
}

TEST(FemSpace, QuadratureIntegratesWhatItClaims) {
  // The integral of x^2 y z^2 over the reference tetrahedron is 2! 1! 2! / 8!.
  double volume_sum = 0, moment = 0;
  for (const QuadraturePoint& q : quadrature()) {
    volume_sum += q.weight;
    moment += q.weight * q.barycentric[1] * q.barycentric[1] * q.barycentric[2] * q.barycentric[3] * q.barycentric[3];
  }
  EXPECT_NEAR(volume_sum, 1.0 / 6, 1e-15);
  EXPECT_NEAR(moment, 4.0 / 40'320, 1e-17);
}

TEST(FemSpace, AManufacturedSolutionConvergesWithOrderTwoAndItsGradientWithOrderOne) {
  std::printf("cells  L2 error   order  H1 error   order\n");
  FieldError before;
  double l2_order = 0, h1_order = 0;
  std::uint32_t cells_before = 0;
  for (const std::uint32_t cells : {3u, 5u, 10u, 20u}) {
    const FieldError error = manufactured_error(cells);
    if (cells_before != 0) {
      const double ratio = std::log(static_cast<double>(cells) / cells_before);
      l2_order = std::log(before.l2 / error.l2) / ratio;
      h1_order = std::log(before.h1 / error.h1) / ratio;
    }
    std::printf("%5u  %.3e  %5.2f  %.3e  %5.2f\n", cells, error.l2, l2_order, error.h1, h1_order);
    before = error;
    cells_before = cells;
  }
  EXPECT_NEAR(l2_order, 2, 0.1);
  EXPECT_NEAR(h1_order, 1, 0.1);
}

/// Fractions of the deflection by Timoshenko's formula that a mesh allows.
double linear_fraction(int refinement, double poisson) {
  const auto scene = study::space_scene("cantilever", refinement, poisson);
  const auto result = study::static_deflection(*scene);
  EXPECT_TRUE(result);
  return result->deflection / study::timoshenko_deflection(1, 0.2, 0.2, scene->material);
}
double quadratic_fraction(int refinement, double poisson) {
  const auto scene = study::space_scene("cantilever", refinement, poisson);
  const auto result = study::quadratic_static_deflection(*scene);
  EXPECT_TRUE(result);
  return *result / study::timoshenko_deflection(1, 0.2, 0.2, scene->material);
}

TEST(FemSpace, ACantileverConvergesToBeamTheory) {
  for (const double poisson : {0.3, 0.45}) {
    std::printf("nu %.2f\n  tets  fraction of Timoshenko  order\n", poisson);
    double fraction = 0, order = 0;
    for (const int refinement : {1, 2, 4, 8}) {
      const double before = fraction, order_before = order;
      fraction = linear_fraction(refinement, poisson);
      if (refinement > 1) order = std::log2((1 - before) / (1 - fraction));
      std::printf("%6d  %19.3f  %5.2f\n", 30 * refinement * refinement * refinement, fraction, order);
      EXPECT_GT(fraction, before);
      EXPECT_GE(order, order_before) << "on the way to 2";
    }
    EXPECT_GT(order, 1);
  }
}

/// Of a value that converges, from refinements r, 2r and 4r: its limit (Aitken), and how far that moves when the order is taken as 2.
std::pair<double, double> limit_of(double coarse, double middle, double fine) {
  const double first = middle - coarse, second = fine - middle, limit = fine + second * second / (first - second);
  return {limit, std::abs(limit - (fine + second / 3))};
}

TEST(FemSpace, QuadraticElementsReachTheLimitOfLinearOnes) {
  for (const double poisson : {0.3, 0.45}) {
    std::array<double, 3> fractions{};
    for (std::size_t level = 0; level < 3; ++level) fractions[level] = quadratic_fraction(1 << level, poisson);
    const auto [limit, uncertainty] = limit_of(fractions[0], fractions[1], fractions[2]);
    std::printf("nu %.2f: %.4f %.4f %.4f of Timoshenko, limit %.4f +- %.4f\n", poisson, fractions[0], fractions[1], fractions[2],
                limit, uncertainty);
    EXPECT_LT(uncertainty, 2e-3);
    // The clamp keeps the end face from contracting sideways, so the solid is a little stiffer than the beam.
    EXPECT_LT(limit, 1);
    EXPECT_GT(limit, 0.95);
    EXPECT_LT(linear_fraction(8, poisson), fractions[1]) << "linear elements lock";
  }
}

TEST(FemSpace, LinearTetrahedraLockAsMuchAsOthersMeasured) {
  // 1920 tetrahedra of the same division, computed by another program.
  EXPECT_NEAR(linear_fraction(4, 0.3), 0.782, 5e-4);
  EXPECT_NEAR(linear_fraction(4, 0.45), 0.588, 5e-4);
  EXPECT_NEAR(linear_fraction(4, 0.49), 0.294, 5e-4);
  EXPECT_NEAR(linear_fraction(4, 0.499), 0.077, 5e-4);
}

}  // namespace
}  // namespace tactus::sim
