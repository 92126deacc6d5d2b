// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/contact/aabb_tree.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "tests/property/allocated.h"
#include "tests/unit/contact_mesh_fixture.h"

namespace tactus::sim {
namespace {

using testing::Body;
using testing::random_point;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Every triangle tried, without a tree.
struct BruteForce {
  const Body& body;
  std::map<std::uint32_t, Corners> corners;

  explicit BruteForce(const Body& b) : body(b) {
    body.tree.visit_sphere({}, kInfinity, body.mesh.vertices,
                           [&](std::uint32_t triangle, const Corners& where) { corners[triangle] = where; });
  }
  std::optional<SurfacePoint> closest(const Vec3& point, double within) const {
    std::optional<SurfacePoint> best;
    double best2 = within * within;
    for (const auto& [triangle, where] : corners) {
      const TrianglePoint at = closest_on_triangle(point, where);
      const auto key = [](const Vec3& v) { return std::array{v.x, v.y, v.z}; };
      if (at.distance2 > best2 || (best && at.distance2 == best2 && key(at.point) >= key(best->point))) continue;
      best = SurfacePoint{triangle, {}, at.point, std::sqrt(at.distance2)};
      best2 = at.distance2;
    }
    return best;
  }
  template <class Test>
  std::optional<std::pair<double, std::uint32_t>> first(Test&& test) const {
    std::optional<std::pair<double, std::uint32_t>> best;
    for (const auto& [triangle, where] : corners)
      if (const auto hit = test(where); hit && (!best || hit->t < best->first)) best = {hit->t, triangle};
    return best;
  }
};

/// Points anywhere, close to the surface, exactly on corners and on the middles of edges.
std::vector<Vec3> points_around(const TriMesh& mesh, double reach, std::uint64_t seed) {
  Random random(seed);
  std::vector<Vec3> out;
  for (int i = 0; i < 400; ++i) {
    const Triangle& t = mesh.triangles[random.next() % mesh.triangles.size()];
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    out.push_back(random_point(random, reach));
    out.push_back(random_point(random, 100 * reach));
    out.push_back(a);
    out.push_back(0.5 * (a + b));
    out.push_back((1.0 / 3) * (a + b + c) + random_point(random, 1e-9));
    out.push_back(0.25 * a + 0.75 * b + random_point(random, 0.05 * reach));
  }
  return out;
}

TEST(Triangle, ClosestPointIsNoFurtherThanAnyOther) {
  Random random(5);
  for (int run = 0; run < 2000; ++run) {
    Corners v{random_point(random, 1), random_point(random, 1), random_point(random, 1)};
    if (run % 4 == 1) v[2] = v[0] + random.uniform(-2, 2) * (v[1] - v[0]) + random_point(random, 1e-12);  // a needle
    if (run % 4 == 2) v[2] = v[1];                                                                        // an edge
    if (run % 4 == 3) v[2] = v[1] + random_point(random, 1e-7);
    const Vec3 p = random_point(random, 2);
    const TrianglePoint found = closest_on_triangle(p, v);
    EXPECT_NEAR(found.weights[0] + found.weights[1] + found.weights[2], 1, 1e-14);
    for (const double weight : found.weights) EXPECT_GE(weight, 0);
    const Vec3 rebuilt = found.weights[0] * v[0] + found.weights[1] * v[1] + found.weights[2] * v[2];
    EXPECT_LT(norm(rebuilt - found.point), 1e-9) << run;
    for (int i = 0; i <= 20; ++i) {
      for (int j = 0; i + j <= 20; ++j) {
        const Vec3 other = v[0] + (i / 20.0) * (v[1] - v[0]) + (j / 20.0) * (v[2] - v[0]);
        ASSERT_LE(std::sqrt(found.distance2), norm(p - other) + 1e-9) << run;
      }
    }
  }
}

TEST(Triangle, MovingSphereStopsAtTheRadius) {
  Random random(6);
  int hits = 0;
  for (int run = 0; run < 20'000; ++run) {
    const Corners v{random_point(random, 1), random_point(random, 1), random_point(random, 1)};
    const Vec3 from = random_point(random, 3);
    const Sweep sweep{from, 2.0 * (random_point(random, 1) - from), random.uniform(1e-8, 0.5), 1e-9};
    const auto distance = [&](double t) {
      return std::sqrt(closest_on_triangle(sweep.from + t * sweep.displacement, v).distance2);
    };
    if (distance(0) < sweep.radius) continue;
    const auto hit = sphere_hits_triangle(sweep, v, 1);
    const double end = hit ? hit->t : 1;
    for (int i = 0; i <= 50; ++i) ASSERT_GE(distance(end * i / 50), sweep.radius - 1e-14) << run;
    if (!hit) continue;
    ++hits;
    ASSERT_NEAR(distance(hit->t), sweep.radius, 1e-8) << run;
  }
  EXPECT_GT(hits, 1500);
}

TEST(Triangle, SphereMayLeaveButNotComeCloser) {
  const Corners v{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}};
  Sweep sweep{{0.2, 0.2, 0.05}, {0, 0, -1}, 0.1, 1e-9};
  ASSERT_TRUE(sphere_hits_triangle(sweep, v, 1)) << "reaches into it already";
  EXPECT_EQ(sphere_hits_triangle(sweep, v, 1)->t, 0);
  sweep.displacement = {0.3, 0, 0.01};
  EXPECT_FALSE(sphere_hits_triangle(sweep, v, 1));
}

struct AabbTreeTest : ::testing::TestWithParam<int> {
  static TriMesh mesh() {
    switch (GetParam()) {
      case 0:
        return testing::bumpy_ball(0.1, 4, 0.2, 1);
      case 1:
        return testing::box({0.1, 0.1, 0.1});
      case 2:
        return testing::sheet(12, 0.01, [](double, double) { return 0.0; });
      case 3: {  // a thousand needles far from the origin, where coordinates are coarse
        TriMesh mesh = testing::sheet(23, 0.01, [](double x, double y) { return 0.01 * std::sin(300 * x) * std::cos(200 * y); });
        for (Vec3& v : mesh.vertices) v = {1000 + 1e-5 * v.x, v.y, v.z};
        return mesh;
      }
      default: {  // two components, one inside of the other
        TriMesh mesh = testing::ball(0.1, 3);
        const TriMesh inner = testing::bumpy_ball(0.05, 3, 0.1, 2);
        const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
        mesh.vertices.insert(mesh.vertices.end(), inner.vertices.begin(), inner.vertices.end());
        for (const auto& [a, b, c] : inner.triangles) mesh.triangles.push_back({first + a, first + b, first + c});
        return mesh;
      }
    }
  }
};
INSTANTIATE_TEST_SUITE_P(Meshes, AabbTreeTest, ::testing::Range(0, 5));

TEST_P(AabbTreeTest, ClosestPointIsThatOfBruteForceBitForBit) {
  const Body body(mesh());
  const BruteForce brute(body);
  for (const Vec3& point : points_around(body.mesh, 0.15, 3)) {
    for (const double within : {kInfinity, 0.02}) {
      const auto found = body.tree.closest(point, body.mesh.vertices, within);
      const auto expected = brute.closest(point, within);
      ASSERT_EQ(found.has_value(), expected.has_value());
      if (!found) continue;
      EXPECT_EQ(found->triangle, expected->triangle);
      EXPECT_EQ(found->point, expected->point);
      EXPECT_EQ(found->distance, expected->distance);
      const Triangle& t = body.mesh.triangles[found->triangle];
      EXPECT_EQ(body.tree.triangle(found->triangle), t);
      const Vec3 blend = found->weights[0] * body.mesh.vertices[t[0]] + found->weights[1] * body.mesh.vertices[t[1]] +
                         found->weights[2] * body.mesh.vertices[t[2]];
      EXPECT_LT(norm(blend - found->point), 1e-15 * (1 + norm(found->point)));
    }
  }
}

TEST_P(AabbTreeTest, SweepIsThatOfBruteForceBitForBit) {
  const Body body(mesh());
  const BruteForce brute(body);
  const std::vector<Vec3> points = points_around(body.mesh, 0.15, 5);
  int hits = 0;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const Sweep sweep{points[i], points[i + 1] - points[i], i % 2 == 0 ? 1e-8 : 0.004, 1e-9};
    const auto found = body.tree.sweep(sweep, body.mesh.vertices);
    const auto expected = brute.first([&](const Corners& v) { return sphere_hits_triangle(sweep, v, 1); });
    ASSERT_EQ(found.has_value(), expected.has_value());
    if (!found) continue;
    ++hits;
    EXPECT_EQ(found->t, expected->first);
    EXPECT_EQ(found->at.triangle, expected->second);
    const auto without = body.tree.sweep(sweep, body.mesh.vertices, {&found->at.triangle, 1});
    EXPECT_TRUE(!without || without->at.triangle != found->at.triangle);
  }
  EXPECT_GT(hits, 100);
}

