// SPDX-License-Identifier: Apache-2.0
#include <tactus/scene/elastic_syntax.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include <tactus/scene/scene_syntax.h>
#include "tests/unit/elastic_fixture.h"
#include "tests/unit/rigid_fixture.h"

namespace tactus {
namespace {

using testing::elastic_scene;
using testing::slab_physics;

const ElasticBody& body_of(const SharedScene& scene) { return *scene->deformables[0].body; }

TEST(ElasticSyntax, IsReadAsItWasWritten) {
  ElasticPhysics physics = slab_physics();
  physics.body.gravity = {0.5, -1, -9.81};
  physics.body.friction = 0.3;
  const SharedScene scene = elastic_scene(std::move(physics));
  const auto bytes = write_scene(*scene).value();
  const auto parsed = parse_scene(bytes);
  ASSERT_TRUE(parsed) << parsed.error().rule;
  EXPECT_EQ(parsed->scene->deformables, scene->deformables);
  EXPECT_EQ(parsed->size, bytes.size());
  EXPECT_TRUE(parsed->scene->has_paths());
}

TEST(ElasticSyntax, TheMethodIsReadAsItWasWritten) {
  using Method = ElasticBody::Method;
  std::size_t size = write_scene(*elastic_scene()).value().size();
  for (const Method method : {Method::tr_bdf2, Method::velocity_verlet}) {
    ElasticPhysics physics = slab_physics();
    physics.body.method = method;
    if (method == Method::velocity_verlet) physics.body.sub_steps = 250;
    const SharedScene scene = elastic_scene(std::move(physics));
    const auto bytes = write_scene(*scene).value();
    EXPECT_EQ(bytes.size(), size + (method == Method::velocity_verlet ? 1 : 0));
    const auto parsed = parse_scene(bytes);
    ASSERT_TRUE(parsed) << parsed.error().rule;
    EXPECT_EQ(parsed->scene->deformables, scene->deformables);
  }
}

/// What a scene does not need costs nothing.
TEST(ElasticSyntax, WithoutABodyNoByteIsThere) {
  const auto surface = sim::surface(testing::slab_mesh()).mesh;
  const auto plain = SceneBuilder().deformable("slab", surface, {.frame_period = testing::kFrame}).baselines(64).build().value();
  EXPECT_FALSE(plain->has_paths());
  EXPECT_EQ(write_scene(*plain).value()[6], 1) << "flags";
  const std::size_t body = write_scene(*elastic_scene()).value().size() - write_scene(*plain).value().size();
  EXPECT_LT(body, 9 * body_of(elastic_scene()).tets.size() + 200);
}

TEST(ElasticSyntax, AnObjectBesideItNeedsNone) {
  const auto surface = sim::surface(testing::slab_mesh()).mesh;
  SceneBuilder builder;
  builder.deformable("plain", surface).deformable("slab", surface, {.frame_period = 5, .elastic = slab_physics()});
  const auto scene = builder.build();
  ASSERT_TRUE(scene) << scene.error().object;
  const auto parsed = parse_scene(write_scene(**scene).value());
  ASSERT_TRUE(parsed);
  EXPECT_FALSE(parsed->scene->deformables[0].body);
  EXPECT_EQ(parsed->scene->deformables[1].body, (*scene)->deformables[1].body);
}

/// The rule that a scene breaks once its object was changed.
std::string broken(const std::function<void(DeformableObject&)>& change) {
  SceneSpec spec = *elastic_scene();
  change(spec.deformables[0]);
  const auto scene = Scene::create(std::move(spec), testing::kWithThesis);
  return scene ? "none" : std::string(scene.error().rule);
}
std::string broken_body(const std::function<void(ElasticBody&)>& change) {
  return broken([&](DeformableObject& object) { change(*object.body); });
}

TEST(ElasticSyntax, OnlyWholeFramesOfOneLayerHaveABody) {
  EXPECT_EQ(broken([](DeformableObject&) {}), "none");
  EXPECT_EQ(broken([](DeformableObject& o) { o.layered = true; }), "R-ELA-1");
  EXPECT_EQ(broken([](DeformableObject& o) { o.frame_period = 300; }), "R-ELA-1");
  EXPECT_EQ(broken([](DeformableObject& o) { o.frame_period = 256 * 1024; }), "none");
  EXPECT_EQ(broken([](DeformableObject& o) { o.frame_period = 256 * 1025; }), "R-ELA-1");
  EXPECT_EQ(broken([](DeformableObject& o) { o.profile = DeformableProfile::thesis; }), "R-ELA-1");
}

TEST(ElasticSyntax, ConstantsAreInRange) {
  const double nan = std::nan(""), infinite = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, infinite, -1.0, 2e15}) {
    EXPECT_EQ(broken_body([&](ElasticBody& b) { b.mass_damping = bad; }), "R-ELA-2") << bad;
    EXPECT_EQ(broken_body([&](ElasticBody& b) { b.stiffness_damping = bad; }), "R-ELA-2") << bad;
    EXPECT_EQ(broken_body([&](ElasticBody& b) { b.coupling = bad; }), "R-ELA-2") << bad;
    EXPECT_EQ(broken_body([&](ElasticBody& b) { b.friction = bad; }), "R-ELA-2") << bad;
    EXPECT_EQ(broken_body([&](ElasticBody& b) { b.materials[1].young = bad; }), "R-ELA-2") << bad;
    EXPECT_EQ(broken_body([&](ElasticBody& b) { b.materials[0].density = bad; }), "R-ELA-2") << bad;
    EXPECT_EQ(broken_body([&](ElasticBody& b) { b.materials[0].poisson = bad; }), "R-ELA-2") << bad;
    EXPECT_EQ(broken_body([&](ElasticBody& b) { b.gravity.y = bad; }), bad == -1 ? "none" : "R-ELA-2") << bad;
  }
  EXPECT_EQ(broken_body([](ElasticBody& b) { b.coupling = 0; }), "R-ELA-2");
  EXPECT_EQ(broken_body([](ElasticBody& b) { b.materials[0].poisson = 0.49991; }), "R-ELA-2");
  EXPECT_EQ(broken_body([](ElasticBody& b) { b.materials[0].poisson = 0.4999; }), "none");
  EXPECT_EQ(broken_body([](ElasticBody& b) { b.materials.clear(); }), "R-ELA-2");
  EXPECT_EQ(broken_body([](ElasticBody& b) { b.materials[0].poisson = -0.5; }), "none");
}

