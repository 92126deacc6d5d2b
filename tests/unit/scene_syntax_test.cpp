// SPDX-License-Identifier: Apache-2.0
/// The declaration of a scene.
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string_view>

#include <tactus/base/bytes.h>
#include <tactus/scene/deformable_syntax.h>
#include <tactus/scene/scene_objects.h>
#include <tactus/scene/scene_syntax.h>
#include "tests/unit/deformable_fixture.h"

namespace tactus {
namespace {

// ==== scene syntax ====

using Bytes = std::vector<std::uint8_t>;

SceneSpec two_objects() {
  SceneSpec spec;
  spec.tick_rate = 500;
  spec.objects.resize(2);
  spec.objects[0].name = "cube";
  spec.objects[0].dof = Dof::x | Dof::rz;
  spec.objects[0].initial.position = {1, -2, 3};
  spec.objects[1].name = "tisch \xc3\xa4";
  spec.objects[1].dof = Dof::none;
  return spec;
}

Bytes written(SceneSpec spec) { return write_scene(*Scene::create(std::move(spec)).value()).value(); }

TEST(SceneSyntax, RoundTrips) {
  const SceneSpec spec = two_objects();
  const Bytes bytes = written(spec);
  const auto parsed = parse_scene(bytes);
  ASSERT_TRUE(parsed);
  EXPECT_EQ(parsed->size, bytes.size());
  EXPECT_EQ(parsed->scene->tick_rate, 500u);
  EXPECT_EQ(parsed->scene->grid, spec.grid);
  ASSERT_EQ(parsed->scene->objects.size(), 2u);
  EXPECT_EQ(parsed->scene->objects[0].initial, spec.objects[0].initial);
  EXPECT_EQ(parsed->scene->objects[1].name, spec.objects[1].name);
  EXPECT_EQ(written(*parsed->scene), bytes) << "equal scenes, equal bytes";
}

TEST(SceneSyntax, NoSceneIsMadeThatTheReaderWouldRefuse) {
  const std::pair<const char*, std::function<void(SceneSpec&)>> cases[] = {
      {"R-STR-6", [](SceneSpec& s) { s.tick_rate = 0; }},
      {"R-STR-6", [](SceneSpec& s) { s.tick_rate = 1000001; }},
      {"R-STR-7", [](SceneSpec& s) { s.grid.position = 31; }},
      {"R-STR-7", [](SceneSpec& s) { s.grid.velocity = 23; }},
      {"R-STR-7", [](SceneSpec& s) { s.grid.velocity = 9; }},
      {"R-STR-7", [](SceneSpec& s) { s.grid.rotation = 29; }},
      {"R-STR-7", [](SceneSpec& s) { s.grid.angular_velocity = 6; }},
      {"R-STR-8", [](SceneSpec& s) { s.max_extrapolation = 0; }},
      {"R-STR-9", [](SceneSpec& s) { s.baseline_span = 65; }},
      {"R-STR-11", [](SceneSpec& s) { s.objects[0].name.clear(); }},
      {"R-STR-11", [](SceneSpec& s) { s.objects[0].name = s.objects[1].name; }},
      {"R-STR-11", [](SceneSpec& s) { s.objects[0].name = "\xc3"; }},
      {"R-STR-11", [](SceneSpec& s) { s.objects[0].name = "\xed\xa0\x80"; }},
      {"R-STR-11", [](SceneSpec& s) { s.objects[0].name = "a\nb"; }},
      {"R-STR-12", [](SceneSpec& s) { s.objects[0].dof = Dof::rx | Dof::ry; }},
      {"R-STR-12", [](SceneSpec& s) { s.objects[0].dof = 64; }},
      {"R-STR-13",
       [](SceneSpec& s) {
         s.objects[0].initial.rotation = {1 << 29, 0, 0, 0};
       }},
      {"R-STR-22", [](SceneSpec& s) { s.motion.emplace(); }},
      {"R-STR-22",
       [](SceneSpec& s) {
         s.motion = {{0, (1 << 28) + 1, 0}, 0};
       }},
      {"R-STR-22",
       [](SceneSpec& s) {
         s.motion = {{0, 0, -(1 << 28) - 1}, 0};
       }},
      {"R-STR-22",
       [](SceneSpec& s) {
         s.motion = {{0, 0, 1}, -1};
       }},
      {"R-STR-22",
       [](SceneSpec& s) {
         s.motion = {{0, 0, 1}, 1};
         s.objects[0].dof = Dof::none;
       }},
  };
  for (const auto& [rule, change] : cases) {
    SceneSpec spec = two_objects();
    change(spec);
    const auto checked = check_scene(spec);
    ASSERT_FALSE(checked) << rule;
    EXPECT_STREQ(checked.error().rule, rule);
    EXPECT_EQ(checked.error().code, Errc::invalid);
    EXPECT_STREQ(Scene::create(spec).error().rule, rule);
  }
}

/// Replace the body's tail and mend size and check value.
Bytes with_extension(Bytes bytes, const Bytes& extension) {
  bytes.resize(bytes.size() - 4);
  bytes.insert(bytes.end(), extension.begin(), extension.end());
  const auto body = static_cast<std::uint32_t>(bytes.size() - 12);
  for (unsigned i = 0; i < 4; ++i) bytes[8 + i] = static_cast<std::uint8_t>(body >> (8 * i));
  ByteWriter(bytes).u32(crc32(bytes));
  return bytes;
}

TEST(SceneSyntax, MotionConstantsTakeSixteenBytesWhereThereAreAny) {
  SceneSpec spec = two_objects();
  const std::size_t without = written(spec).size();
  spec.motion = {{1, -2, 1 << 28}, 3};
  const Bytes bytes = written(spec);
  EXPECT_EQ(bytes.size(), without + 16);
  EXPECT_EQ(parse_scene(bytes).value().scene->motion, spec.motion);
}

TEST(SceneSyntax, OtherProfilesAreNotKnown) {
  Bytes bytes = written(two_objects());
  bytes[5] = 1;
  EXPECT_EQ(parse_scene(bytes).error().code, Errc::unsupported);
  EXPECT_STREQ(parse_scene(bytes).error().rule, "R-STR-3");
  bytes[5] = 2;
  EXPECT_EQ(parse_scene(bytes).error().code, Errc::malformed);
  EXPECT_STREQ(parse_scene(bytes).error().rule, "R-STR-3");
}

TEST(SceneSyntax, UnknownExtensionsAreSkippedBrokenOnesRefused) {
  const Bytes bytes = written(two_objects());
  EXPECT_TRUE(parse_scene(with_extension(bytes, {0x90, 0x01, 3, 1, 2, 3, 7, 0})));
  const auto broken = parse_scene(with_extension(bytes, {5, 9, 1}));
  ASSERT_FALSE(broken);
  EXPECT_STREQ(broken.error().rule, "R-STR-16");
  EXPECT_EQ(broken.error().code, Errc::malformed);
}

TEST(SceneSyntax, LimitsApplyBeforeAllocation) {
  const Bytes bytes = written(two_objects());
  DecodeLimits limits;
  limits.objects = 1;
  const auto few = parse_scene(bytes, limits);
  ASSERT_FALSE(few);
  EXPECT_EQ(few.error().code, Errc::limit_exceeded);
  limits = {};
  limits.header_bytes = 10;
  EXPECT_STREQ(parse_scene(bytes, limits).error().rule, "R-STR-14");
}

/// Deformable objects of one vertex whose states hold the largest models.
SceneSpec with_models(int count) {
  SceneSpec spec;
  spec.baseline_span = 64;
  for (int i = 0; i < count; ++i) {
    DeformableObject& object = spec.deformables.emplace_back();
    object.name = std::to_string(i);
    object.profile = DeformableProfile::thesis;
    object.quant_bits = 12;
    object.models_kept = true;
    object.rest = {{0, 0, 0}};
  }
  return spec;
}

TEST(SceneSyntax, StatesAreLimitedBeforeAnythingIsBuilt) {
  EXPECT_EQ(state_bytes(with_models(226)), 226u * 1183992);
  EXPECT_TRUE(Scene::create(with_models(226)));
  EXPECT_STREQ(Scene::create(with_models(227)).error().rule, "R-STR-18");
  EXPECT_EQ(Scene::create(with_models(227)).error().code, Errc::limit_exceeded);
  const Bytes bytes = written(with_models(10));
  EXPECT_TRUE(parse_scene(bytes, {.state_bytes = 10 * 1183992}));
  const auto refused = parse_scene(bytes, {.state_bytes = 10 * 1183992 - 1});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::limit_exceeded);
  EXPECT_STREQ(refused.error().rule, "R-STR-18");
}

TEST(SceneSyntax, VerticesAndTrianglesOfAllObjectsCount) {
  SceneSpec spec;
  for (const char* name : {"a", "b"}) {
    DeformableObject& object = spec.deformables.emplace_back();
    object.name = name;
    object.rest = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    object.triangles = {{0, 1, 2}};
  }
  const Bytes bytes = written(spec);
  EXPECT_TRUE(parse_scene(bytes, {.vertices = 6, .triangles = 2}));
  EXPECT_STREQ(parse_scene(bytes, {.vertices = 5}).error().rule, "R-STR-14");
  EXPECT_STREQ(parse_scene(bytes, {.triangles = 1}).error().rule, "R-STR-14");
}

TEST(SceneSyntax, EveryPrefixIsTruncated) {
  const Bytes bytes = written(two_objects());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const auto parsed = parse_scene(std::span(bytes).first(size));
    ASSERT_FALSE(parsed) << size;
    EXPECT_EQ(parsed.error().code, Errc::truncated) << size;
  }
}

