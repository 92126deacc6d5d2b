// SPDX-License-Identifier: Apache-2.0
/// The declaration of a scene, and of its bounds.
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string_view>

#include <tactus/base/bytes.h>
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

Bytes written(SceneSpec spec) { return write_scene(*testing::shared(std::move(spec), testing::kWithThesis)).value(); }

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

/// Replace the body's tail and repair size and check value.
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
  EXPECT_TRUE(Scene::create(with_models(226), testing::kWithThesis));
  EXPECT_STREQ(Scene::create(with_models(227), testing::kWithThesis).error().rule, "R-STR-18");
  EXPECT_EQ(Scene::create(with_models(227), testing::kWithThesis).error().code, Errc::limit_exceeded);
  const Bytes bytes = written(with_models(10));
  EXPECT_TRUE(parse_scene(bytes, {.state_bytes = 10 * 1183992, .thesis = &thesis_component}));
  const auto refused = parse_scene(bytes, {.state_bytes = 10 * 1183992 - 1, .thesis = &thesis_component});
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
  if (rule == HapticRule::perceptual) out.perceptual_fraction = 0.3;
  if (rule == HapticRule::fixed) out.fixed_rotation = 0.123;
  return out;
}

TEST(StreamBounds, WhatTheSenderDeclaresArrivesToTheBit) {
  for (const HapticRule rule :
       {HapticRule::off, HapticRule::isotropic, HapticRule::cone, HapticRule::fixed, HapticRule::perceptual}) {
    for (const std::optional<double> weber : {std::optional<double>(), std::optional(0.1)}) {
      DeformableThresholds deformables;
      deformables.weber_fraction = weber;
      if (weber) deformables.depth_floor = 1e-5;
      const SceneSpec spec = with_bounds(with_rule(rule), deformables);
      const auto bytes = written(spec);
      const auto parsed = parse_scene(bytes, testing::kWithThesis);
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
  EXPECT_FALSE(parse_scene(written(objects()), testing::kWithThesis)->scene->bounds);
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
    ASSERT_TRUE(check_scene(spec, testing::kWithThesis));
    change(*spec.bounds);
    const auto scene = Scene::create(spec, testing::kWithThesis);
    ASSERT_FALSE(scene) << &change - changes;
    EXPECT_EQ(scene.error().code, Errc::invalid);
    EXPECT_STREQ(scene.error().rule, "R-STR-17");
  }
}

}  // namespace
}  // namespace tactus
