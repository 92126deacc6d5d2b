// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/contact/surroundings.h>

#include <cmath>

#include <gtest/gtest.h>

#include "tests/property/allocated.h"
#include "tests/unit/contact_mesh_fixture.h"

namespace tactus::sim {
namespace {

using testing::Body;
using testing::random_point;

void expect_same(const std::optional<SurfaceHit>& a, const std::optional<SurfaceHit>& b) {
  ASSERT_EQ(a.has_value(), b.has_value());
  if (!a) return;
  EXPECT_EQ(a->t, b->t);
  EXPECT_EQ(a->rest, b->rest);
  EXPECT_EQ(a->at.triangle, b->at.triangle);
  EXPECT_EQ(a->at.weights, b->at.weights);
  EXPECT_EQ(a->at.point, b->at.point);
  EXPECT_EQ(a->at.distance, b->at.distance);
}

/// A sphere that drifts over the mesh as a proxy does: short displacements along it, now and then a long one into it, stopped where it touches.
class Walk {
 public:
  Walk(const Body& body, double radius, std::uint64_t seed) : body_(body), radius_(radius), random_(seed) { move_to(); }

  void move_to() {
    const Vec3& vertex = body_.mesh.vertices[random_.next() % body_.mesh.vertices.size()];
    at_ = (1 + 1.5 * radius_ / norm(vertex)) * vertex;
  }
  Sweep next() {
    const double length = random_.next() % 4 == 0 ? 5 * radius_ : random_.uniform(0, 0.4 * radius_);
    const Vec3 inward = (-1 / norm(at_)) * at_, displacement = random_point(random_, 1) + random_.uniform(-0.2, 1) * inward;
    return {at_, length / norm(displacement) * displacement, radius_, kSlack};
  }
  void go(const Sweep& sweep, const std::optional<SurfaceHit>& hit) {
    at_ = sweep.from + (hit ? hit->rest : 1.0) * sweep.displacement;
  }
  std::uint64_t draw() { return random_.next(); }

 private:
  static constexpr double kSlack = 1e-9;

  const Body& body_;
  double radius_;
  Random random_;
  Vec3 at_;
};

struct SurroundingsTest : ::testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Radii, SurroundingsTest,
                         ::testing::Values(1e-8, 2e-4, 0.003, 0.02));  // of the largest: too many triangles

TEST_P(SurroundingsTest, AnswerLikeTheTreeBitForBit) {
  const Body body(testing::bumpy_ball(0.1, 5, 0.2, 1));
  int hits = 0;
  for (std::uint64_t run = 0; run < 60; ++run) {
    Walk walk(body, GetParam(), run);
    TriangleCache around(body.tree, body.mesh.vertices, 0.6 * GetParam());
    std::vector<std::uint32_t> left_out;
    for (int step = 0; step < 40; ++step) {
      const Sweep sweep = walk.next();
      const auto expected = body.tree.sweep(sweep, body.mesh.vertices, left_out);
      expect_same(around.sweep(sweep, left_out), expected);
      if (expected) {
        ++hits;
        expect_same(around.sweep(sweep, left_out, expected->t), expected);
        for (const std::uint32_t triangle : {expected->at.triangle, expected->at.triangle / 2})
          expect_same(around.sweep_one(sweep, triangle), body.tree.sweep(sweep, body.mesh.vertices, triangle));
        left_out.assign(walk.draw() % 2, expected->at.triangle);
      }
      walk.go(sweep, expected);
    }
  }
  EXPECT_GT(hits, 300);
}

TEST(TriangleCache, NeedlesFarFromTheOriginAreMetLikeInTheTree) {
  TriMesh mesh = testing::sheet(23, 0.01, [](double x, double y) { return 0.01 * std::sin(300 * x) * std::cos(200 * y); });
  for (Vec3& v : mesh.vertices) v = {1000 + 1e-5 * v.x, v.y, v.z};
  const Body body(mesh);
  Random random(2);
  int hits = 0;
  for (int run = 0; run < 1000; ++run) {
    TriangleCache around(body.tree, body.mesh.vertices, 0.01);
    for (int step = 0; step < 10; ++step) {
      const Vec3 from = Vec3{1000, 0, 0} + random_point(random, 0.03);
      const Sweep sweep{from, random_point(random, 0.02), 0.003, 1e-5};
      const auto expected = body.tree.sweep(sweep, body.mesh.vertices);
      expect_same(around.sweep(sweep, {}), expected);
      hits += expected ? 1 : 0;
    }
  }
  EXPECT_GT(hits, 500);
}

TEST(TriangleCache, AllocateNothing) {
  const Body body(testing::bumpy_ball(0.1, 4, 0.2, 1));
  Walk walk(body, 0.005, 3);
  double sum = 0;
  const std::uint64_t before = testing::allocated_bytes();
  TriangleCache around(body.tree, body.mesh.vertices, 0.005);
  for (int step = 0; step < 100; ++step) {
    const Sweep sweep = walk.next();
    const auto hit = around.sweep(sweep, {});
    sum += hit ? hit->t : 1;
    walk.go(sweep, hit);
  }
  EXPECT_EQ(testing::allocated_bytes() - before, 0u);
  EXPECT_GT(sum, 0);
}

}  // namespace
}  // namespace tactus::sim