TEST(SceneSyntax, EveryFlippedBitIsNoticed) {
  const Bytes bytes = written(two_objects());
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    auto damaged = bytes;
    damaged[bit / 8] ^= static_cast<std::uint8_t>(1 << (bit % 8));
    EXPECT_FALSE(parse_scene(damaged)) << "bit " << bit;
  }
}

// ==== scene bounds ====

/// One object that moves and two deformable ones, one of each profile.
SceneSpec objects() {
  SceneSpec spec;
  spec.objects.resize(2);
  spec.objects[0].name = "cube";
  spec.objects[1].name = "wall";
  spec.objects[1].dof = Dof::none;
  for (const DeformableProfile profile : {DeformableProfile::main, DeformableProfile::thesis}) {
    DeformableObject& object = spec.deformables.emplace_back();
    object.name = profile == DeformableProfile::main ? "main" : "thesis";
    object.profile = profile;
    object.rest = {{0, 0, 0}};
  }
  return spec;
}

SceneSpec with_bounds(const RigidTriggers& rigid, const DeformableThresholds& deformables) {
  SceneSpec spec = objects();
  spec.bounds = bounds_of(spec, rigid, deformables, {});
  return spec;
}

RigidTriggers with_rule(HapticRule rule) {
  RigidTriggers out;
  out.haptic = rule;
  out.heartbeat = 0.3;
  out.visual_position = 0.1;
  if (rule == HapticRule::isotropic || rule == HapticRule::cone) out.weber_fraction = 1.0 / 3;
  if (rule == HapticRule::cone) out.cone_angle = 0.7;
  if (rule == HapticRule::perceptual) out.perceptual_share = 0.3;
  if (rule == HapticRule::fixed) out.fixed_rotation = 0.123;
  return out;
}

