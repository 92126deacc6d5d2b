// SPDX-License-Identifier: Apache-2.0
/// The declaration of deformable objects.
#include <gtest/gtest.h>

#include <string_view>

#include <tactus/base/bytes.h>
#include <tactus/scene/deformable_syntax.h>
#include <tactus/scene/scene_objects.h>
#include <tactus/scene/scene_syntax.h>
#include "tests/unit/deformable_fixture.h"

namespace tactus {
namespace {

SceneSpec two_deformables() {
  SceneSpec spec =
      testing::sheet_spec(testing::sheet(3, 2), DeformableProfile::main, testing::wave_basis(testing::sheet(3, 2), 3, 3));
  DeformableObject thesis = make_deformable_object("other", testing::sheet(1, 1), 22).value();
  thesis.profile = DeformableProfile::thesis;
  thesis.quant_bits = 10;
  thesis.models_kept = true;
  spec.deformables[0].layered = true;
  thesis.rest[0] = {-2147483647 - 1, 2147483647, 0};
  spec.deformables.push_back(thesis);
  spec.objects.push_back({"box", Dof::all, {}});
  return spec;
}

TEST(SceneDeformables, RoundTrip) {
  const SceneSpec spec = two_deformables();
  const auto bytes = write_scene(*testing::shared(spec, testing::kWithThesis)).value();
  const auto parsed = parse_scene(bytes, testing::kWithThesis);
  ASSERT_TRUE(parsed) << parsed.error().rule;
  EXPECT_EQ(parsed->scene->deformables, spec.deformables);
  EXPECT_EQ(parsed->size, bytes.size());
  EXPECT_EQ(write_scene(*parsed->scene).value(), bytes);
}

TEST(SceneDeformables, StiffnessCostsAByteForEachVertexAndNothingWhereItIsNotDeclared) {
  SceneSpec spec = two_deformables();
  const auto without = write_scene(*testing::shared(spec, testing::kWithThesis)).value();
  spec.deformables[1].stiffness = {0, 1, 97, 255};
  const auto bytes = write_scene(*testing::shared(spec, testing::kWithThesis)).value();
  EXPECT_EQ(bytes.size(), without.size() + 3 + 4);  // type, size, object; levels
  const auto parsed = parse_scene(bytes, testing::kWithThesis);
  ASSERT_TRUE(parsed) << parsed.error().rule;
  EXPECT_EQ(parsed->scene->deformables, spec.deformables);
  EXPECT_TRUE(parsed->scene->deformables[0].stiffness.empty());
  const DeformableObject& declared = parsed->scene->deformables[1];
  const Triangle& corners = declared.triangles[0];
  const double between =
      0.25 * stiffness_of_level(declared.stiffness[corners[1]]) + 0.75 * stiffness_of_level(declared.stiffness[corners[2]]);
  EXPECT_EQ(stiffness_at(declared, 0, {0, 0.25, 0.75}), between);
}

TEST(SceneDeformables, ASceneWithoutThemHasNoByteAboutThem) {
  SceneSpec spec = two_deformables();
  spec.deformables.clear();
  const auto bytes = write_scene(*testing::shared(spec, testing::kWithThesis)).value();
  EXPECT_EQ(bytes[6], 0);
  EXPECT_EQ(bytes.size(), 12U + 12U + (3U + 3U + 28U) + 4U);  // fixed part, parameters and count, one object, crc
}

TEST(SceneDeformables, EveryTruncationIsRefused) {
  const auto bytes = write_scene(*testing::shared(two_deformables(), testing::kWithThesis)).value();
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const auto parsed = parse_scene(std::span(bytes).first(size), testing::kWithThesis);
    ASSERT_FALSE(parsed);
    EXPECT_EQ(parsed.error().code, Errc::truncated) << size;
  }
}

TEST(SceneDeformables, EachRule) {
  const auto rule = [](const auto& change) {
    SceneSpec spec = two_deformables();
    change(spec.deformables[0]);
    const auto scene = Scene::create(std::move(spec), testing::kWithThesis);
    return scene ? std::string_view("none") : std::string_view(scene.error().rule);
  };
  EXPECT_EQ(rule([](DeformableObject&) {}), "none");
  EXPECT_EQ(rule([](DeformableObject& m) { m.name.clear(); }), "R-STR-11");
  EXPECT_EQ(rule([](DeformableObject& m) { m.name = "box"; }), "R-STR-11");
  EXPECT_EQ(rule([](DeformableObject& m) { m.name = "other"; }), "R-STR-11");
  EXPECT_EQ(rule([](DeformableObject& m) { m.profile = static_cast<DeformableProfile>(2); }), "R-DEF-2");
  EXPECT_EQ(rule([](DeformableObject& m) { m.rings = 33; }), "R-DEF-3");
  EXPECT_EQ(rule([](DeformableObject& m) { m.frame_period = 0; }), "R-DEF-3");
  EXPECT_EQ(rule([](DeformableObject& m) { m.frame_period = (1U << 28) + 1; }), "R-DEF-3");
  EXPECT_EQ(rule([](DeformableObject& m) { m.rest.clear(); }), "R-DEF-4");
  EXPECT_EQ(rule([](DeformableObject& m) { m.triangles[2][1] = 12; }), "R-DEF-6");
  EXPECT_EQ(rule([](DeformableObject& m) { m.triangles[2][1] = m.triangles[2][2]; }), "R-DEF-6");
  EXPECT_EQ(rule([](DeformableObject& m) { m.basis.steps[1] = 0; }), "R-DEF-7");
  EXPECT_EQ(rule([](DeformableObject& m) { m.basis.entries[5] = 2048; }), "R-DEF-7");
  EXPECT_EQ(rule([](DeformableObject& m) { m.basis.entries.pop_back(); }), "R-DEF-7");
  EXPECT_EQ(rule([](DeformableObject& m) { m.profile = DeformableProfile::thesis; }), "R-DEF-7");
  EXPECT_EQ(rule([](DeformableObject& m) {
              m.profile = DeformableProfile::thesis;
              m.basis = {};
              m.quant_bits = 13;
            }),
            "R-DEF-3");
}

TEST(SceneDeformables, ASpringBasisIsComputedAndNotWritten) {
  SceneSpec spec = two_deformables();
  DeformableObject& object = spec.deformables[0];
  object.basis = {};
  object.spring_basis = {5, {0, 1, 2, 7, 11}};
  const SharedScene scene = testing::shared(spec, testing::kWithThesis);
  EXPECT_EQ(scene->deformables[0].basis.steps.size(), 5U);
  const auto bytes = write_scene(*scene).value();
  const auto parsed = parse_scene(bytes, testing::kWithThesis);
  ASSERT_TRUE(parsed);
  EXPECT_EQ(parsed->scene->deformables[0], scene->deformables[0]);
  spec.deformables[0].spring_basis = {};
  EXPECT_EQ(bytes.size(), write_scene(*testing::shared(spec, testing::kWithThesis)).value().size() + 1 + 1 + 2 * 3)
      << "mode_count, runs of fixed vertices";
}

TEST(SceneDeformables, ClustersAreCodedWhereTheyAreNotExpected) {
  SceneSpec spec = two_deformables();
  DeformableObject& object = spec.deformables[0];
  object.basis = {};
  object.cluster_basis = {3, 2, std::vector<std::uint8_t>(object.rest.size(), 1)};
  object.cluster_basis.clusters.back() = 2;
  const SharedScene scene = testing::shared(spec, testing::kWithThesis);
  EXPECT_EQ(scene->deformables[0].basis.steps.size(), 36U);
  const auto bytes = write_scene(*scene).value();
  const auto parsed = parse_scene(bytes, testing::kWithThesis);
  ASSERT_TRUE(parsed);
  EXPECT_EQ(parsed->scene->deformables[0], scene->deformables[0]);
  spec.deformables[0].cluster_basis = {};
  EXPECT_EQ(bytes.size(), write_scene(*testing::shared(spec, testing::kWithThesis)).value().size() + 1 + 1 + 1 + 2 * 2)
      << "cluster_count, blend, surprises of the first and the last vertex";
}

TEST(SceneDeformables, RulesOfClusters) {
  const auto rule = [](const ClusterBasis& basis, std::uint8_t springs = 0, DecodeLimits limits = {}) {
    SceneSpec spec = two_deformables();
    spec.deformables[0].basis = {};
    spec.deformables[0].cluster_basis = basis;
    spec.deformables[0].spring_basis.modes = springs;
    limits.thesis = &thesis_component;
    const auto scene = Scene::create(std::move(spec), limits);
    return scene ? std::string_view("none") : std::string_view(scene.error().rule);
  };
  const std::size_t vertices = two_deformables().deformables[0].rest.size();
  const std::vector<std::uint8_t> all(vertices, 1);
  EXPECT_EQ(rule({2, 32, all}), "none");
  EXPECT_EQ(rule({64, 0, all}), "none");
  EXPECT_EQ(rule({0, 0, all}), "R-DEF-7") << "clusters of no basis";
  EXPECT_EQ(rule({65, 0, all}), "R-DEF-7");
  EXPECT_EQ(rule({2, 33, all}), "R-DEF-7");
  EXPECT_EQ(rule({1, 0, all}), "R-DEF-7");
  EXPECT_EQ(rule({2, 0, std::vector<std::uint8_t>(vertices - 1, 1)}), "R-DEF-7");
  EXPECT_EQ(rule({2, 0, all}, 4), "R-DEF-7") << "two bases";
  EXPECT_EQ(rule({2, 12, all}, 0, {.basis_work = 4 * vertices - 1}), "R-STR-21");
  EXPECT_EQ(rule({2, 12, all}, 0, {.basis_work = 4 * vertices}), "none");
}

TEST(SceneDeformables, RulesOfASpringBasis) {
  const auto rule = [](const SpringBasis& basis, DecodeLimits limits = {}) {
    SceneSpec spec = two_deformables();
    spec.deformables[0].basis = {};
    spec.deformables[0].spring_basis = basis;
    limits.thesis = &thesis_component;
    const auto scene = Scene::create(std::move(spec), limits);
    return scene ? std::string_view("none") : std::string_view(scene.error().rule);
  };
  EXPECT_EQ(rule({6, {1, 2}}), "none");
  EXPECT_EQ(rule({0, {1}}), "R-DEF-7") << "fixed vertices of no basis";
  EXPECT_EQ(rule({65, {}}), "R-DEF-7");
  EXPECT_EQ(rule({6, {2, 1}}), "R-DEF-7");
  EXPECT_EQ(rule({6, {1, 1}}), "R-DEF-7");
  EXPECT_EQ(rule({6, {12}}), "R-DEF-7");
  EXPECT_EQ(rule({6, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9}}), "none");
  EXPECT_EQ(rule({6, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10}}), "R-DEF-7") << "three components are free";
  EXPECT_EQ(rule({6, {}}, {.basis_work = 14 * (12 + 16 * 12) + 686}), "none");
  EXPECT_EQ(rule({6, {}}, {.basis_work = 14 * (12 + 16 * 12) + 685}), "R-STR-21");
}

