// SPDX-License-Identifier: Apache-2.0
/// Elastic bodies under a device, and their shapes as both ends compute them.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <vector>

#include <tactus/deformable/main_state.h>
#include <tactus/elastic/driven_shape.h>
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
  std::optional<ElasticTouch::Push> move(const Vec3& position, bool anew = false) {
    return touch->move(position, anew, surface, state);
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

/// It comes aslant: its path meets the surface 0.5 mm before its foot, after a third of it.
TEST_F(OnTheSlab, FrictionBeginsWhereThePathMetTheSurface) {
  rub(1);
  move({0.0295, 0.03, kCell + 0.0005});
  const auto held = move({0.031, 0.03, kCell - 0.001});
  ASSERT_TRUE(held);
  EXPECT_NEAR(held->force.x, 0.001 * kCoupling, 1e-12);
  EXPECT_NEAR(held->force.z, -0.001 * kCoupling, 1e-12);
  rub(0);
  move({0.0295, 0.03, kCell + 0.0005});
  EXPECT_NEAR(move({0.031, 0.03, kCell - 0.001})->force.x, 0, 1e-12);
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

TEST_F(OnTheSlab, PositionsThatAreNoNumbersPushNothing) {
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
  const auto known = std::make_shared<DevicePath>(device_scene(*scene).value()), signalled = std::make_shared<DevicePath>(*known);
  for (const auto& path : {known, signalled}) path->shift(0, 0);
  DrivenShape knows(*scene, scene->deformables[0], *known), learns(*scene, scene->deformables[0], *signalled);
  int differed = 0;
  for (std::uint64_t number = 1; number <= 120; ++number) {
    const auto tick = static_cast<std::int64_t>(5 * number);
    const bool takes_effect = number % 7 != 0;
    if (takes_effect) known->add(number, device_at(*scene, tick, pressing(tick)));
    signalled->add(number, device_at(*scene, tick, pressing(tick)));
    if (number < 20) continue;
    differed += body_at(learns, *scene, tick) != body_at(knows, *scene, tick) ? 1 : 0;
    if (number % 5 != 0) continue;
    signalled->settle(number, [](std::uint64_t n) { return n % 7 != 0; });
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