TEST(StreamBounds, WhatTheSenderPromisesArrivesToTheBit) {
  for (const HapticRule rule :
       {HapticRule::off, HapticRule::isotropic, HapticRule::cone, HapticRule::fixed, HapticRule::perceptual}) {
    for (const std::optional<double> weber : {std::optional<double>(), std::optional(0.1)}) {
      DeformableThresholds deformables;
      deformables.weber_fraction = weber;
      if (weber) deformables.depth_floor = 1e-5;
      const SceneSpec spec = with_bounds(with_rule(rule), deformables);
      const auto bytes = written(spec);
      const auto parsed = parse_scene(bytes);
      ASSERT_TRUE(parsed);
      EXPECT_EQ(parsed->scene->bounds, spec.bounds);
      EXPECT_EQ(write_scene(*parsed->scene).value(), bytes);
    }
  }
}

TEST(StreamBounds, ObjectsOfProfileThesisOnlyAimAtThem) {
  const SceneSpec spec = with_bounds({}, {});
  EXPECT_TRUE(spec.bounds->deformables[0].kept);
  EXPECT_FALSE(spec.bounds->deformables[1].kept);
}

TEST(StreamBounds, AStreamWithoutThemHasNoByteAboutThem) {
  EXPECT_FALSE(parse_scene(written(objects()))->scene->bounds);
  SceneSpec still = objects();
  still.objects.erase(still.objects.begin());
  still.deformables.clear();
  const std::size_t bare = written(still).size();
  still.bounds = bounds_of(still, {}, {}, {});
  EXPECT_EQ(written(still).size(), bare + 2) << "type and size";
}

