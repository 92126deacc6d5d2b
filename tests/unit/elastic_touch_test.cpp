// SPDX-License-Identifier: Apache-2.0
#include <tactus/elastic/elastic_touch.h>

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/elastic_fixture.h"

namespace tactus {
namespace {

using testing::kCell;
using testing::kCoupling;

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

}  // namespace
}  // namespace tactus
