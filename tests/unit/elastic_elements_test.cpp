// SPDX-License-Identifier: Apache-2.0
#include <tactus/elastic/elastic_solver.h>

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/elastic_fixture.h"

namespace tactus {
namespace {

using testing::slab_mesh;
using testing::slab_physics;

std::vector<double> random_shape(std::size_t vertices, double size, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<double> out(3 * vertices);
  for (double& x : out) x = size * (static_cast<double>(random() >> 11) * 0x1p-52 - 1);
  return out;
}

double length(const std::vector<double>& x) {
  double sum = 0;
  for (const double c : x) sum += c * c;
  return std::sqrt(sum);
}

class Slab : public ::testing::Test {
 protected:
  ElasticBody body = slab_physics().body;
  std::vector<Vec3> rest = slab_mesh().vertices;
  ElasticElements elements{body, rest};
  std::vector<double> forces(const std::vector<double>& u) {
    std::vector<double> out(u.size());
    elements.forces(u, out);
    return out;
  }
};

TEST_F(Slab, WeighsWhatItsMaterialsWeigh) {
  double mass = 0;
  for (const double m : elements.mass()) mass += m;
  EXPECT_NEAR(mass, 1000 * 0.06 * 0.06 * 0.01, 1e-12);
}

TEST_F(Slab, RestsWithoutForce) { EXPECT_EQ(length(forces(std::vector<double>(3 * rest.size()))), 0); }

TEST_F(Slab, RigidMotionTakesNoForce) {
  const double c = std::cos(0.7), s = std::sin(0.7);
  std::vector<double> turned;
  for (const Vec3& p : rest) {
    turned.push_back(c * p.x - s * p.y - p.x + 0.1);
    turned.push_back(s * p.x + c * p.y - p.y - 0.2);
    turned.push_back(0.05);
  }
  EXPECT_LT(length(forces(turned)), 1e-12);
}

/// Newton's third law, and moments about the deformed places.
TEST_F(Slab, ForcesAndMomentsAddToNothing) {
  const std::vector<double> u = random_shape(rest.size(), 1e-3, 1), f = forces(u);
  Vec3 force, moment;
  for (std::size_t v = 0; v < rest.size(); ++v) {
    const Vec3 at = rest[v] + Vec3{u[3 * v], u[3 * v + 1], u[3 * v + 2]}, k{f[3 * v], f[3 * v + 1], f[3 * v + 2]};
    force = force + k;
    moment = moment + cross(at, k);
  }
  EXPECT_LT(norm(force), 1e-12 * length(f));
  EXPECT_LT(norm(moment), 1e-12 * length(f));
}

TEST_F(Slab, IncrementsAreThoseOfTheForcesAtRest) {
  forces(std::vector<double>(3 * rest.size()));
  const std::vector<double> small = random_shape(rest.size(), 1e-8, 2);
  std::vector<double> linear(small.size());
  elements.multiply(small, linear);
  const std::vector<double> f = forces(small);
  for (std::size_t i = 0; i < f.size(); ++i) EXPECT_NEAR(f[i], linear[i], 1e-5 * length(linear));
}

TEST(NearestRotation, IsThatOfTheStretchedTurn) {
  const double c = std::cos(1.1), s = std::sin(1.1);
  const Rotation turned{c * 1.3, -s * 0.7, 0, s * 1.3, c * 0.7, 0, 0, 0, 1.1};  // turn times stretch
  const Rotation found = nearest_rotation(turned, 6), wanted{c, -s, 0, s, c, 0, 0, 0, 1};
  for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(found[i], wanted[i], 1e-12);
}

/// A x = b, with A put together from products.
TEST_F(Slab, TheMatrixIsFactoredRightly) {
  const Elimination order = elimination(body, rest.size());
  const double heavy = 12000, stiff = 1.4;
  const ElasticMatrix matrix(body, order, elements, heavy, stiff);
  const std::vector<double> b = random_shape(order.order.size(), 1, 3);
  std::vector<double> x = b;
  matrix.solve(x);
  std::vector<double> full(3 * rest.size()), k(full.size());
  for (std::size_t i = 0; i < x.size(); ++i) full[3 * order.order[i / 3] + i % 3] = x[i];
  forces(std::vector<double>(full.size()));
  elements.multiply(full, k);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const std::size_t v = order.order[i / 3];
    EXPECT_NEAR(heavy * elements.mass()[v] * x[i] + stiff * k[3 * v + i % 3], b[i], 1e-10);
  }
}

TEST_F(Slab, VerticesTurnWithTheirElements) {
  const double c = std::cos(0.4), s = std::sin(0.4);
  std::vector<double> turned;
  for (const Vec3& p : rest) turned.insert(turned.end(), {c * p.x - s * p.y - p.x, s * p.x + c * p.y - p.y, 0});
  forces(turned);
  std::vector<Rotation> found(rest.size());
  elements.vertex_rotations(found);
  for (const Rotation& r : found) {
    EXPECT_NEAR(r[0], c, 1e-12);
    EXPECT_NEAR(r[3], s, 1e-12);
    EXPECT_NEAR(r[8], 1, 1e-12);
  }
}

}  // namespace
}  // namespace tactus
