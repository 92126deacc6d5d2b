// SPDX-License-Identifier: Apache-2.0
#include <tactus/scene/scene_objects.h>

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include <tactus/scene/scene_syntax.h>

namespace tactus {
namespace {

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

std::vector<std::uint8_t> written(const SceneSpec& spec) { return write_scene(*Scene::create(spec).value()).value(); }

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

}  // namespace
}  // namespace tactus