TEST_P(AabbTreeTest, SphereFindsWhatBruteForceFinds) {
  const Body body(mesh());
  const BruteForce brute(body);
  for (const Vec3& point : points_around(body.mesh, 0.15, 6)) {
    std::vector<std::uint32_t> found, expected;
    const auto reaches = [&](const Corners& where) { return closest_on_triangle(point, where).distance2 <= 0.01 * 0.01; };
    body.tree.visit_sphere(point, 0.01, body.mesh.vertices, [&](std::uint32_t triangle, const Corners& where) {
      if (reaches(where)) found.push_back(triangle);  // of some only the box does
    });
    for (const auto& [triangle, where] : brute.corners)
      if (reaches(where)) expected.push_back(triangle);
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, expected);
  }
}

TEST_P(AabbTreeTest, NumberingDoesNotMatter) {
  const Body body(mesh()), other(testing::renumbered(body.mesh, 8));
  for (const Vec3& point : points_around(body.mesh, 0.15, 7)) {
    const auto a = body.tree.closest(point, body.mesh.vertices), b = other.tree.closest(point, other.mesh.vertices);
    ASSERT_TRUE(a && b);
    EXPECT_EQ(a->point, b->point);
    EXPECT_EQ(a->distance, b->distance);
    const Sweep sweep{{0.2, 0.21, 0.22}, point - Vec3{0.2, 0.21, 0.22}, 0.001, 1e-9};
    const auto hit = body.tree.sweep(sweep, body.mesh.vertices), again = other.tree.sweep(sweep, other.mesh.vertices);
    ASSERT_EQ(hit.has_value(), again.has_value());
    EXPECT_EQ(hit.value_or(SurfaceHit{}).t, again.value_or(SurfaceHit{}).t);
  }
}