TEST(StreamBounds, WhatIsNoBoundIsRefused) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  const std::function<void(StreamBounds&)> changes[] = {
      [](StreamBounds& b) { b.rigid->visual_position = -0.001; },
      [](StreamBounds& b) { b.rigid->heartbeat = kInfinite; },
      [](StreamBounds& b) { b.rigid->force_floor = std::numeric_limits<double>::quiet_NaN(); },
      [](StreamBounds& b) { b.rigid.reset(); },
      [](StreamBounds& b) { b.deformables[1].thresholds.depth_floor = -0.0; },
      [](StreamBounds& b) { b.deformables.pop_back(); },
  };
  for (const auto& change : changes) {
    SceneSpec spec = with_bounds({}, {});
    ASSERT_TRUE(check_scene(spec));
    change(*spec.bounds);
    const auto scene = Scene::create(spec);
    ASSERT_FALSE(scene) << &change - changes;
    EXPECT_EQ(scene.error().code, Errc::invalid);
    EXPECT_STREQ(scene.error().rule, "R-STR-17");
  }
}

// ==== scene deformable ====

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
  const auto bytes = write_scene(*testing::shared(spec)).value();
  const auto parsed = parse_scene(bytes);
  ASSERT_TRUE(parsed) << parsed.error().rule;
  EXPECT_EQ(parsed->scene->deformables, spec.deformables);
  EXPECT_EQ(parsed->size, bytes.size());
  EXPECT_EQ(write_scene(*parsed->scene).value(), bytes);
}

TEST(SceneDeformables, StiffnessCostsAByteForEachVertexAndNothingWhereItIsNotTold) {
  SceneSpec spec = two_deformables();
  const auto without = write_scene(*testing::shared(spec)).value();
  spec.deformables[1].stiffness = {0, 1, 97, 255};
  const auto bytes = write_scene(*testing::shared(spec)).value();
  EXPECT_EQ(bytes.size(), without.size() + 3 + 4);  // type, size, object; levels
  const auto parsed = parse_scene(bytes);
  ASSERT_TRUE(parsed) << parsed.error().rule;
  EXPECT_EQ(parsed->scene->deformables, spec.deformables);
  EXPECT_TRUE(parsed->scene->deformables[0].stiffness.empty());
  const DeformableObject& told = parsed->scene->deformables[1];
  const Triangle& corners = told.triangles[0];
  const double between =
      0.25 * stiffness_of_level(told.stiffness[corners[1]]) + 0.75 * stiffness_of_level(told.stiffness[corners[2]]);
  EXPECT_EQ(stiffness_at(told, 0, {0, 0.25, 0.75}), between);
}

