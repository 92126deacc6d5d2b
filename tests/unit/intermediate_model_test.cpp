// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/contact/intermediate_model.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "tests/property/allocated.h"
#include "tests/unit/contact_mesh_fixture.h"

namespace tactus::sim {
namespace {

using testing::Body;

constexpr std::uint32_t kSquares = 30;
constexpr double kCell = 0.005;
constexpr int kTicks = 16;  // thesis: 60 Hz beside 1 kHz

/// A sheet that dents and waves, deformed every kTicks ticks.
struct Scene {
  Body body{testing::sheet(kSquares, kCell, [](double, double) { return 0.0; })};
  IntermediateModel model{body.mesh, body.topology, {.rings = 3, .ticks = kTicks, .proxy = {.friction = 0.3}}};

  void deform(double t) {
    for (Vec3& v : body.mesh.vertices) v.z = 0.004 * std::sin(15 * t + 40 * v.x) + 0.003 * std::sin(11 * t - 50 * v.y);
    body.tree.refit(body.mesh.vertices);
  }
  void update() { model.update(body.mesh.vertices, body.tree); }
  void move_to(const Vec3& probe) { model.move_to(probe, body.mesh.vertices, body.tree); }
};

TEST(IntermediateModel, IsTheMeshAroundTheTouchedTriangle) {
  Scene scene;
  scene.move_to({0.011, 0.012, 0.01});
  const ProxyTouch touch = scene.model.move({0.011, 0.012, -0.001});
  ASSERT_TRUE(touch.touched);
  scene.update();
  std::vector<std::uint32_t> expected;
  scene.body.topology.rings_around(touch.triangle, 3, expected);
  EXPECT_TRUE(std::equal(expected.begin(), expected.end(), scene.model.triangles().begin(), scene.model.triangles().end()));
  EXPECT_GT(expected.size(), 60u);
  for (int i = 0; i < 100; ++i) scene.model.move({0.011, 0.012, -0.001});
  for (const std::uint32_t t : scene.model.triangles())
    for (const std::uint32_t v : scene.body.mesh.triangles[t]) EXPECT_EQ(scene.model.vertices()[v], scene.body.mesh.vertices[v]);
}

TEST(IntermediateModel, VerticesGoStraightToTheNewShapeInOnePeriod) {
  Scene scene;
  scene.move_to({0.001, 0.002, 0.02});
  const std::vector<Vec3> old = scene.body.mesh.vertices;
  scene.deform(0.5);
  scene.update();
  for (int tick = 1; tick <= kTicks + 3; ++tick) {
    scene.model.move({0.001, 0.002, 0.02});
    const double fraction = std::min(1.0, static_cast<double>(tick) / kTicks);
    for (const std::uint32_t t : scene.model.triangles()) {
      for (const std::uint32_t v : scene.body.mesh.triangles[t]) {
        const Vec3 expected = old[v] + fraction * (scene.body.mesh.vertices[v] - old[v]);
        ASSERT_LT(norm(scene.model.vertices()[v] - expected), 1e-15);
      }
    }
  }
}

/// Where no vertex has moved, the cut-out feels like the mesh, bit for bit.
TEST(IntermediateModel, OnAMeshAtRestItIsTheMesh) {
  Scene scene;
  scene.deform(0.3);
  const Vec3 start{0.01, 0.003, 0.02};
  scene.move_to(start);
  MeshProxy whole({.friction = 0.3}, 0.075);
  whole.move_to(start, scene.body.inside, scene.body.mesh.vertices, scene.body.tree);
  Random random(4);
  Vec3 probe{0.01, 0.003, 0.002};
  int touching = 0;
  std::set<std::uint32_t> centres;
  for (int tick = 0; tick < 4000; ++tick) {
    if (tick % 16 == 0) {
      scene.update();
      centres.insert(scene.model.triangles().front());
    }
    probe = probe + testing::random_point(random, 4e-4);
    probe = {std::clamp(probe.x, -0.06, 0.06), std::clamp(probe.y, -0.06, 0.06), std::clamp(probe.z, -0.008, 0.001)};
    const ProxyTouch a = scene.model.move(probe), b = whole.move(probe, scene.body.mesh.vertices, scene.body.tree);
    ASSERT_EQ(a.touched, b.touched);
    ASSERT_LE(norm(a.proxy - b.proxy), 1e-7) << "tick " << tick;
    touching += a.touched ? 1 : 0;
  }
  EXPECT_GT(touching, 1500);
  EXPECT_GT(centres.size(), 20u);
}

TEST(IntermediateModel, NewCutOutsDoNotJump) {
  Scene scene;
  scene.move_to({0, 0, 0.02});
  const auto path = [](double t) { return Vec3{0.03 * std::sin(2 * t), 0.02 * std::sin(3 * t), -0.008}; };
  Vec3 last;
  int touching = 0;
  double largest_between = 0, largest_at_update = 0;
  for (int tick = 0; tick < 6000; ++tick) {
    const double t = 1e-3 * tick;
    const bool updated = tick % kTicks == 0;
    if (updated) {
      scene.deform(t);
      scene.update();
    }
    const ProxyTouch touch = scene.model.move(path(t));
    if (tick > 100) {
      ASSERT_TRUE(touch.touched) << "tick " << tick;
      ++touching;
      double& largest = updated ? largest_at_update : largest_between;
      largest = std::max(largest, norm(touch.proxy - last));
    }
    last = touch.proxy;
  }
  EXPECT_LE(largest_at_update, 1.2 * largest_between) << "an update is a tick like any other";
  EXPECT_LT(largest_between, 0.001) << "path and surface move by 0.1 mm each in a tick";
}

TEST(IntermediateModel, WaitsAtTheBorderForTheNextCutOut) {
  Scene scene;
  scene.move_to({-0.05, 0.001, 0.01});
  scene.model.move({-0.05, 0.001, -0.002});
  scene.update();
  ProxyTouch touch;
  for (int i = 0; i < 60; ++i) {  // 60 mm without an update: far beyond three rings of 5 mm
    touch = scene.model.move({-0.05 + 0.001 * i, 0.001, -0.002});
    ASSERT_TRUE(touch.touched) << "tick " << i;
    ASSERT_GT(touch.normal.z, 0.9);
  }
  EXPECT_LT(touch.proxy.x, -0.02);
  for (int i = 0; i < 20; ++i) {
    scene.update();
    touch = scene.model.move({0.009, 0.001, -0.002});
  }
  EXPECT_NEAR(touch.proxy.x, 0.009, 0.001) << "a few updates later it is there";
}

TEST(IntermediateModel, ProbeThatCameInBesideTheCutOutIsPutOnTheSurface) {
  const Body body(testing::ball(0.1, 5));
  IntermediateModel model(body.mesh, body.topology, {.rings = 2, .ticks = 16, .proxy = {}});
  model.move_to({0, 0, 0.12}, body.mesh.vertices, body.tree);
  ProxyTouch touch;
  for (int i = 0; i <= 15; ++i) touch = model.move({0.004 * i, 0, 0.12 - 0.002 * i});  // over the border and then in
  for (int i = 0; i <= 10; ++i) touch = model.move({0.06, 0, 0.09 - 0.002 * i});
  EXPECT_FALSE(touch.touched) << "nothing was cut out here";
  model.update(body.mesh.vertices, body.tree);
  touch = model.move({0.06, 0, 0.07});
  ASSERT_TRUE(touch.touched);
  EXPECT_NEAR(norm(touch.proxy), 0.1, 2e-4);
}

TEST(IntermediateModel, AllocatesNothing) {
  Scene scene;
  scene.move_to({0, 0, 0.02});
  double sum = 0;
  const std::uint64_t before = testing::allocated_bytes();
  for (int tick = 0; tick < 2000; ++tick) {
    const double t = 1e-3 * tick;
    if (tick % kTicks == 0) {
      scene.deform(t);
      scene.update();
    }
    sum += scene.model.move({0.06 * std::sin(2 * t), 0.06 * std::sin(3 * t), -0.004 + 0.008 * std::sin(7 * t)}).proxy.x;
  }
  EXPECT_EQ(testing::allocated_bytes() - before, 0u);
  EXPECT_NE(sum, 0);
}

}  // namespace
}  // namespace tactus::sim
