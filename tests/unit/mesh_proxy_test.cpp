// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include <tactus/sim/contact/mesh_proxy.h>
#include "tests/property/allocated.h"
#include "tests/unit/mesh_proxy_fixture.h"

namespace tactus::sim {
namespace {

using testing::Body;
using testing::expect_near;
using testing::flat;
using testing::Hand;

/// Two slopes that meet in the line x = 0, rising by `slope` away from it (a groove) or falling (a ridge).
TriMesh folded(double slope) {
  return testing::sheet(20, 0.01, [=](double x, double) { return slope * std::abs(x); });
}

TEST(MeshProxy, FollowsTheProbeInFreeSpace) {
  const Body body(testing::ball(0.1, 4));
  Hand hand(body, {.friction = 0.5});
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    Vec3 probe = testing::random_point(random, 1);
    if (norm(probe) < 0.12) continue;
    probe = (0.2 / norm(probe)) * probe;  // neighbours may lie on opposite sides of the ball, ...
    hand.move_to(probe);                  // ... so each is a start
    const ProxyTouch touch = hand.move(probe + testing::random_point(random, 0.05));
    ASSERT_FALSE(touch.touched);
    ASSERT_EQ(touch.proxy, hand.proxy.position());
  }
  const Vec3 probe{0.3, 0.2, 0.1};
  hand.move_to({0.3, 0.3, 0.3});
  EXPECT_EQ(hand.move(probe).proxy, probe) << "bit for bit";
}

TEST(MeshProxy, OnAPlaneItIsTheFootOfTheProbe) {
  const Body body(flat());
  Hand hand(body, {});
  hand.move({0.003, 0.004, 0.05});
  for (const Vec3 probe :
       {Vec3{0.003, 0.004, -0.002}, Vec3{-0.01, 0.015, -0.001}, Vec3{0.0999, 0.02, -0.03}, Vec3{0, 0, -0.03}}) {
    const ProxyTouch touch = hand.move(probe);
    ASSERT_TRUE(touch.touched);
    expect_near(touch.proxy, {probe.x, probe.y, 0}, 2 * hand.skin);
    expect_near(touch.normal, {0, 0, 1}, 1e-8);  // on edges it is as exact as rounding over skin, 2^-29
    const Vec3 tangential = touch.proxy - probe - dot(touch.proxy - probe, touch.normal) * touch.normal;
    EXPECT_LE(norm(tangential), hand.skin) << "no friction, no tangential force";
  }
  EXPECT_EQ(hand.move({0.01, 0.01, 0.001}).proxy, (Vec3{0.01, 0.01, 0.001})) << "free again";
}

TEST(MeshProxy, OnAPlaneThePathDoesNotMatter) {
  const Body body(flat());
  Random random(2);
  const Vec3 goal{0.021, -0.013, -0.004};
  for (int run = 0; run < 50; ++run) {
    Hand hand(body, {});
    hand.move({random.uniform(-0.09, 0.09), random.uniform(-0.09, 0.09), 0.02});
    for (int i = 0; i < 20; ++i) hand.move({random.uniform(-0.09, 0.09), random.uniform(-0.09, 0.09), random.uniform(-0.02, 0)});
    expect_near(hand.move(goal).proxy, {goal.x, goal.y, 0}, 2 * hand.skin);
  }
}

TEST(MeshProxy, SticksInsideTheFrictionCone) {
  const Body body(flat());
  Hand hand(body, {.friction = 0.5});
  hand.move({0.0031, 0.0017, 0.001});
  const Vec3 held = hand.move({0.0031, 0.0017, -0.002}).proxy;
  for (int i = 0; i < 63; ++i) {
    const double angle = 0.1 * i;
    const Vec3 probe{0.0031 + 0.000999 * std::cos(angle), 0.0017 + 0.000999 * std::sin(angle), -0.002};  // rim at 1 mm
    ASSERT_EQ(hand.move(probe).proxy, held);
  }
}

TEST(MeshProxy, TrailsByMuDepthOutsideTheCone) {
  const Body body(flat());
  Hand hand(body, {.friction = 0.5});
  hand.move({-0.01, 0, 0.003});
  ProxyTouch touch;
  Vec3 probe;
  for (int i = -20; i <= 25; ++i) touch = hand.move(probe = {0.0005 * i, 0.00025 * i, -0.003});
  const Vec3 lag = touch.proxy - probe;
  EXPECT_NEAR(std::hypot(lag.x, lag.y), 0.5 * lag.z, 1e-15) << "on the rim of the friction circle";
  EXPECT_NEAR(lag.z, 0.003, 2 * hand.skin);
  EXPECT_LT(lag.x, 0);
  EXPECT_LT(lag.y, 0);
}

TEST(MeshProxy, GrooveHoldsWithTwoPlanes) {
  const Body body(folded(1));  // 45 degrees on either side
  Hand hand(body, {});
  hand.move({0.03, 0.01, 0.06});
  const ProxyTouch touch = hand.move_along({0.03, 0.01, 0.02}, {0.002, 0.013, -0.008}, 40);
  ASSERT_TRUE(touch.touched);
  expect_near(touch.proxy, {0, 0.013, 0}, 4 * hand.skin);
  // Probe beside the groove's axis: nearer to one slope's plane than to the bottom, so one slope alone holds it.
  const ProxyTouch slope = hand.move({0.004, 0.013, 0.001});
  expect_near(slope.proxy, {0.0025, 0.013, 0.0025}, 4 * hand.skin);
  expect_near(slope.normal, {-std::sqrt(0.5), 0, std::sqrt(0.5)}, 1e-9);
}

TEST(MeshProxy, FrictionInAGrooveAddsThatOfBothSides) {
  const Body body(folded(1));
  Hand hand(body, {.friction = 0.2});
  hand.move({0, 0, 0.001});
  const Vec3 held = hand.move({0, 0, -0.01}).proxy;
  const double rim = 0.2 * std::sqrt(2.0) * 0.01;  // 10 mm below: 10/sqrt(2) mm below either side
  EXPECT_EQ(hand.move({0, 0.99 * rim, -0.01}).proxy, held);
  const ProxyTouch touch = hand.move({0, 0.005, -0.01});
  EXPECT_NEAR(touch.proxy.y, 0.005 - rim, 4 * hand.skin);
}

TEST(MeshProxy, RidgeTurnsTheForceOnlyWhenTheOtherSideIsNearer) {
  const Body body(folded(-0.5));
  Hand hand(body, {});
  hand.move({-0.03, 0, 0.01});
  const double cosine = 1 / std::sqrt(1.25), sine = 0.5 * cosine, depth = 0.003;
  for (int i = -200; i <= 200; ++i) {
    const double along = 1e-4 * i;  // along the left slope, which goes on beyond the ridge as a plane
    const Vec3 foot{along * cosine, 0, along * sine}, probe = foot - depth * Vec3{-sine, 0, cosine};
    const ProxyTouch touch = hand.move(probe);
    if (along < -1e-6) {
      expect_near(touch.proxy, foot, 4 * hand.skin);
    } else if (along > 1e-6 && touch.touched) {
      const double height = dot(probe, {sine, 0, cosine});  // over the plane of the right slope
      expect_near(touch.proxy, probe - height * Vec3{sine, 0, cosine}, 4 * hand.skin);
    }
  }
}

TEST(MeshProxy, SharpEdgeDoesNotTurnTheForce) {  // thesis figure 2.6 b, c
  const Body body(testing::box({0.02, 0.02, 0.02}));
  Hand hand(body, {});
  hand.move_to({0.01, 0.001, 0.03});
  for (int i = 0; i < 100; ++i) {
    const Vec3 probe{0.01 + 0.0001 * i, 0.001, 0.01};  // 10 mm deep: soon far nearer to the side than to the top
    const ProxyTouch touch = hand.move(probe);
    ASSERT_TRUE(touch.touched);
    expect_near(touch.proxy, {probe.x, probe.y, 0.02}, 2 * hand.skin);
    expect_near(touch.normal, {0, 0, 1}, 1e-12);
  }
  EXPECT_FALSE(hand.move({0.0201, 0.001, 0.01}).touched) << "beside the box nothing holds the probe";
  expect_near(hand.move({0.019, 0.001, 0.01}).proxy, {0.02, 0.001, 0.01}, 2 * hand.skin);
}

TEST(MeshProxy, CornerHoldsWithThreePlanes) {
  const Body body(testing::inside_out(testing::box({0.1, 0.1, 0.1})));  // a room
  for (const double friction : {0.0, 0.3}) {
    Hand hand(body, {.friction = friction});
    EXPECT_FALSE(hand.move_to({0, 0.01, 0.02}).touched);
    const ProxyTouch touch = hand.move_along({0, 0.01, 0.02}, {0.11, 0.12, 0.13}, 300);
    ASSERT_TRUE(touch.touched);
    if (friction == 0) {
      expect_near(touch.proxy, {0.1, 0.1, 0.1}, 8 * hand.skin);
      const Vec3 depth{0.01, 0.02, 0.03};
      expect_near(touch.normal, (-1 / norm(depth)) * depth, 1e-5);
    }
    const ProxyTouch held = hand.move({0.12, 0.12, 0.12});
    expect_near(held.proxy, {0.1, 0.1, 0.1}, friction == 0 ? 8 * hand.skin : 0.02);
  }
}

TEST(MeshProxy, FineBallIsASphere) {
  constexpr double kRadius = 0.1;
  const Body body(testing::ball(kRadius, 6));  // 32 768 triangles; edges of 2.5 mm lie up to 8 um below the sphere
  Hand hand(body, {});
  hand.move_to({0, 0, 0.11});
  Random random(3);
  double previous_depth = 0;
  Vec3 direction{0, 0, 1}, probe{0, 0, 0.11}, previous_proxy = probe;
  for (int i = 0; i < 5000; ++i) {
    direction = direction + testing::random_point(random, 0.003);
    direction = (1 / norm(direction)) * direction;
    const Vec3 next = std::max(kRadius - 0.004, norm(probe) - 5e-4) * direction;
    const double step = norm(next - probe);
    probe = next;
    const ProxyTouch touch = hand.move(probe);
    if (norm(probe) > kRadius - 2e-5) continue;
    ASSERT_TRUE(touch.touched);
    const double depth = norm(touch.proxy - probe);
    ASSERT_NEAR(depth, kRadius - norm(probe), 2e-5);
    ASSERT_GT(dot(touch.normal, direction), std::cos(0.03)) << "facets turn by less than 0.03 rad against the sphere";
    // Across an edge the force turns by the angle of the facets at most, and the proxy jumps by depth times it.
    ASSERT_TRUE(previous_depth == 0 || norm(touch.proxy - previous_proxy) <= 1.1 * step + 0.06 * depth);
    previous_depth = depth;
    previous_proxy = touch.proxy;
  }
  EXPECT_GT(previous_depth, 0.0035);
}

TEST(MeshProxy, ThinPlatesAtOneMetrePerSecond) {  // thesis figure 2.6 a
  for (const double thickness : {1e-3, 5e-4, 2e-4, 1e-4}) {
    for (const double friction : {0.0, 0.7}) {
      const Body body(testing::box({0.05, 0.05, 0.5 * thickness}));
      for (const Vec3 inward : {Vec3{0, 0, -1}, Vec3{0.6, 0, -0.8}, Vec3{0.5, 0.5, -std::sqrt(0.5)}}) {
        Hand hand(body, {.friction = friction});
        const Vec3 start = Vec3{0.0013, 0.0017, 0.0013} - 0.005 * inward;
        hand.move_to(start);
        for (int tick = 1; tick <= 30; ++tick) {
          const Vec3 probe = start + (1e-3 * tick) * inward;
          const ProxyTouch touch = hand.move(probe);
          ASSERT_GE(touch.proxy.z, 0.5 * thickness) << "popped through at tick " << tick;
          ASSERT_EQ(touch.touched, probe.z < 0.5 * thickness + hand.skin);
        }
      }
    }
  }
}

TEST(MeshProxy, OpenSheetHoldsFromBothSides) {
  const Body body(flat());
  Hand above(body, {}), below(body, {});
  above.move({0.011, 0.012, 0.01});
  below.move({0.011, 0.012, -0.01});
  expect_near(above.move({0.011, 0.012, -0.005}).proxy, {0.011, 0.012, 0}, 2 * above.skin);
  const ProxyTouch touch = below.move({0.011, 0.012, 0.005});
  expect_near(touch.proxy, {0.011, 0.012, 0}, 2 * below.skin);
  expect_near(touch.normal, {0, 0, -1}, 1e-12);
}

TEST(MeshProxy, SphereKeepsItsRadius) {
  const Body body(testing::ball(0.05, 5));
  Hand hand(body, {.radius = 0.01});
  hand.move_to({0, 0, 0.1});
  ProxyTouch touch = hand.move({0, 0, 0.055});
  EXPECT_NEAR(touch.proxy.z, 0.06, 2 * hand.skin) << "over the topmost vertex";
  Random random(4);
  Vec3 direction{0, 0, 1};
  for (int i = 0; i < 2000; ++i) {
    direction = direction + testing::random_point(random, 0.01);
    direction = (1 / norm(direction)) * direction;
    touch = hand.move(0.057 * direction);
    ASSERT_TRUE(touch.touched);
    const auto nearest = body.tree.closest(touch.proxy, body.mesh.vertices);
    ASSERT_NEAR(nearest->distance, 0.01, 2 * hand.skin);
    ASSERT_LT(norm(touch.proxy - 0.06 * direction), 2e-4) << "facets are up to 0.1 mm below the sphere";
  }
}

TEST(MeshProxy, SphereInAGrooveTouchesBothSides) {
  const Body body(folded(1));
  Hand hand(body, {.radius = 0.005});
  hand.move({0.02, 0, 0.06});
  const ProxyTouch touch = hand.move_along({0.02, 0, 0.03}, {0.001, 0.004, -0.01}, 30);
  expect_near(touch.proxy, {0, 0.004, 0.005 * std::sqrt(2.0)}, 4 * hand.skin);
}

TEST(MeshProxy, SphereDoesNotFallIntoAGapThatIsTooNarrow) {
  // A trench 6 mm wide between two plateaus; a ball of 8 mm diameter rests on its two edges.
  const Body body(testing::sheet(40, 0.003, [](double x, double) { return std::abs(x) < 0.0025 ? -0.05 : 0.0; }));
  Hand hand(body, {.radius = 0.004});
  hand.move({0.0005, 0, 0.02});
  const ProxyTouch touch = hand.move_along({0.0005, 0, 0.01}, {0.0002, 0, -0.003}, 50);
  EXPECT_GT(touch.proxy.z, 0.002);
  EXPECT_LT(touch.proxy.z, 0.004);
}

TEST(MeshProxy, PlacedInsideTheNearestPointHoldsIt) {
  const Body body(testing::box({0.02, 0.02, 0.02}));
  Hand hand(body, {.friction = 0.5});
  const ProxyTouch touch = hand.move_to({0.001, -0.015, 0.01});
  ASSERT_TRUE(touch.touched);
  expect_near(touch.proxy, {0.001, -0.02, 0.01}, 2 * hand.skin);
  expect_near(touch.normal, {0, -1, 0}, 1e-12);
  EXPECT_FALSE(hand.move_to({0.001, -0.021, 0.01}).touched);
  const Body sheet(flat());
  Hand open(sheet, {});
  EXPECT_FALSE(open.move_to({0, 0, -0.01}).touched) << "an open sheet has no inside";
}

TEST(MeshProxy, NotANumberIsIgnored) {
  const Body body(flat());
  Hand hand(body, {});
  hand.move({0.001, 0.002, 0.01});
  const Vec3 held = hand.move({0.001, 0.002, -0.004}).proxy;
  const ProxyTouch touch = hand.move({std::nan(""), 0, HUGE_VAL});
  EXPECT_TRUE(touch.touched);
  EXPECT_EQ(touch.proxy, held);
}

TEST(MeshProxy, NumberingDoesNotMatter) {
  const Body body(testing::bumpy_ball(0.1, 4, 0.1, 6)), other(testing::renumbered(body.mesh, 7));
  Hand a(body, {.friction = 0.3}), b(other, {.friction = 0.3});
  Random random(8);
  Vec3 probe{0, 0, 0.12};
  a.move_to(probe);
  b.move_to(probe);
  for (int i = 0; i < 3000; ++i) {
    probe = (0.095 / norm(probe)) * probe + testing::random_point(random, 0.002);
    expect_near(a.move(probe).proxy, b.move(probe).proxy, 1e-6);
  }
}

TEST(MeshProxy, FasterTicksConverge) {
  // The same path over bumps at 1, 10 and 100 kHz: where it ends, the nearer the closer the rate.
  const Body body(testing::sheet(60, 0.002, [](double x, double y) { return 0.002 * std::sin(150 * x) * std::cos(130 * y); }));
  const auto path = [](double t) { return Vec3{-0.04 + 0.08 * t, 0.02 * std::sin(6 * t), -0.001 - 0.002 * std::sin(3 * t)}; };
  const auto run = [&](int rate) {
    Hand hand(body, {.friction = 0.4});
    hand.move({-0.04, 0, 0.01});
    std::vector<Vec3> out;
    for (int i = 0; i <= rate; ++i) {
      const Vec3 proxy = hand.move(path(static_cast<double>(i) / rate)).proxy;
      if (i % (rate / 100) == 0) out.push_back(proxy);
    }
    return out;
  };
  const auto reference = run(100'000), fast = run(10'000), slow = run(1000);
  double fast_error = 0, slow_error = 0;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    fast_error += norm(fast[i] - reference[i]) / 101;
    slow_error += norm(slow[i] - reference[i]) / 101;
  }
  EXPECT_LT(fast_error, 0.5 * slow_error);
  EXPECT_LT(slow_error, 1e-4) << "80 um per tick at 1 kHz";
}

