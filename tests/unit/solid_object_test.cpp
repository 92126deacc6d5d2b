// SPDX-License-Identifier: Apache-2.0
// Rigid objects of any shape: sim/contact/surface_proxy.h, sim/rigid/collision.h.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <tactus/sim/random.h>
#include <tactus/sim/rigid/rigid_probe.h>
#include <tactus/sim/rigid/rigid_world.h>
#include <tactus/sim/tets/tet_mesh.h>
#include "tests/property/allocated.h"
#include "tests/unit/contact_mesh_fixture.h"

namespace tactus::sim {
namespace {

constexpr double kMass = 0.15, kMu = 0.7, kGravity = 9.81;
constexpr SceneTouch kTouch{.stiffness = 630, .friction = 0, .lift_stiffness = 68};

SceneObject solid(TriMesh mesh, const Vec3& size) {
  SceneObject object;
  object.name = "solid";
  object.size = size;
  object.surface = std::move(mesh);
  object.mass = kMass;
  object.friction = kMu;
  object.pose.position.z = size.z / 2;
  return object;
}

SceneObject box(double edge) { return solid({}, {edge, edge, edge}); }

/// The same cube with n x n squares on each face.
SceneObject cube_of_triangles(double edge, std::uint32_t n) {
  TriMesh mesh = surface(make_slab(n, n, n, edge / n)).mesh;
  for (Vec3& v : mesh.vertices) v = v - Vec3{edge / 2, edge / 2, edge / 2};
  return solid(std::move(mesh), {edge, edge, edge});
}

Scene scene_of(SceneObject object) {
  Scene scene;
  scene.gravity = {0, 0, -kGravity};
  scene.floor = 0.0;
  scene.objects.push_back(std::move(object));
  return scene;
}

TEST(SolidObject, ACubeOfTrianglesFeelsLikeABox) {
  SceneTouch touch = kTouch;
  touch.friction = 0.5;
  const std::vector<SceneObject> exact{box(0.04)}, meshed{cube_of_triangles(0.04, 5)};
  RigidProbe on_box(exact, touch), on_mesh(meshed, touch);
  int touched = 0;
  for (int i = 0; i < 4000; ++i) {
    const double t = 1e-3 * i;
    Pose pose{{0.1 * t, 0.02 * std::sin(3 * t), 0.3}, {std::cos(0.2 * t), 0, std::sin(0.2 * t), 0}};
    const Vec3 local{0.012 * std::sin(2 * t), 0.01 * std::cos(2.7 * t), 0.019 - 0.004 * std::sin(6 * t)};  // below the upper face
    const Vec3 device = to_world(pose, local);
    const Touch a = on_box.move(device, false, {&pose, 1}), b = on_mesh.move(device, false, {&pose, 1});
    ASSERT_LT(norm(a.force - b.force), 1e-5) << "a skin of 1 nm times k_o; tick " << i;
    ASSERT_LT(norm(contact_force(a.contact, pose) - contact_force(b.contact, pose)), 1e-5);
    touched += b.contact.kind == ContactKind::surface;
  }
  EXPECT_GT(touched, 2000);
}

TEST(SolidObject, ABallOfTrianglesFeelsLikeASphere) {
  constexpr double kRadius = 0.03;
  const TriMesh mesh = testing::ball(kRadius, 4);
  double sagitta = 0;  // how far the triangles' middles lie below the sphere
  for (const auto& [a, b, c] : mesh.triangles)
    sagitta = std::max(sagitta, kRadius - norm((1.0 / 3) * (mesh.vertices[a] + mesh.vertices[b] + mesh.vertices[c])));
  ASSERT_LT(sagitta, 0.005 * kRadius);
  const std::vector<SceneObject> objects{solid(mesh, {2 * kRadius, 2 * kRadius, 2 * kRadius})};
  const Pose pose{{0.5, -0.2, 0.1}, {0.6, 0.8, 0, 0}};
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    Vec3 out{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    out = (1 / norm(out)) * out;
    RigidProbe probe(objects, kTouch);
    probe.move(pose.position + 1.5 * kRadius * out, false, {&pose, 1});
    const double depth = random.uniform(0.001, 0.01);
    Touch touch;
    for (int step = 1; step <= 20; ++step)
      touch = probe.move(pose.position + (kRadius - depth * step / 20) * out, false, {&pose, 1});
    ASSERT_EQ(touch.contact.kind, ContactKind::surface);
    ASSERT_LT(norm(touch.force - kTouch.stiffness * depth * out), kTouch.stiffness * (sagitta + 0.1 * depth)) << i;
    ASSERT_NEAR(norm(touch.force), kTouch.stiffness * depth, kTouch.stiffness * sagitta) << i;
  }
}

TEST(SolidObject, FallsAndTurnsLikeTheSolidItEncloses) {
  const auto after = [](SceneObject object) {
    object.pose.position = {0, 0, 1};
    RigidWorld world(scene_of(std::move(object)));
    for (int i = 0; i < 200; ++i) {
      world.push(0, {0.3, -0.1, 0.2}, world.sample(0).pose.position + Vec3{0.01, 0.02, 0.005});
      EXPECT_TRUE(world.step());
    }
    return world.sample(0);
  };
  const RigidSample exact = after(box(0.04)), meshed = after(cube_of_triangles(0.04, 3));
  EXPECT_LT(norm(exact.pose.position - meshed.pose.position), 1e-9);
  EXPECT_LT(norm(exact.angular_velocity - meshed.angular_velocity), 1e-6 * norm(exact.angular_velocity))
      << "ODE reads the corners in single precision";
  EXPECT_GT(norm(exact.angular_velocity), 1);

  constexpr double kRadius = 0.05, kForce = 0.4;
  SceneObject ball = solid(testing::ball(kRadius, 5), {2 * kRadius, 2 * kRadius, 2 * kRadius});
  ball.pose.position.z = 1;
  RigidWorld world(scene_of(ball));
  world.push(0, {0, kForce, 0}, ball.pose.position + Vec3{kRadius, 0, 0});
  ASSERT_TRUE(world.step() && world.step()) << "the push ends in the second";
  const double inertia = 0.4 * kMass * kRadius * kRadius;
  EXPECT_NEAR(world.sample(0).angular_velocity.z, kTick * kForce * kRadius / inertia, 0.005 * kTick * kForce * kRadius / inertia);
}

TEST(SolidObject, StandsLevelHoweverFineItsMesh) {
  for (const std::uint32_t n : {1u, 16u}) {
    SceneObject cube = cube_of_triangles(0.04, n);
    cube.pose.position.x = 0.3;
    RigidWorld world(scene_of(cube));
    for (int i = 0; i < 2000; ++i) ASSERT_TRUE(world.step());
    EXPECT_LT(norm(world.sample(0).pose.position - Vec3{0.3, 0, 0.02}), 1e-6) << n;
    EXPECT_LT(angle_between(world.sample(0).pose.rotation, Quat{}), 1e-6) << n;
  }
}

TEST(SolidObject, SlidesWithCoulombFriction) {
  for (const double angle : {0.0, 0.4, std::numbers::pi / 4}) {
    const Vec3 direction{std::cos(angle), std::sin(angle), 0};
    RigidWorld world(scene_of(cube_of_triangles(0.04, 4)));
    const auto run = [&](int ticks, double force) {
      for (int i = 0; i < ticks; ++i) {
        world.push(0, force * direction, world.sample(0).pose.position);
        ASSERT_TRUE(world.step());
      }
    };
    run(20, kMu * kMass * kGravity + kMass * 50);  // to 1 m/s
    run(1, 0);                                     // in which the push ends
    const double before = norm(world.sample(0).velocity);
    run(100, 0);
    EXPECT_NEAR((before - norm(world.sample(0).velocity)) / 0.1, kMu * kGravity, 0.01 * kMu * kGravity) << angle;
  }
}

TEST(SolidObject, StepsAllocateNothingOnceOdeHasItsArenas) {
  Scene scene = scene_of(cube_of_triangles(0.04, 4));
  scene.objects.push_back(box(0.02));
  scene.objects.back().pose.position = {0, 0, 0.05};
  RigidWorld world(scene);
  RigidProbe probe(scene.objects, kTouch);
  std::array<Pose, 2> poses;
  const auto tick = [&](int i) {
    poses = {world.sample(0).pose, world.sample(1).pose};
    const Touch touch = probe.move({-0.03 + 2e-5 * i, 0.001, 0.015}, false, poses);
    if (touch.contact.kind != ContactKind::none) world.push(touch.contact.object, -touch.force, touch.proxy);
    return world.step().has_value() && touch.contact.kind != ContactKind::none;
  };
  for (int i = 0; i < 10; ++i) tick(i);
  const std::uint64_t before = testing::allocated_bytes();
  int touched = 0;
  for (int i = 10; i < 2000; ++i) touched += tick(i);
  EXPECT_EQ(testing::allocated_bytes() - before, 0u) << "operator new";
  EXPECT_GT(touched, 1000);
}

}  // namespace
}  // namespace tactus::sim