TEST_P(AabbTreeTest, RefitAnswersLikeARebuild) {
  Body body(mesh());
  for (Vec3& v : body.mesh.vertices) v = {v.x + 0.03 * std::sin(20 * v.y), v.y - 0.5 * v.z, 1.5 * v.z};
  body.tree.refit(body.mesh.vertices);
  const AabbTree rebuilt(body.mesh);
  for (const Vec3& point : points_around(body.mesh, 0.2, 9)) {
    const auto a = body.tree.closest(point, body.mesh.vertices), b = rebuilt.closest(point, body.mesh.vertices);
    ASSERT_TRUE(a && b);
    EXPECT_NEAR(a->distance, b->distance, 4e-16 * (1 + norm(point)));
  }
  const BruteForce brute(body);
  for (const Vec3& point : points_around(body.mesh, 0.2, 10)) {
    const auto found = body.tree.closest(point, body.mesh.vertices);
    EXPECT_EQ(found->triangle, brute.closest(point, kInfinity)->triangle);
  }
}

TEST(AabbTree, FeatureOfTheClosestPoint) {
  const Body body(testing::box({1, 1, 1}));
  const auto feature = [&](const Vec3& p) { return body.tree.closest(p, body.mesh.vertices)->feature(); };
  EXPECT_EQ(feature({0.1, 0.3, 5}), Feature::face);
  EXPECT_EQ(feature({2, 0.3, 5}), Feature::edge);
  EXPECT_EQ(feature({2, 2, 5}), Feature::vertex);
}

TEST(AabbTree, PartOfAMeshKeepsItsNumbers) {
  const Body body(testing::ball(0.1, 3));
  AabbTree part;
  EXPECT_FALSE(part.closest({}, body.mesh.vertices)) << "no triangles";
  const std::vector<std::uint32_t> first{7, 3, 200}, second{9};
  part.build(body.mesh.triangles, first, body.mesh.vertices);
  EXPECT_EQ(part.size(), 3u);
  EXPECT_TRUE(part.contains(200) && !part.contains(9));
  EXPECT_TRUE(part.closest({}, body.mesh.vertices));
  part.build(body.mesh.triangles, second, body.mesh.vertices);
  EXPECT_TRUE(part.contains(9) && !part.contains(200));
  EXPECT_EQ(part.closest({1, 1, 1}, body.mesh.vertices)->triangle, 9u);
}

TEST(AabbTree, QueriesAndRefitAllocateNothing) {
  Body body(testing::bumpy_ball(0.1, 4, 0.2, 1));
  const std::vector<Vec3> points = points_around(body.mesh, 0.15, 3);
  double sum = 0;
  const std::uint64_t before = testing::allocated_bytes();
  for (const Vec3& point : points) {
    sum += body.tree.closest(point, body.mesh.vertices)->distance;
    if (const auto hit = body.tree.sweep({{1, 1, 1}, point - Vec3{1, 1, 1}, 0.01, 1e-9}, body.mesh.vertices)) sum += hit->t;
  }
  body.tree.refit(body.mesh.vertices);
  EXPECT_EQ(testing::allocated_bytes() - before, 0u);
  EXPECT_GT(sum, 0);
}

}  // namespace
}  // namespace tactus::sim
