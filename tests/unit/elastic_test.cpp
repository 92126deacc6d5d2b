// SPDX-License-Identifier: Apache-2.0
/// Elastic bodies that both ends compute.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <vector>

#include <tactus/deformable/main_state.h>
#include <tactus/elastic/driven_shape.h>
#include <tactus/elastic/elastic_solver.h>
#include <tactus/elastic/elastic_touch.h>
#include "tests/unit/elastic_fixture.h"

namespace tactus {
namespace {

using testing::device_along;
using testing::device_at;
using testing::elastic_scene;
using testing::kCell;
using testing::kCoupling;
using testing::kFrame;
using testing::pressing;
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

// ==== elastic solver ====

class Step : public ::testing::Test {
 protected:
  void make(ElasticPhysics physics) {
    scene = elastic_scene(std::move(physics));
    solver.emplace(*scene, scene->deformables[0]);
    state = {std::vector<double>(3 * solver->vertices()), std::vector<double>(3 * solver->vertices())};
    load.assign(3 * solver->vertices(), 0);
    middle = 0;
    for (std::size_t v = 0; v < solver->vertices(); ++v)
      if (norm(solver->rest()[v] - Vec3{0.03, 0.03, 0.01}) < 1e-6) middle = 3 * v + 2;
    ASSERT_GT(middle, 0u);
  }
  double middle_height() const { return state.displacement[middle]; }

