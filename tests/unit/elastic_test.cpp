// SPDX-License-Identifier: Apache-2.0
/// Elastic bodies that both ends compute.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include <tactus/elastic/elastic_solver.h>
#include "tests/unit/elastic_fixture.h"

namespace tactus {
namespace {

using testing::elastic_scene;
using testing::slab_mesh;
using testing::slab_physics;

// ==== elastic elements ====

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

/// Newton's third law, and moments about the deformed positions.
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

/// Q1 diag(stretch) Q2; the rotation nearest to it is Q1 Q2 also where the smallest is below 0.
struct Stretched {
  explicit Stretched(const std::array<double, 3>& stretch) {
    const auto turn = [](double angle, std::size_t a, std::size_t b) {
      Rotation q{1, 0, 0, 0, 1, 0, 0, 0, 1};
      q[4 * a] = q[4 * b] = std::cos(angle);
      q[3 * a + b] = -(q[3 * b + a] = std::sin(angle));
      return q;
    };
    const Rotation one = times(turn(1.2, 0, 1), turn(-0.7, 1, 2)), two = times(turn(0.4, 0, 2), turn(2.1, 0, 1));
    rotation = times(one, two);
    matrix = times(times(one, {stretch[0], 0, 0, 0, stretch[1], 0, 0, 0, stretch[2]}), two);
  }
  static Rotation times(const Rotation& a, const Rotation& b) {
    Rotation out{};
    for (std::size_t i = 0; i < 9; ++i)
      for (std::size_t k = 0; k < 3; ++k) out[i] += a[3 * (i / 3) + k] * b[3 * k + i % 3];
    return out;
  }
  Rotation rotation, matrix;
};

TEST(ElementRotation, IsProperHoweverTheElementIsDeformed) {
  for (const std::array<double, 3>& stretch : std::vector<std::array<double, 3>>{{1.3, 0.7, 1.1},
                                                                                 {1.2, 0.9, 0.1},
                                                                                 {1.2, 0.9, 1e-4},
                                                                                 {3, 2, 1e-6},
                                                                                 {1.2, 0.9, -0.3},
                                                                                 {1.2, 0.9, -0.8},
                                                                                 {2.5, 1, -1e-3},
                                                                                 {0.02, 0.5, -0.01}}) {
    const Stretched of(stretch);
    const Rotation found = element_rotation(of.matrix);
    for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(found[i], of.rotation[i], 1e-4) << stretch[2];
  }
}

/// Where several rotations are as near, it is one of them.
TEST(ElementRotation, IsARotationWhereSeveralAreAsNear) {
  for (const std::array<double, 3>& stretch : std::vector<std::array<double, 3>>{{1, 1, -1}, {1, 0.5, -0.5}, {-1, -1, -1}}) {
    const Rotation r = element_rotation(Stretched(stretch).matrix);
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b)
        EXPECT_NEAR(r[a] * r[b] + r[3 + a] * r[3 + b] + r[6 + a] * r[6 + b], a == b ? 1 : 0, 1e-9);
    const double det =
        r[0] * (r[4] * r[8] - r[5] * r[7]) + r[1] * (r[5] * r[6] - r[3] * r[8]) + r[2] * (r[3] * r[7] - r[4] * r[6]);
    EXPECT_NEAR(det, 1, 1e-9);
  }
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

// ==== elastic solver ====

class Step : public ::testing::Test {
 protected:
  void make(ElasticPhysics physics) {
    scene = elastic_scene(std::move(physics), frame);
    solver.emplace(*scene, scene->deformables[0]);
    state = ElasticState(solver->vertices());
    load.assign(3 * solver->vertices(), 0);
    middle = 0;
    for (std::size_t v = 0; v < solver->vertices(); ++v)
      if (norm(solver->rest()[v] - Vec3{0.03, 0.03, 0.01}) < 1e-6) middle = 3 * v + 2;
    ASSERT_GT(middle, 0u);
  }
  double middle_height() const { return state.displacement[middle]; }
  /// Start with the middle of the upper side pressed down, as if it had been for long.
  void press_through(double deep) {
    for (std::size_t v = 0; v < solver->vertices(); ++v) {
      const Vec3& p = solver->rest()[v];
      if (p.z > 0.009 && std::abs(p.x - 0.03) < 0.011 && std::abs(p.y - 0.03) < 0.011) state.displacement[3 * v + 2] = -deep;
    }
    ElasticElements(*scene->deformables[0].body, solver->rest()).forces(state.displacement, state.force);
  }
  /// Height of the middle after 0.2 s under a load that bends the slab by its thickness, and half a swing after that.
  double pressed(ElasticBody::Method method, std::uint8_t sub_steps) {
    ElasticPhysics physics = slab_physics();
    physics.body.method = method;
    physics.body.sub_steps = sub_steps;
    make(std::move(physics));
    load[middle] = -0.2;
    for (std::uint32_t i = 0; i < 200 / frame; ++i) EXPECT_TRUE(solver->step(load, state));
    load[middle] = 0;
    for (std::uint32_t i = 0; i < 20 / frame; ++i) EXPECT_TRUE(solver->step(load, state));
    return middle_height();
  }

