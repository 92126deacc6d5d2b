// SPDX-License-Identifier: Apache-2.0
#include <tactus/elastic/elastic_solver.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/elastic_fixture.h"

namespace tactus {
namespace {

using testing::elastic_scene;
using testing::slab_physics;

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

}  // namespace
}  // namespace tactus