TEST(ElasticSyntax, AMethodIsKnownAndItsSubStepsAreStable) {
  using Method = ElasticBody::Method;
  EXPECT_EQ(broken_body([](ElasticBody& b) { b.method = Method{0}; }), "R-ELA-1");
  EXPECT_EQ(broken_body([](ElasticBody& b) { b.method = Method{4}; }), "R-ELA-1");
  EXPECT_EQ(broken_body([](ElasticBody& b) { b.sub_steps = 2; }), "R-ELA-5");
  const auto verlet = [](std::uint8_t sub_steps) {
    return broken_body([=](ElasticBody& b) {
      b.method = Method::velocity_verlet;
      b.sub_steps = sub_steps;
    });
  };
  EXPECT_EQ(verlet(0), "R-ELA-5");
  EXPECT_EQ(verlet(1), "R-ELA-5");
  EXPECT_EQ(verlet(100), "none");
}

TEST(ElasticSyntax, WhatTetrahedraNameExists) {
  EXPECT_EQ(broken_body([](ElasticBody& b) { b.tets[3][2] = 98; }), "R-ELA-3");
  EXPECT_EQ(broken_body([](ElasticBody& b) { b.tets[3][2] = b.tets[3][0]; }), "R-ELA-3");
  EXPECT_EQ(broken_body([](ElasticBody& b) { b.material[5] = 2; }), "R-ELA-3");
  EXPECT_EQ(broken_body([](ElasticBody& b) { b.material.pop_back(); }), "R-ELA-3");
  EXPECT_EQ(broken_body([](ElasticBody& b) { b.fixed.back() = 98; }), "R-ELA-3");
  EXPECT_EQ(broken_body([](ElasticBody& b) { std::swap(b.fixed[0], b.fixed[1]); }), "R-ELA-3");
  EXPECT_EQ(broken_body([](ElasticBody& b) { b.tets.clear(), b.material.clear(); }), "R-ELA-3");
}

TEST(ElasticSyntax, EveryTetrahedronHasAVolumeAndEveryFreeVertexATetrahedron) {
  EXPECT_EQ(broken_body([](ElasticBody& b) { std::swap(b.tets[7][1], b.tets[7][2]); }), "R-ELA-4");
  EXPECT_EQ(broken_body([](ElasticBody& b) { b.inner.push_back({1, 2, 3}); }), "R-ELA-4");
  EXPECT_EQ(broken_body([](ElasticBody& b) {
              b.inner.push_back({1, 2, 3});
              b.fixed.push_back(98);
            }),
            "none");
  EXPECT_EQ(broken_body([](ElasticBody& b) {
              b.fixed.clear();
              for (std::uint32_t v = 0; v < 98; ++v) b.fixed.push_back(v);
            }),
            "R-ELA-4");
}

TEST(ElasticSyntax, TheWorkIsLimited) {
  const SceneSpec spec = *elastic_scene();
  DecodeLimits limits;
  limits.elastic_work = elastic_work(spec);
  EXPECT_TRUE(check_scene(spec, limits));
  --limits.elastic_work;
  EXPECT_STREQ(check_scene(spec, limits).error().rule, "R-STR-24");
}

/// Every byte of a declaration is looked at: cut anywhere, it is refused and nothing else happens.
TEST(ElasticSyntax, ADeclarationThatWasCutIsRefused) {
  const auto bytes = write_scene(*elastic_scene()).value();
  for (std::size_t size = 12; size < bytes.size(); size += 7) EXPECT_FALSE(parse_scene(std::span(bytes).first(size)));
}

}  // namespace
}  // namespace tactus
