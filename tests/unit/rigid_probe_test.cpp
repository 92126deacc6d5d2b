// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/rigid/rigid_probe.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <tactus/sim/random.h>

namespace tactus::sim {
namespace {

constexpr Vec3 kHalf{0.02, 0.02, 0.02};

void expect_near(const Vec3& a, const Vec3& b, double tolerance = 1e-15) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

bool inside(const Vec3& p, const Vec3& half) {
  return std::abs(p.x) < half.x && std::abs(p.y) < half.y && std::abs(p.z) < half.z;
}

TEST(BoxProxy, FollowsTheProbeInFreeSpace) {
  BoxProxy proxy(kHalf, 0.5);
  proxy.move_to({0.1, 0, 0});
  for (const Vec3 probe : {Vec3{0.05, 0.03, 0}, Vec3{0.021, 0.021, 0.021}, Vec3{-0.03, 0.021, 0}, Vec3{0, 0, -1}}) {
    proxy.move(probe);
    EXPECT_FALSE(proxy.face());
    EXPECT_EQ(proxy.position(), probe);
  }
}

TEST(BoxProxy, WithoutFrictionItIsTheFootOfTheProbe) {
  BoxProxy proxy(kHalf, 0);
  proxy.move_to({0.003, 0.004, 0.05});
  for (const Vec3 probe : {Vec3{0.003, 0.004, 0.018}, Vec3{-0.01, 0.015, 0.001}, Vec3{0.0199, 0.0199, -0.015}}) {
    proxy.move(probe);
    ASSERT_TRUE(proxy.face());
    expect_near(proxy.position(), {probe.x, probe.y, 0.02});
    expect_near(proxy.normal(), {0, 0, 1});
  }
}

TEST(BoxProxy, SticksInsideTheFrictionCone) {
  BoxProxy proxy(kHalf, 0.5);
  proxy.move_to({0, 0, 0.03});
  proxy.move({0, 0, 0.018});
  const Vec3 held = proxy.position();
  for (int i = 0; i < 63; ++i) {
    const double angle = 0.1 * i;
    proxy.move({0.000999 * std::cos(angle), 0.000999 * std::sin(angle), 0.018});  // rim at 0.5 * 2 mm = 1 mm
    EXPECT_EQ(proxy.position(), held);
  }
}

TEST(BoxProxy, TrailsByMuDepthOutsideTheCone) {
  BoxProxy proxy(kHalf, 0.5);
  proxy.move_to({-0.01, 0, 0.03});
  for (int i = -20; i < 25; ++i) proxy.move({0.0005 * i, 0.00025 * i, 0.017});
  const Vec3 probe{0.0125, 0.00625, 0.017};
  proxy.move(probe);
  const Vec3 lag = proxy.position() - Vec3{probe.x, probe.y, 0.02};
  EXPECT_NEAR(norm(lag), 0.5 * 0.003, 1e-15);
  EXPECT_LT(lag.x, 0);
  EXPECT_LT(lag.y, 0);
}

TEST(BoxProxy, EdgeDoesNotTurnTheForceWhileTheProbeIsInside) {
  BoxProxy proxy(kHalf, 0);
  proxy.move_to({0.01, 0, 0.03});
  for (int i = 0; i < 100; ++i) {
    proxy.move({0.01 + 0.0001 * i, 0, 0.01});  // 10 mm deep: soon far nearer to the side than to the top
    ASSERT_TRUE(proxy.face());
    expect_near(proxy.normal(), {0, 0, 1});
  }
  proxy.move({0.0201, 0, 0.01});
  EXPECT_FALSE(proxy.face()) << "beside the box nothing holds the probe";
  proxy.move({0.019, 0, 0.01});
  ASSERT_TRUE(proxy.face());
  expect_near(proxy.normal(), {1, 0, 0});
  expect_near(proxy.position(), {0.02, 0, 0.01});
}

TEST(BoxProxy, CornerHoldsWithTheFaceThatWasEntered) {
  for (const Vec3 from : {Vec3{0.019, 0.019, 0.03}, Vec3{0.019, 0.03, 0.019}, Vec3{0.03, 0.019, 0.019}}) {
    BoxProxy proxy(kHalf, 0);
    proxy.move_to(from);
    proxy.move({0.018, 0.018, 0.018});
    ASSERT_TRUE(proxy.face());
    Vec3 expected{0.018, 0.018, 0.018};
    if (from.x > 0.02) expected.x = 0.02;
    if (from.y > 0.02) expected.y = 0.02;
    if (from.z > 0.02) expected.z = 0.02;
    expect_near(proxy.position(), expected);
  }
}

TEST(BoxProxy, ThinBoxAtOneMetrePerSecond) {
  BoxProxy proxy({0.05, 0.05, 0.0005}, 0.5);  // 1 mm thick
  proxy.move_to({0, 0, 0.0103});
  for (int tick = 1; tick <= 30; ++tick) {
    const double z = 0.0103 - 1e-3 * tick;
    proxy.move({0, 0, z});
    if (z >= 0.0005) continue;
    ASSERT_TRUE(proxy.face()) << "popped through at z = " << z;
    expect_near(proxy.position(), {0, 0, 0.0005});
  }
}

TEST(BoxProxy, NeverPenetratesAndNeverHoldsOutside) {
  Random random(7);
  BoxProxy proxy(kHalf, 0.5);
  Vec3 probe{0.05, 0, 0};
  proxy.move_to(probe);
  int touching = 0;
  for (int i = 0; i < 200'000; ++i) {
    const auto step = [&](double v) { return std::clamp(v + random.uniform(-0.003, 0.003), -0.03, 0.03); };
    probe = {step(probe.x), step(probe.y), step(probe.z)};
    proxy.move(probe);
    ASSERT_FALSE(inside(proxy.position(), kHalf));
    ASSERT_TRUE(proxy.face() || !inside(probe, kHalf));
    if (!proxy.face()) continue;
    ++touching;
    ASSERT_GE(dot(proxy.position() - probe, proxy.normal()), 0.0);
    const Vec3 lag = proxy.position() - probe;
    const double depth = dot(lag, proxy.normal());
    ASSERT_LE(norm(lag - depth * proxy.normal()), 0.5 * depth + 1e-12) << "outside the friction cone";
  }
  EXPECT_GT(touching, 20'000);
}

TEST(BoxProxy, PlacedInsideTheNearestFaceHoldsIt) {
  BoxProxy proxy(kHalf, 0.5);
  proxy.move_to({0, -0.015, 0.01});
  ASSERT_TRUE(proxy.face());
  expect_near(proxy.normal(), {0, -1, 0});
  expect_near(proxy.position(), {0, -0.02, 0.01});
}

struct ProbeTest : ::testing::Test {
  SceneTouch touch{.stiffness = 630, .friction = 0.5, .lift_stiffness = 68};
  std::vector<SceneObject> objects = std::vector<SceneObject>(2);
  std::array<Pose, 2> poses;
  ProbeTest() {
    for (SceneObject& object : objects) object.size = {0.04, 0.04, 0.04};
    poses[1].position = {0.1, 0, 0};
  }
};

TEST_F(ProbeTest, ForceIsTheSpringToTheProxyAndContactGivesItsNormalPart) {
  RigidProbe probe(objects, touch);
  probe.move({0, 0, 0.03}, false, poses);
  const Touch pressed = probe.move({0.0004, 0, 0.018}, false, poses);
  EXPECT_EQ(pressed.contact.kind, ContactKind::surface);
  EXPECT_EQ(pressed.contact.object, 0u);
  expect_near(pressed.force, 630.0 * (pressed.proxy - Vec3{0.0004, 0, 0.018}), 1e-12);
  EXPECT_NEAR(pressed.force.z, 630 * 0.002, 1e-12);
  EXPECT_LT(pressed.force.x, 0) << "friction holds the probe back";
  expect_near(contact_force(pressed.contact, poses[0]), {0, 0, pressed.force.z}, 1e-12);
}

TEST_F(ProbeTest, ProxyMovesWithTheObject) {
  RigidProbe probe(objects, touch);
  probe.move({0, 0, 0.03}, false, poses);
  const Touch before = probe.move({0, 0, 0.018}, false, poses);
  poses[0].position = {0.0002, 0.0001, 0};  // inside the cone: the proxy is carried along
  const Touch after = probe.move({0, 0, 0.018}, false, poses);
  expect_near(after.proxy - before.proxy, poses[0].position, 1e-15);
}

TEST_F(ProbeTest, BoxThatRunsIntoARestingProbeIsRendered) {
  RigidProbe probe(objects, touch);
  poses[0].position = {-0.05, 0, 0};
  EXPECT_EQ(probe.move({0, 0, 0}, false, poses).contact.kind, ContactKind::none);
  poses[0].position = {-0.019, 0, 0};
  const Touch hit = probe.move({0, 0, 0}, false, poses);
  EXPECT_EQ(hit.contact.kind, ContactKind::surface);
  expect_near(hit.force, {630 * 0.001, 0, 0}, 1e-12);
}

TEST_F(ProbeTest, NamesTheObjectItTouches) {
  RigidProbe probe(objects, touch);
  probe.move({0.1, 0, 0.03}, false, poses);
  EXPECT_EQ(probe.move({0.1, 0, 0.019}, false, poses).contact.object, 1u);
  const Touch left = probe.move({0.05, 0, 0.05}, false, poses);
  EXPECT_EQ(left.contact.kind, ContactKind::none);
  EXPECT_EQ(left.contact.device, (Vec3{0.05, 0, 0.05})) << "the device is known without contact, too";
}

TEST_F(ProbeTest, ButtonTiesASpringToTheTouchedPoint) {
  RigidProbe probe(objects, touch);
  EXPECT_EQ(probe.move({0, 0, 0.03}, true, poses).contact.kind, ContactKind::none) << "nothing to hold";
  probe.move({0, 0, 0.019}, false, poses);
  probe.move({0, 0, 0.019}, true, poses);
  const Touch lifted = probe.move({0.001, 0, 0.05}, true, poses);
  EXPECT_EQ(lifted.contact.kind, ContactKind::spring);
  expect_near(lifted.force, 68.0 * Vec3{-0.001, 0, -0.03}, 1e-12);
  expect_near(contact_force(lifted.contact, poses[0]), lifted.force, 1e-12);
  EXPECT_EQ(probe.move({0.001, 0, 0.05}, false, poses).contact.kind, ContactKind::none);
}

TEST_F(ProbeTest, TurnedObjectTurnsTheForce) {
  poses[0].rotation = {std::cos(0.25), 0, 0, std::sin(0.25)};
  const Vec3 normal = rotate(poses[0].rotation, {1, 0, 0});
  RigidProbe probe(objects, {.stiffness = 630, .friction = 0, .lift_stiffness = 68});
  probe.move(0.03 * normal, false, poses);
  const Touch hit = probe.move(0.019 * normal, false, poses);
  expect_near(hit.force, 0.63 * normal, 1e-12);
}

/// Who names to the probe what moves pays less and feels the same, bit for bit.
TEST(RigidProbe, AttendedOnlyFeelsTheSame) {
  Random random(3);
  const auto any = [&random](double size) { return random.uniform(-size, size); };
  std::vector<SceneObject> objects(60);
  std::vector<Pose> poses;
  for (SceneObject& object : objects) {
    object.size = {0.05, 0.08, 0.1};
    poses.push_back({{any(0.5), any(0.5), any(0.1)}, {}});
  }
  const SceneTouch touch{.stiffness = 500, .friction = 0.4, .lift_stiffness = 100};
  RigidProbe all(objects, touch), attended(objects, touch);
  attended.expect_attend();
  Vec3 device{1, 1, 1};
  int touched = 0, lifted = 0;
  for (int tick = 0; tick < 20000; ++tick) {
    for (std::uint32_t i = 0; i < 5; ++i) {  // each moves for a while, then rests
      if (tick / 50 % 5 != static_cast<int>(i)) continue;
      attended.attend(i, poses[i]);
      poses[i].position = poses[i].position + Vec3{any(0.004), any(0.004), any(0.004)};
    }
    device = device + Vec3{any(0.006), any(0.006), any(0.006)} - 0.002 * device;
    if (tick % 1000 == 0) device = {any(0.6), any(0.6), any(0.2)};  // a jump
    const bool button = tick / 300 % 3 == 0;
    const Touch a = all.move(device, button, poses), b = attended.move(device, button, poses);
    ASSERT_EQ(a.contact.kind, b.contact.kind) << tick;
    ASSERT_EQ(a.force, b.force) << tick;
    ASSERT_EQ(a.proxy, b.proxy) << tick;
    const auto object = [](const Touch& t) { return t.contact.kind == ContactKind::none ? 999u : t.contact.object; };
    ASSERT_EQ(object(a), object(b)) << tick;
    touched += a.contact.kind == ContactKind::surface;
    lifted += a.contact.kind == ContactKind::spring;
  }
  EXPECT_GT(touched, 500);
  EXPECT_GT(lifted, 200);
}

}  // namespace
}  // namespace tactus::sim