/// What a writer cannot write: bytes changed by hand.
TEST(SceneDeformables, EachRuleOfTheReader) {
  DeformableObject mesh;
  mesh.name = "m";
  mesh.rest = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  std::vector<std::uint8_t> good;
  ByteWriter writer(good);
  write_deformable(writer, mesh);
  const auto rule = [&](std::size_t at, std::vector<std::uint8_t> bytes) {
    std::vector<std::uint8_t> bad = good;
    bad.erase(bad.begin() + static_cast<std::ptrdiff_t>(at));
    bad.insert(bad.begin() + static_cast<std::ptrdiff_t>(at), bytes.begin(), bytes.end());
    ByteReader reader(bad);
    const auto parsed = parse_deformable(reader, {.vertices = 1000, .triangles = 1000});
    return parsed ? std::string_view("none") : std::string_view(parsed.error().rule);
  };
  // profile, name (2), rings, frame_period (4), layered, fade (2), weight_sets, vertices, triangles, 9 coordinates, 3 corners, basis
  EXPECT_EQ(rule(0, {1}), "none");
  EXPECT_EQ(rule(0, {0}), "R-DEF-2") << "without component thesis";
  EXPECT_EQ(rule(0, {2}), "R-DEF-2");
  EXPECT_EQ(rule(3, {33}), "R-DEF-3");
  EXPECT_EQ(rule(8, {1}), "none");
  EXPECT_EQ(rule(8, {2}), "R-DEF-3");
  EXPECT_EQ(rule(11, {0}), "R-DEF-3");
  EXPECT_EQ(rule(11, {8}), "R-DEF-3");
  EXPECT_EQ(rule(12, {0}), "R-DEF-4");
  EXPECT_EQ(rule(12, {0x80, 0x80, 0x80, 1}), "R-DEF-4");
  EXPECT_EQ(rule(12, {0x80, 0x80, 2}), "R-STR-14");
  EXPECT_EQ(rule(12, {0xff, 1}), "R-STR-5");
  EXPECT_EQ(rule(14, {0x80, 0x80, 0x80, 0x80, 0x10}), "R-DEF-5");
  EXPECT_EQ(rule(23, {6}), "R-DEF-6");
  EXPECT_EQ(rule(23, {1}), "R-DEF-6");
  EXPECT_EQ(rule(26, {4}), "R-DEF-7");
  EXPECT_EQ(rule(26, {1}), "R-STR-5");
  EXPECT_EQ(rule(26, {1, 65}), "R-DEF-7");
  EXPECT_EQ(rule(26, {1, 0}), "R-DEF-7");
  EXPECT_EQ(rule(26, {1, 1}), "R-STR-5");
  EXPECT_EQ(rule(26, {1, 0x81, 0}), "R-STR-5");
  EXPECT_EQ(rule(26, {2, 1}), "R-STR-5");
  EXPECT_EQ(rule(26, {2, 1, 0}), "none");
  EXPECT_EQ(rule(26, {2, 1, 1, 0}), "R-STR-5");
  EXPECT_EQ(rule(26, {2, 1, 1, 0, 1}), "none");
  EXPECT_EQ(rule(26, {2, 4, 1, 0, 1}), "R-DEF-7");
  EXPECT_EQ(rule(26, {2, 1, 1, 0, 3}), "R-DEF-7");
  EXPECT_EQ(rule(26, {2, 1, 2, 0, 0, 0, 0}), "R-DEF-7");
}

}  // namespace
}  // namespace tactus