  std::uint32_t frame = testing::kFrame;
  SharedScene scene;
  std::optional<ElasticSolver> solver;
  ElasticState state{0};
  std::vector<double> load;
  std::size_t middle = 0;
};

TEST_F(Step, NothingMovesWithoutLoad) {
  make(slab_physics());
  ASSERT_TRUE(solver->step(load, state));
  EXPECT_FALSE(solver->moves(state));
  for (const double u : state.displacement) EXPECT_EQ(u, 0);
}

TEST_F(Step, GivesWayAndComesBack) {
  make(slab_physics());
  load[middle] = -0.05;
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(solver->step(load, state));
  const double deep = middle_height();
  EXPECT_LT(deep, -0.001);
  EXPECT_GT(deep, -0.002);
  load[middle] = 0;
  int steps = 0;
  do ASSERT_TRUE(solver->step(load, state));
  while (solver->moves(state) && ++steps < 5000);
  EXPECT_FALSE(solver->moves(state));
  EXPECT_NEAR(middle_height(), 0, 1e-7);
}

TEST_F(Step, FixedVerticesStay) {
  make(slab_physics());
  std::ranges::fill(load, -0.01);
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(solver->step(load, state));
  for (const std::uint32_t v : scene->deformables[0].body->fixed)
    for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_EQ(state.displacement[3 * v + axis], 0);
  EXPECT_LT(middle_height(), -0.001);
}

TEST_F(Step, SagsUnderItsWeight) {
  ElasticPhysics physics = slab_physics();
  physics.body.gravity = {0, 0, -9.81};
  make(std::move(physics));
  EXPECT_TRUE(solver->has_weight());
  solver->weigh(load);
  double weight = 0;
  for (std::size_t i = 2; i < load.size(); i += 3) weight += load[i];
  EXPECT_NEAR(weight, -9.81 * 0.036, 1e-5);
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(solver->step(load, state));
  EXPECT_LT(middle_height(), -0.001);
}

/// Each solution is left with an error; it must not grow from step to step, however stiff or soft the body.
TEST_F(Step, StiffAndSoftBodiesComeToRestWhereTheirForcesBalance) {
  for (const double young : {1e2, 1e4, 1e7, 1e11}) {
    ElasticPhysics physics = slab_physics();
    for (ElasticMaterial& m : physics.body.materials) m.young = young;
    physics.body.mass_damping = 10;
    make(std::move(physics));
    load[middle] = -1e-6 * young;
    for (int i = 0; i < 400; ++i) ASSERT_TRUE(solver->step(load, state)) << young;
    std::vector<double> forces(load.size());
    ElasticElements elements(*scene->deformables[0].body, solver->rest());
    elements.forces(state.displacement, forces);
    EXPECT_NEAR(forces[middle], load[middle], 1e-6 * std::abs(load[middle])) << young;
  }
}

/// What tears a body apart ends it.
TEST_F(Step, GoesToPiecesWithoutHarm) {
  make(slab_physics());
  load[middle] = -1e12;
  bool whole = true;
  for (int i = 0; i < 50 && whole; ++i) whole = solver->step(load, state);
  EXPECT_FALSE(whole);
}

using Method = ElasticBody::Method;

/// Six starts, of which five stayed inside out as long as the rotation of a mirrored element was a mirrored one.
TEST_F(Step, ASlabThatWasPushedThroughItselfComesBack) {
  for (const Method method : {Method::backward_euler, Method::tr_bdf2, Method::velocity_verlet}) {
    for (const std::uint32_t ticks : {1u, 17u}) {
      frame = ticks;
      for (const double deep : {0.015, 0.03, 0.06}) {
        ElasticPhysics physics = slab_physics();
        physics.body.materials = {{testing::kYoung, 0.45, 1000}, {testing::kYoung, 0.45, 1000}};
        physics.body.method = method;
        if (method == Method::velocity_verlet) physics.body.sub_steps = static_cast<std::uint8_t>(12 * ticks);
        make(std::move(physics));
        press_through(deep);
        SCOPED_TRACE(std::to_string(static_cast<int>(method)) + " " + std::to_string(ticks) + " " + std::to_string(deep));
        for (std::uint32_t i = 0; i < 1200 / ticks; ++i) ASSERT_TRUE(solver->step(load, state));
        for (const double u : state.displacement) ASSERT_NEAR(u, 0, 1e-9);
      }
    }
  }
}

/// Halving a sub-step of velocity Verlet quarters its error; without damping by stiffness, which is half a sub-step late.
TEST_F(Step, VelocityVerletIsOfSecondOrder) {
  const auto height = [&](std::uint8_t sub_steps) {
    ElasticPhysics physics = slab_physics();
    physics.body.stiffness_damping = 0;
    physics.body.method = Method::velocity_verlet;
    physics.body.sub_steps = sub_steps;
    make(std::move(physics));
    load[middle] = -0.05;
    for (int i = 0; i < 6; ++i) EXPECT_TRUE(solver->step(load, state));
    return middle_height();
  };
  const double exact = height(240), coarse = std::abs(height(30) - exact), fine = std::abs(height(60) - exact);
  EXPECT_GT(coarse / fine, 3.5);
  EXPECT_LT(coarse / fine, 4.9);
}

TEST_F(Step, TheMethodsAgreeAndTrBdf2IsTheBetterOfTheImplicitOnes) {
  const double exact = pressed(Method::velocity_verlet, 200), implicit = pressed(Method::tr_bdf2, 1),
               euler = pressed(Method::backward_euler, 1);
  EXPECT_LT(std::abs(exact), 0.008);
  EXPECT_NEAR(implicit, exact, 2e-4);
  EXPECT_NEAR(euler, exact, 3e-3);
  EXPECT_LT(3 * std::abs(implicit - exact), std::abs(euler - exact));
}

/// exp(-mass_damping t) of a body that falls freely, however much it is damped.
TEST_F(Step, VelocitiesDecayAsTheDampingSays) {
  for (const double damping : {0.3, 40.0, 900.0}) {
    ElasticPhysics physics = slab_physics();
    physics.body.mass_damping = damping;
    physics.body.method = Method::velocity_verlet;
    physics.body.sub_steps = 100;
    physics.body.fixed.clear();
    make(std::move(physics));
    for (std::size_t i = 0; i < state.velocity.size(); i += 3) state.velocity[i] = 0.5;
    ASSERT_TRUE(solver->step(load, state));
    for (std::size_t i = 0; i < state.velocity.size(); i += 3)
      EXPECT_NEAR(state.velocity[i], 0.5 * std::exp(-0.01 * damping), 1e-9) << damping;
  }
}

TEST(IsStable, FindsTheFrequencyOfASpring) {
  // One free vertex; along z its tetrahedron is a spring of (lambda + 2 mu) area^2 / (9 V), with area 1/2 and V = 1/6.
  ElasticBody body;
  body.tets = {{0, 1, 2, 3}};
  body.materials = {{1000, 0, 24}};
  body.material = {0};
  body.fixed = {0, 1, 2};
  body.method = Method::velocity_verlet;
  const std::vector<Vec3> rest{{}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const double omega = std::sqrt(1000.0 / 6);  // mass 24 / 6 / 4 = 1 kg
  EXPECT_TRUE(is_stable(body, rest, 1.899 / omega));
  EXPECT_FALSE(is_stable(body, rest, 1.901 / omega));
  body.sub_steps = 7;
  EXPECT_TRUE(is_stable(body, rest, 7 * 1.899 / omega));
  EXPECT_FALSE(is_stable(body, rest, 7 * 1.901 / omega));
  body.sub_steps = 1;
  body.stiffness_damping = 1 / omega;  // s (s + 2 / omega) omega^2 = 3.61
  const double longest = std::sqrt(4.61) - 1;
  EXPECT_TRUE(is_stable(body, rest, 0.999 * longest / omega));
  EXPECT_FALSE(is_stable(body, rest, 1.001 * longest / omega));
  body.method = Method::tr_bdf2;
  EXPECT_TRUE(is_stable(body, rest, 1));
}

// ==== elimination ====

TEST(Elimination, HasEveryFreeVertexOnce) {
  const ElasticBody body = slab_physics().body;
  const std::size_t vertices = slab_mesh().vertices.size();
  const Elimination found = elimination(body, vertices);
  EXPECT_EQ(found.order.size() + body.fixed.size(), vertices);
  for (std::uint32_t v = 0; v < vertices; ++v) {
    const bool is_fixed = std::ranges::binary_search(body.fixed, v);
    ASSERT_EQ(found.order_index[v] == Elimination::kFixed, is_fixed);
    if (!is_fixed) {
      EXPECT_EQ(found.order[found.order_index[v]], v);
    }
  }
}

TEST(Elimination, RowsBeginAtTheLowestNeighbour) {
  const ElasticBody body = slab_physics().body;
  const Elimination found = elimination(body, slab_mesh().vertices.size());
  std::vector<std::uint32_t> lowest(found.order.size());
  for (std::uint32_t i = 0; i < lowest.size(); ++i) lowest[i] = i;
  for (const ElasticBody::Tet& tet : body.tets)
    for (const std::uint32_t a : tet)
      for (const std::uint32_t b : tet)
        if (found.order_index[a] != Elimination::kFixed && found.order_index[b] != Elimination::kFixed)
          lowest[found.order_index[a]] = std::min(lowest[found.order_index[a]], found.order_index[b]);
  EXPECT_EQ(found.first, lowest);
}

/// The order keeps what is not 0 together: there are 50 free vertices, 10 in each cut through the slab.
TEST(Elimination, KeepsNeighboursClose) {
  const Elimination found = elimination(slab_physics().body, slab_mesh().vertices.size());
  for (std::uint32_t i = 0; i < found.first.size(); ++i) EXPECT_LT(i - found.first[i], 20u);
}

TEST(Elimination, CountsItsWork) {
  const Elimination two{.order = {4, 7}, .order_index = {}, .first = {0, 0}};
  std::uint64_t sum = 0;
  for (std::uint64_t width = 0; width < 6; ++width) sum += (width + 64) * (width + 64);
  EXPECT_EQ(elastic_work(two), sum);
}

/// An explicit body has no matrix: what it takes are its sub-steps.
TEST(Elimination, AnExplicitBodyTakesItsSubSteps) {
  ElasticBody body = slab_physics().body;
  body.method = ElasticBody::Method::velocity_verlet;
  body.sub_steps = 10;
  EXPECT_EQ(elastic_work(body, slab_mesh().vertices.size()), 128 * (10 + 24) * body.tets.size());
}

TEST(Elimination, PartsComeOneAfterTheOther) {
  ElasticBody body;
  body.tets = {{0, 1, 2, 3}, {4, 5, 6, 7}};
  const Elimination found = elimination(body, 8);
  EXPECT_EQ(found.order, (std::vector<std::uint32_t>{6, 5, 4, 7, 2, 1, 0, 3}));
  EXPECT_EQ(found.first, (std::vector<std::uint32_t>{0, 0, 0, 0, 4, 4, 4, 4}));
}

}  // namespace
}  // namespace tactus