  SharedScene scene;
  std::optional<ElasticSolver> solver;
  ElasticState state;
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

// ==== elimination ====

TEST(Elimination, HasEveryFreeVertexOnce) {
  const ElasticBody body = slab_physics().body;
  const std::size_t vertices = slab_mesh().vertices.size();
  const Elimination found = elimination(body, vertices);
  EXPECT_EQ(found.order.size() + body.fixed.size(), vertices);
  for (std::uint32_t v = 0; v < vertices; ++v) {
    const bool is_fixed = std::ranges::binary_search(body.fixed, v);
    ASSERT_EQ(found.place[v] == Elimination::kFixed, is_fixed);
    if (!is_fixed) {
      EXPECT_EQ(found.order[found.place[v]], v);
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
        if (found.place[a] != Elimination::kFixed && found.place[b] != Elimination::kFixed)
          lowest[found.place[a]] = std::min(lowest[found.place[a]], found.place[b]);
  EXPECT_EQ(found.first, lowest);
}

/// The order keeps what is not 0 together: there are 50 free vertices, 10 in each cut through the slab.
TEST(Elimination, KeepsNeighboursClose) {
  const Elimination found = elimination(slab_physics().body, slab_mesh().vertices.size());
  for (std::uint32_t i = 0; i < found.first.size(); ++i) EXPECT_LT(i - found.first[i], 20u);
}

TEST(Elimination, CountsItsWork) {
  const Elimination two{.order = {4, 7}, .place = {}, .first = {0, 0}};
  std::uint64_t sum = 0;
  for (std::uint64_t width = 0; width < 6; ++width) sum += (width + 64) * (width + 64);
  EXPECT_EQ(elastic_work(two), sum);
}

TEST(Elimination, PartsComeOneAfterTheOther) {
  ElasticBody body;
  body.tets = {{0, 1, 2, 3}, {4, 5, 6, 7}};
  const Elimination found = elimination(body, 8);
  EXPECT_EQ(found.order, (std::vector<std::uint32_t>{6, 5, 4, 7, 2, 1, 0, 3}));
  EXPECT_EQ(found.first, (std::vector<std::uint32_t>{0, 0, 0, 0, 4, 4, 4, 4}));
}

// ==== elastic touch ====

class OnTheSlab : public ::testing::Test {
 protected:
  void SetUp() override { rub(0); }
  void rub(double friction) {
    ElasticPhysics physics = testing::slab_physics();
    physics.body.friction = friction;
    scene = testing::elastic_scene(std::move(physics));
    touch.emplace(scene->deformables[0]);
    surface = sim::surface(testing::slab_mesh()).mesh.vertices;
    state = {};
  }
  std::optional<ElasticTouch::Push> move(const Vec3& place, bool anew = false) {
    return touch->move(place, anew, surface, state);
  }

  SharedScene scene;
  std::optional<ElasticTouch> touch;
  std::vector<Vec3> surface;
  ElasticTouch::State state;
};

TEST_F(OnTheSlab, AboveItNothingPushes) {
  EXPECT_FALSE(move({0.03, 0.03, kCell + 0.001}));
  EXPECT_FALSE(state.touches);
  EXPECT_TRUE(state.triangle);
}

TEST_F(OnTheSlab, BelowItThePushIsThatOfTheCoupling) {
  move({0.031, 0.033, kCell + 0.001});
  const auto push = move({0.031, 0.033, kCell - 0.002});
  ASSERT_TRUE(push);
  EXPECT_NEAR(push->force.z, -0.002 * kCoupling, 1e-12);
  EXPECT_NEAR(push->force.x, 0, 1e-12);
  EXPECT_NEAR(push->weights[0] + push->weights[1] + push->weights[2], 1, 1e-12);
}

/// The proxy crosses many triangles in one tick, and keeps to the side that it came from.
TEST_F(OnTheSlab, SlidesAlong) {
  move({0.005, 0.005, kCell + 0.001});
  ASSERT_TRUE(move({0.005, 0.005, kCell - 0.001}));
  const auto push = move({0.052, 0.048, kCell - 0.001});
  ASSERT_TRUE(push);
  EXPECT_NEAR(push->force.z, -0.001 * kCoupling, 1e-12);
  EXPECT_NEAR(push->force.x, 0, 1e-12);
  EXPECT_FALSE(move({0.052, 0.048, kCell + 1e-6}));
}

/// Deeper than half the slab the upper side is still what it touches, for it is held there.
TEST_F(OnTheSlab, DoesNotChangeSides) {
  move({0.03, 0.03, kCell + 0.001});
  for (const double depth : {0.002, 0.004, 0.006, 0.009, 0.02}) {
    const auto push = move({0.03, 0.03, kCell - depth}, true);
    ASSERT_TRUE(push);
    EXPECT_NEAR(push->force.z, -depth * kCoupling, 1e-12);
  }
}

TEST_F(OnTheSlab, FrictionHoldsTheProxyWithinItsCone) {
  rub(0.5);
  move({0.03, 0.03, kCell + 0.001});
  ASSERT_TRUE(move({0.03, 0.03, kCell - 0.002}));
  const auto held = move({0.0308, 0.03, kCell - 0.002});
  ASSERT_TRUE(held);
  EXPECT_NEAR(held->force.x, 0.0008 * kCoupling, 1e-12) << "within half of the depth";
  const auto slides = move({0.0330, 0.03, kCell - 0.002});
  ASSERT_TRUE(slides);
  EXPECT_NEAR(slides->force.x, 0.5 * 0.002 * kCoupling, 1e-9) << "it follows at the edge of the cone";
  EXPECT_NEAR(slides->force.z, -0.002 * kCoupling, 1e-12);
}

/// What goes through the whole slab in one tick touches the side that it came from.
TEST_F(OnTheSlab, DoesNotPassThrough) {
  move({0.03, 0.03, kCell + 0.001});
  const auto push = move({0.03, 0.03, -0.005}, true);
  ASSERT_TRUE(push);
  EXPECT_NEAR(push->force.z, -0.015 * kCoupling, 1e-12);
}

TEST_F(OnTheSlab, LooksForTheNearestTriangleWhereItIsFree) {
  for (const Vec3& around :
       {Vec3{0.03, 0.03, kCell + 0.001}, Vec3{0.1, 0.03, 0.02}, Vec3{0.1, 0.03, -0.02}, Vec3{0.03, 0.03, -0.001}})
    EXPECT_FALSE(move(around, true));
  const auto push = move({0.03, 0.03, 0.001});
  ASSERT_TRUE(push);
  EXPECT_GT(push->force.z, 0) << "from below";
}

TEST_F(OnTheSlab, PlacesThatAreNoNumbersPushNothing) {
  const double nan = std::nan("");
  EXPECT_FALSE(move({nan, 0, 0}));
  EXPECT_FALSE(move({0, nan, nan}, true));
}

// ==== driven shape ====

using Shape = std::vector<Vec3i>;

MainState following(const Scene& scene, std::int64_t tick, Following how) {
  MainState out = initial_main_state(scene.deformables[0]);
  out.tick = tick;
  out.following = how;
  return out;
}

Shape body_at(DrivenShape& shape, const Scene& scene, std::int64_t tick) {
  Shape out(scene.deformables[0].rest.size());
  EXPECT_TRUE(shape.body_at(tick, out));
  return out;
}

std::int32_t deepest(const Shape& shape) {
  std::int32_t out = 0;
  for (const Vec3i& u : shape) out = std::min(out, u[2]);
  return out;
}

TEST(DrivenShape, FollowsTheDevice) {
  const SharedScene scene = elastic_scene();
  const auto path = device_along(scene, 1500, pressing);
  DrivenShape shape(*scene, scene->deformables[0], *path);
  EXPECT_EQ(deepest(body_at(shape, *scene, 100)), 0) << "nothing was touched";
  EXPECT_LT(deepest(body_at(shape, *scene, 500)), -1258) << "0.3 mm";
  EXPECT_GT(deepest(body_at(shape, *scene, 1490)), -42) << "10 um, 0.9 s after the device left";
}

/// A shape is there for a frame, and made of what happened before.
TEST(DrivenShape, ChangesFromFrameToFrame) {
  const SharedScene scene = elastic_scene();
  const auto path = device_along(scene, 400, pressing);
  DrivenShape shape(*scene, scene->deformables[0], *path);
  const Shape at = body_at(shape, *scene, 300);
  EXPECT_EQ(body_at(shape, *scene, 300 + kFrame - 1), at);
  EXPECT_NE(body_at(shape, *scene, 300 + kFrame), at);
}

/// Whatever is learnt of the past, the shapes are those of who knew it at once.
TEST(DrivenShape, MakesAnewWhatHadAnotherPast) {
  const SharedScene scene = elastic_scene();
  const auto known = std::make_shared<DevicePath>(device_scene(*scene).value()), told = std::make_shared<DevicePath>(*known);
  for (const auto& path : {known, told}) path->shift(0, 0);
  DrivenShape knows(*scene, scene->deformables[0], *known), learns(*scene, scene->deformables[0], *told);
  int differed = 0;
  for (std::uint64_t number = 1; number <= 120; ++number) {
    const auto tick = static_cast<std::int64_t>(5 * number);
    const bool acts = number % 7 != 0;
    if (acts) known->add(number, device_at(*scene, tick, pressing(tick)));
    told->add(number, device_at(*scene, tick, pressing(tick)));
    if (number < 20) continue;
    differed += body_at(learns, *scene, tick) != body_at(knows, *scene, tick) ? 1 : 0;
    if (number % 5 != 0) continue;
    told->settle(number, [](std::uint64_t n) { return n % 7 != 0; });
    ASSERT_EQ(body_at(learns, *scene, tick), body_at(knows, *scene, tick)) << "tick " << tick;
  }
  EXPECT_GT(differed, 3);
}

TEST(DrivenShape, AStateShowsWhatItDiffersBy) {
  const SharedScene scene = elastic_scene();
  const auto path = device_along(scene, 900, pressing);
  DrivenShape shape(*scene, scene->deformables[0], *path);
  const std::int64_t then = 300, now = then + 8 * kFrame;
  const Shape from = body_at(shape, *scene, then), at = body_at(shape, *scene, now);
  for (const Following how : {Following::kept, Following::fading}) {
    MainState state = following(*scene, then, how);
    for (std::size_t v = 0; v < from.size(); ++v) state.displacement[v] = {from[v][0] + 4000, from[v][1] - 4000, from[v][2]};
    Shape shown(from.size());
    ASSERT_TRUE(shape.show(state, now, shown));
    const std::int32_t left = how == Following::kept ? 4000 : 1374;  // (7 / 8)^8
    for (std::size_t v = 0; v < from.size(); ++v) {
      EXPECT_NEAR(shown[v][0], at[v][0] + left, 1);
      EXPECT_NEAR(shown[v][1], at[v][1] - left, 1);
      EXPECT_EQ(shown[v][2], at[v][2]);
    }
  }
}

TEST(DrivenShape, BeforeThePathBeginsNothingIsKnown) {
  const SharedScene scene = elastic_scene();
  DevicePath path(device_scene(*scene).value());
  DrivenShape shape(*scene, scene->deformables[0], path);
  Shape out(scene->deformables[0].rest.size());
  EXPECT_FALSE(shape.body_at(50, out));
  path.shift(1000, 0);
  EXPECT_TRUE(shape.body_at(50, out));
  EXPECT_EQ(deepest(out), 0);
}

/// States older than the ring keep the shape that they began with.
TEST(DrivenShape, RemembersTheShapeOfAnOldState) {
  const SharedScene scene = elastic_scene();
  const auto path = device_along(scene, 1500, pressing);
  DrivenShape shape(*scene, scene->deformables[0], *path);
  const MainState state = following(*scene, 300, Following::kept);
  const Shape from = body_at(shape, *scene, 300);
  Shape shown(from.size());
  for (std::int64_t tick = 300; tick < 1500; tick += kFrame) ASSERT_TRUE(shape.show(state, tick, shown)) << tick;
  const Shape at = body_at(shape, *scene, 1499);
  for (std::size_t v = 0; v < from.size(); ++v) EXPECT_EQ(shown[v][2], at[v][2] - from[v][2]);
  EXPECT_FALSE(shape.show(following(*scene, 400, Following::kept), 1499, shown)) << "nobody asked for that one in time";
}

/// Without a touch no step is taken: to the bit the rest shape.
TEST(DrivenShape, RestsWhileNothingTouches) {
  const SharedScene scene = elastic_scene();
  const auto path = device_along(scene, 2000, [](std::int64_t) { return Vec3{0.03, 0.03, 0.1}; });
  DrivenShape shape(*scene, scene->deformables[0], *path);
  for (std::int64_t tick = 0; tick < 20000; tick += kFrame)
    for (const Vec3i& u : body_at(shape, *scene, tick)) ASSERT_EQ(u, Vec3i{});
}

TEST(DrivenShape, ABodyThatGoesToPiecesIsNotShown) {
  ElasticPhysics physics = testing::slab_physics();
  physics.body.coupling = 1e14;
  const SharedScene scene = elastic_scene(std::move(physics));
  const auto path = device_along(scene, 400, pressing);
  DrivenShape shape(*scene, scene->deformables[0], *path);
  Shape out(scene->deformables[0].rest.size());
  EXPECT_FALSE(shape.body_at(399, out));
  EXPECT_FALSE(shape.show(following(*scene, 50, Following::kept), 399, out));
  EXPECT_TRUE(shape.body_at(100, out));
}

}  // namespace
}  // namespace tactus
