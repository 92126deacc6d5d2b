// SPDX-License-Identifier: Apache-2.0
/// Surfaces that move under a probe.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include <tactus/sim/contact/mesh_proxy.h>
#include <tactus/sim/tets/tet_mesh.h>
#include "tests/unit/mesh_proxy_fixture.h"

namespace tactus::sim {
namespace {

using testing::Body;
using testing::expect_near;
using testing::flat;
using testing::Hand;

/// Give the body another shape, which the hand gets first.
void deform(Body& body, Hand& hand, const std::vector<Vec3>& vertices) {
  double reach = 0;
  for (std::size_t v = 0; v < vertices.size(); ++v) reach = std::max(reach, norm(vertices[v] - body.mesh.vertices[v]));
  hand.proxy.expect(reach, body.mesh.vertices, vertices, body.tree);
  body.mesh.vertices = vertices;
  body.tree.refit(vertices);
}

/// A closed box that rises from below a hand at rest, as thick as one cell.
TEST(MeshProxyMoving, NoSurfacePassesOverHoweverFast) {
  for (const double thickness : {0.001, 0.01}) {
    const TriMesh plate = surface(make_slab(6, 6, 1, thickness)).mesh;
    for (const double speed : {2.5, 5.0, 12.0, 50.0}) {
      for (int phase = 0; phase < 50; ++phase) {
        Body body(plate);
        Hand hand(body, {.friction = 0.3});
        const Vec3 rest{3.1 * thickness, 2.9 * thickness, 2 * thickness + 1e-3 * speed * (3 + phase / 50.0)};
        hand.move_to(rest);
        for (int tick = 0; tick < 8; ++tick) {
          std::vector<Vec3> vertices = body.mesh.vertices;
          for (Vec3& v : vertices) v.z += 1e-3 * speed;
          deform(body, hand, vertices);
          const double top = thickness + 1e-3 * speed * (tick + 1);
          const ProxyTouch touch = hand.move(rest);
          if (std::abs(top - rest.z) < 1e-6) continue;  // the skin decides
          ASSERT_EQ(touch.touched, top > rest.z) << speed << " m/s, phase " << phase << ", tick " << tick;
          ASSERT_GE(touch.proxy.z, top) << speed << " m/s, phase " << phase << ", tick " << tick;
        }
      }
    }
  }
}

/// Two sheets with the hand between them, the lower one 8 mm below, the upper one 4 mm above, and nearer. The lower one rises by
/// 10 mm: it passes over the hand, and must not take the proxy through the upper one.
TEST(MeshProxyMoving, GoesAlongWithTheSurfaceThatPassesAndNoFartherThanThereIsRoom) {
  TriMesh sheets = flat();
  const auto count = static_cast<std::uint32_t>(sheets.vertices.size());
  const std::size_t triangles = sheets.triangles.size();
  for (std::uint32_t i = 0; i < count; ++i) sheets.vertices.push_back(sheets.vertices[i] + Vec3{0, 0, 0.012});
  for (std::size_t i = 0; i < triangles; ++i) {
    const auto [a, b, c] = sheets.triangles[i];
    sheets.triangles.push_back({a + count, b + count, c + count});
  }
  Body body(sheets);
  Hand hand(body, {});
  const Vec3 rest{0.0011, 0.0017, 0.008};
  hand.move(rest);
  std::vector<Vec3> vertices = body.mesh.vertices;
  for (std::uint32_t i = 0; i < count; ++i) vertices[i].z = 0.01;
  deform(body, hand, vertices);
  const ProxyTouch touch = hand.move(rest);
  EXPECT_TRUE(touch.touched);
  expect_near(touch.proxy, {rest.x, rest.y, 0.01}, 4 * hand.skin);
  for (std::uint32_t i = 0; i < count; ++i) vertices[i].z = 0;
  deform(body, hand, vertices);
  EXPECT_FALSE(hand.move(rest).touched);
  expect_near(hand.proxy.position(), rest, 0);
}

/// A sheet that rises, tilts and waves; the hand stays at rest.
TEST(MeshProxyMoving, MovingSurfaceNeverPassesOver) {
  constexpr std::uint32_t kSquares = 30;
  constexpr double kCell = 0.004;
  for (const bool free_at_first : {false, true}) {
    Body body(testing::sheet(kSquares, kCell, [](double, double) { return 0.0; }));
    Hand hand(body, {});
    const Vec3 rest{0.0011, 0.0023, free_at_first ? 0.003 : -0.001};
    hand.move({0.0011, 0.0023, 0.004});
    EXPECT_EQ(hand.move(rest).touched, !free_at_first);
    for (int tick = 1; tick <= 400; ++tick) {
      const double t = 1e-3 * tick;
      std::vector<Vec3> vertices = body.mesh.vertices;
      for (Vec3& v : vertices) v.z = 0.02 * std::sin(20 * t) + 0.3 * t * v.x + 0.004 * std::sin(40 * t + 60 * v.y);
      deform(body, hand, vertices);
      const ProxyTouch touch = hand.move(rest);
      const double ground = testing::sheet_height(body.mesh, kSquares, kCell, touch.proxy.x, touch.proxy.y);
      ASSERT_GT(touch.proxy.z, ground) << "tick " << tick;
      const double over_rest = testing::sheet_height(body.mesh, kSquares, kCell, rest.x, rest.y);
      if (std::abs(rest.z - over_rest) < 1e-6) continue;
      ASSERT_EQ(touch.touched, rest.z < over_rest) << "tick " << tick;
    }
  }
}

}  // namespace
}  // namespace tactus::sim
