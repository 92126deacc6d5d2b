// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/trace_bounds.h>

#include <gtest/gtest.h>

#include <functional>

#include "tests/unit/trace_fixture.h"

namespace tactus {
namespace {

TraceBounds some_bounds(std::size_t meshes) {
  TraceBounds bounds;
  bounds.position_exp = 19;
  RigidTriggers& rigid = bounds.stream.rigid.emplace();
  rigid.haptic = HapticRule::cone;
  rigid.visual_position = 0.1;
  rigid.weber_fraction = 1.0 / 3;
  for (std::size_t i = 0; i < meshes; ++i) {
    DeformableBounds& mesh = bounds.stream.deformables.emplace_back();
    mesh.kept = i == 0;
    if (i == 1) mesh.thresholds = {1.0 / 7, std::nullopt};
    bounds.rings.push_back(static_cast<std::uint8_t>(i + 4));
  }
  return bounds;
}

TraceInfo with_meshes(std::size_t count) {
  TraceInfo info;
  for (std::size_t i = 0; i < count; ++i) info.meshes.push_back({"mesh " + std::to_string(i), {}});
  return info;
}

TEST(TraceBounds, RoundTripIsExactToTheBit) {
  for (const HapticRule rule :
       {HapticRule::off, HapticRule::isotropic, HapticRule::cone, HapticRule::fixed, HapticRule::perceptual}) {
    TraceBounds bounds = some_bounds(2);
    bounds.stream.rigid = RigidTriggers{.haptic = rule};
    const auto read = bounds_from(entries_of(bounds), with_meshes(2));
    ASSERT_TRUE(read);
    EXPECT_EQ(read->stream, bounds.stream);
    EXPECT_EQ(read->rings, bounds.rings);
    EXPECT_EQ(read->position_exp, 19);
  }
}

TEST(TraceBounds, ATraceHandsThemOver) {
  Recording recording = make_recording(3);
  recording.info.bounds = some_bounds(0);
  const TempFile file;
  write_recording(recording, file.path());
  const auto reader = TraceReader::open(file.path());
  ASSERT_TRUE(reader);
  ASSERT_TRUE(reader->info().bounds);
  EXPECT_EQ(reader->info().bounds->stream, recording.info.bounds->stream);
  recording.info.bounds.reset();
  write_recording(recording, file.path());
  EXPECT_FALSE(TraceReader::open(file.path())->info().bounds);
}

TEST(TraceBounds, EntriesThatAreMissingOrWrongAreRefused) {
  const mcap::TextMap good = entries_of(some_bounds(1));
  ASSERT_TRUE(bounds_from(good, with_meshes(1)));
  for (const auto& [key, value] : good) {
    if (key == "heartbeat" || key == "meshes/0/weber_fraction") continue;  // without it there is none such
    mcap::TextMap without = good;
    without.erase(key);
    EXPECT_FALSE(bounds_from(without, with_meshes(1))) << key;
  }
  for (const auto& [key, value] : mcap::TextMap{{"haptic", "square"},
                                                {"visual_position", "-1"},
                                                {"meshes/0/kept", "2"},
                                                {"meshes/0/rings", "33"},
                                                {"position_exp", "31"},
                                                {"heartbeat", "inf"}}) {
    mcap::TextMap wrong = good;
    wrong[key] = value;
    EXPECT_FALSE(bounds_from(wrong, with_meshes(1))) << key;
  }
  EXPECT_FALSE(bounds_from(good, with_meshes(2)));
}

TEST(TraceBounds, BoundsOfOtherMeshesAreNotWritten) {
  Recording recording = make_recording(3);
  recording.info.bounds = some_bounds(1);
  const TempFile file;
  const auto writer = TraceWriter::create(file.path(), recording.info);
  ASSERT_FALSE(writer);
  EXPECT_STREQ(writer.error().rule, "R-TRC-17");
}

}  // namespace
}  // namespace tactus