TEST(MeshProxy, RandomWalksNeverCross) {
  constexpr std::uint32_t kSquares = 40;
  constexpr double kCell = 0.002;
  for (const double friction : {0.0, 0.5}) {
    for (const double roughness : {0.0005, 0.002, 0.006}) {
      Random random(static_cast<std::uint64_t>(1e6 * roughness) + (friction > 0 ? 1 : 0));
      const Body body(testing::sheet(kSquares, kCell, [&](double, double) { return random.uniform(-roughness, roughness); }));
      Hand hand(body, {.friction = friction});
      Vec3 probe{0, 0, 0.01};
      hand.move(probe);
      int touching = 0, unfinished = 0;
      for (int i = 0; i < 17'000; ++i) {
        const auto step = [&](double v, double low, double high) {
          return std::clamp(v + random.uniform(-0.001, 0.001), low, high);
        };
        probe = {step(probe.x, -0.035, 0.035), step(probe.y, -0.035, 0.035), step(probe.z, -0.012, 0.006)};
        const ProxyTouch touch = hand.move(probe);
        touching += touch.touched ? 1 : 0;
        const double ground = testing::sheet_height(body.mesh, kSquares, kCell, touch.proxy.x, touch.proxy.y);
        ASSERT_GT(touch.proxy.z, ground) << "step " << i << " roughness " << roughness;
        unfinished += norm(hand.move(probe).proxy - touch.proxy) > 2 * hand.skin ? 1 : 0;
      }
      EXPECT_GT(touching, 5000);
      EXPECT_LE(unfinished, touching / 1000) << "moved on although the probe had not";
    }
  }
}

