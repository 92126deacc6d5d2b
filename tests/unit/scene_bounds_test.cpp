// SPDX-License-Identifier: Apache-2.0
#include <tactus/scene/bounds.h>

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include <tactus/scene/scene_syntax.h>

namespace tactus {
namespace {

/// One object that moves and two meshes, one of each profile.
StreamHeader scene() {
  StreamHeader header;
  header.objects.resize(2);
  header.objects[0].name = "cube";
  header.objects[1].name = "wall";
  header.objects[1].dof = Dof::none;
  for (const DeformableProfile profile : {DeformableProfile::main, DeformableProfile::thesis}) {
    DeformableObject& mesh = header.meshes.emplace_back();
    mesh.name = profile == DeformableProfile::main ? "main" : "thesis";
    mesh.profile = profile;
    mesh.rest = {{0, 0, 0}};
  }
  return header;
}

StreamHeader with_bounds(const RigidTriggers& rigid, const DeformableThresholds& meshes) {
  StreamHeader header = scene();
  header.bounds = bounds_of(header, rigid, meshes);
  return header;
}

RigidTriggers with_rule(HapticRule rule) {
  RigidTriggers out;
  out.haptic = rule;
  out.heartbeat = 0.3;
  out.visual_position = 0.1;
  if (rule == HapticRule::isotropic || rule == HapticRule::cone) out.weber_fraction = 1.0 / 3;
  if (rule == HapticRule::cone) out.cone_angle = 0.7;
  if (rule == HapticRule::fixed) out.fixed_rotation = 0.123;
  return out;
}

TEST(StreamBounds, WhatTheSenderPromisesArrivesToTheBit) {
  for (const HapticRule rule : {HapticRule::off, HapticRule::isotropic, HapticRule::cone, HapticRule::fixed}) {
    for (const std::optional<double> weber : {std::optional<double>(), std::optional(0.1)}) {
      DeformableThresholds meshes;
      meshes.weber_fraction = weber;
      if (weber) meshes.depth_floor = 1e-5;
      const StreamHeader header = with_bounds(with_rule(rule), meshes);
      const auto bytes = write_header(header).value();
      const auto parsed = parse_header(bytes);
      ASSERT_TRUE(parsed);
      EXPECT_EQ(parsed->header.bounds, header.bounds);
      EXPECT_EQ(write_header(parsed->header).value(), bytes);
    }
  }
}

TEST(StreamBounds, ThesisMeshesOnlyAimAtThem) {
  const StreamHeader header = with_bounds({}, {});
  EXPECT_TRUE(header.bounds->meshes[0].kept);
  EXPECT_FALSE(header.bounds->meshes[1].kept);
}

TEST(StreamBounds, AStreamWithoutThemHasNoByteAboutThem) {
  const auto without = write_header(scene()).value();
  EXPECT_FALSE(parse_header(without)->header.bounds);
  StreamHeader still = scene();
  still.objects.erase(still.objects.begin());
  still.meshes.clear();
  const std::size_t bare = write_header(still)->size();
  still.bounds = bounds_of(still, {}, {});
  EXPECT_EQ(write_header(still)->size(), bare + 2) << "type and size";
}

TEST(StreamBounds, WhatIsNoBoundIsRefused) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  const std::function<void(StreamBounds&)> changes[] = {
      [](StreamBounds& b) { b.rigid->visual_position = -0.001; },
      [](StreamBounds& b) { b.rigid->heartbeat = kInfinite; },
      [](StreamBounds& b) { b.rigid->force_floor = std::numeric_limits<double>::quiet_NaN(); },
      [](StreamBounds& b) { b.rigid.reset(); },
      [](StreamBounds& b) { b.meshes[1].thresholds.depth_floor = -0.0; },
      [](StreamBounds& b) { b.meshes.pop_back(); },
  };
  for (const auto& change : changes) {
    StreamHeader header = with_bounds({}, {});
    ASSERT_TRUE(write_header(header));
    change(*header.bounds);
    const auto bytes = write_header(header);
    ASSERT_FALSE(bytes) << &change - changes;
    EXPECT_STREQ(bytes.error().rule, "R-STR-17");
  }
}

}  // namespace
}  // namespace tactus