TEST(SceneDeformables, ASceneWithoutThemHasNoByteAboutThem) {
  SceneSpec spec = two_deformables();
  spec.deformables.clear();
  const auto bytes = write_scene(*testing::shared(spec)).value();
  EXPECT_EQ(bytes[6], 0);
  EXPECT_EQ(bytes.size(), 12U + 12U + (3U + 3U + 28U) + 4U);  // fixed part, parameters and count, one object, crc
}

TEST(SceneDeformables, EveryTruncationIsRefused) {
  const auto bytes = write_scene(*testing::shared(two_deformables())).value();
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const auto parsed = parse_scene(std::span(bytes).first(size));
    ASSERT_FALSE(parsed);
    EXPECT_EQ(parsed.error().code, Errc::truncated) << size;
  }
}

TEST(SceneDeformables, EachRule) {
  const auto rule = [](const auto& change) {
    SceneSpec spec = two_deformables();
    change(spec.deformables[0]);
    const auto scene = Scene::create(std::move(spec));
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
  const SharedScene scene = testing::shared(spec);
  EXPECT_EQ(scene->deformables[0].basis.steps.size(), 5U);
  const auto bytes = write_scene(*scene).value();
  const auto parsed = parse_scene(bytes);
  ASSERT_TRUE(parsed);
  EXPECT_EQ(parsed->scene->deformables[0], scene->deformables[0]);
  spec.deformables[0].spring_basis = {};
  EXPECT_EQ(bytes.size(), write_scene(*testing::shared(spec)).value().size() + 1 + 1 + 2 * 3)
      << "mode_count, runs of fixed vertices";
}

TEST(SceneDeformables, ClustersAreToldWhereTheyAreNotExpected) {
  SceneSpec spec = two_deformables();
  DeformableObject& object = spec.deformables[0];
  object.basis = {};
  object.cluster_basis = {3, 2, std::vector<std::uint8_t>(object.rest.size(), 1)};
  object.cluster_basis.clusters.back() = 2;
  const SharedScene scene = testing::shared(spec);
  EXPECT_EQ(scene->deformables[0].basis.steps.size(), 36U);
  const auto bytes = write_scene(*scene).value();
  const auto parsed = parse_scene(bytes);
  ASSERT_TRUE(parsed);
  EXPECT_EQ(parsed->scene->deformables[0], scene->deformables[0]);
  spec.deformables[0].cluster_basis = {};
  EXPECT_EQ(bytes.size(), write_scene(*testing::shared(spec)).value().size() + 1 + 1 + 1 + 2 * 2)
      << "cluster_count, blend, surprises of the first and the last vertex";
}

TEST(SceneDeformables, RulesOfClusters) {
  const auto rule = [](const ClusterBasis& basis, std::uint8_t springs = 0, const DecodeLimits& limits = {}) {
    SceneSpec spec = two_deformables();
    spec.deformables[0].basis = {};
    spec.deformables[0].cluster_basis = basis;
    spec.deformables[0].spring_basis.modes = springs;
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
  const auto rule = [](const SpringBasis& basis, const DecodeLimits& limits = {}) {
    SceneSpec spec = two_deformables();
    spec.deformables[0].basis = {};
    spec.deformables[0].spring_basis = basis;
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
    const auto parsed = parse_deformable(reader, {1000, 1000});
    return parsed ? std::string_view("none") : std::string_view(parsed.error().rule);
  };
  // profile, name (2), rings, frame_period (4), layered, fade (2), weight_sets, vertices, triangles, 9 coordinates, 3 corners, basis
  EXPECT_EQ(rule(0, {1}), "none");
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