TEST(MeshProxy, RandomWalksNeverCrossAClosedMesh) {
  for (const double radius : {0.0, 0.003}) {
    const Body body(testing::bumpy_ball(0.05, 4, 0.3, 12));
    Hand hand(body, {.friction = 0.3, .radius = radius});
    Random random(13);
    Vec3 probe{0.09, 0, 0};
    hand.move_to(probe);
    int touching = 0;
    for (int i = 0; i < 20'000; ++i) {
      probe = probe + testing::random_point(random, 0.0015);
      if (norm(probe) > 0.06) probe = (0.06 / norm(probe)) * probe;
      const ProxyTouch touch = hand.move(probe);
      touching += touch.touched ? 1 : 0;
      const auto nearest = body.tree.closest(touch.proxy, body.mesh.vertices);
      ASSERT_GE(nearest->distance, radius + 0.9 * hand.skin) << "step " << i;
      ASSERT_FALSE(body.inside.contains(touch.proxy, *nearest, body.mesh.vertices)) << "step " << i;
    }
    EXPECT_GT(touching, 10'000);
  }
}

/// A displacement that takes more sweeps than a call may spend is cut short: still touched and still outside.
TEST(MeshProxy, DisplacementsThatAreCutShortStayOutside) {
  const Body body(testing::bumpy_ball(0.05, 5, 0.3, 3));
  for (const double radius : {0.0, 0.002}) {
    Random random(9);
    for (int run = 0; run < 300; ++run) {
      Hand hand(body, {.friction = 0.2, .radius = radius});
      const Vec3 towards = testing::random_point(random, 1), start = (0.1 / norm(towards)) * towards;
      hand.move_to(start);
      const Vec3 goal = testing::random_point(random, 0.02);  // deep inside
      for (int i = 0; i < 20; ++i) {
        const ProxyTouch touch = hand.move(goal);
        ASSERT_TRUE(touch.touched) << run;
        ASSERT_NEAR(norm(touch.normal), 1, 1e-12);
        const auto nearest = body.tree.closest(touch.proxy, body.mesh.vertices);
        ASSERT_GE(nearest->distance, radius + 0.9 * hand.skin) << run;
        ASSERT_FALSE(body.inside.contains(touch.proxy, *nearest, body.mesh.vertices)) << run;
      }
    }
  }
}

TEST(MeshProxy, FrictionCarriesTheProxyWithTheSurface) {
  Body body(flat());
  Hand hand(body, {.friction = 0.5});
  hand.move({0.0011, 0.0017, 0.001});
  const ProxyTouch before = hand.move({0.0011, 0.0017, -0.002});
  for (Vec3& v : body.mesh.vertices) v = v + Vec3{0.0004, 0.0002, 0};
  body.tree.refit(body.mesh.vertices);
  const ProxyTouch after = hand.move({0.0011, 0.0017, -0.002});
  expect_near(after.proxy - before.proxy, {0.0004, 0.0002, 0}, 1e-12);
  EXPECT_EQ(after.triangle, before.triangle);
}

TEST(MeshProxy, AllocatesNothing) {
  const Body body(testing::bumpy_ball(0.1, 4, 0.1, 6));
  Hand hand(body, {.friction = 0.3});
  hand.move_to({0, 0, 0.12});
  Random random(8);
  double sum = 0;
  const std::uint64_t before = testing::allocated_bytes();
  for (int i = 0; i < 2000; ++i) {
    hand.proxy.expect(0.01, body.mesh.vertices, body.mesh.vertices, body.tree);
    sum += hand.move(Vec3{0, 0, 0.095} + testing::random_point(random, 0.03)).proxy.x;
  }
  EXPECT_EQ(testing::allocated_bytes() - before, 0u);
  EXPECT_NE(sum, 0);
}

}  // namespace
}  // namespace tactus::sim
