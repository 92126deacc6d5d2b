// SPDX-License-Identifier: Apache-2.0
/// Animations for Foxglove.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>

#include <tactus/trace/byte_source.h>
#include <tactus/trace/cdr.h>
#include <tactus/trace/foxglove_writer.h>
#include <tactus/trace/mcap_reader.h>
#include <tactus/trace/messages.h>
#include "tests/unit/temp_file.h"

namespace tactus {
namespace {

// ==== foxglove writer ====

TraceInfo info_of() {
  TraceInfo info{.tick_rate = 1000, .objects = {{"cube"}}, .users = {{"hand"}}, .source = {}, .scene = {}};
  info.meshes.push_back({"patch", {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}});
  return info;
}

TraceFrame frame_of(std::int64_t tick) {
  TraceFrame frame{.tick = tick, .objects = {{}}, .users = {{}}};
  frame.objects[0].pose.position = {0.001 * static_cast<double>(tick), 0, 0};
  frame.users[0].force = {0, 0, -2};
  frame.meshes.push_back({tick == 50, std::vector<float>(9, 0.25F)});
  return frame;
}

/// Times of the messages of each topic [ms], of 100 ticks.
std::map<std::string, std::vector<std::uint64_t>> written(const FoxgloveOptions& options, const TraceInfo& info = info_of()) {
  const TempFile file;
  const std::string& path = file.path();
  auto writer = FoxgloveWriter::create(path, info, {{.box = {0.1, 0.1, 0.1}}}, options);
  EXPECT_TRUE(writer);
  for (std::int64_t tick = 0; tick < 100; ++tick) EXPECT_TRUE(writer->write(frame_of(tick)));
  EXPECT_TRUE(writer->finish());
  auto reader = mcap::Reader::open(*ByteSource::open_file(path));
  EXPECT_TRUE(reader);
  std::map<std::string, std::vector<std::uint64_t>> out;
  std::uint64_t count = 0;
  for (auto item = reader->next(); item && *item != mcap::Item::end; item = reader->next()) {
    if (*item != mcap::Item::message) continue;
    out[reader->channels().at(reader->message().channel_id).topic].push_back(reader->message().log_time / 1000000);
    ++count;
  }
  EXPECT_FALSE(reader->cut_short());
  EXPECT_EQ(count, writer->messages());
  return out;
}

TEST(FoxgloveWriter, KeepsToItsRate) {
  const auto times = written({.rate = 20});
  using Times = std::vector<std::uint64_t>;
  EXPECT_EQ(times.at("/tf"), (Times{0, 50}));
  EXPECT_EQ(times.at("/scene/objects"), Times{0}) << "once: it moves with its frame";
  EXPECT_EQ(times.at("/scene/meshes/patch"), (Times{0, 50})) << "at rest first, then when it is new";
  EXPECT_EQ(times.at("/scene/users/hand"), (Times{0, 50}));
  EXPECT_EQ(times.at("/users/hand/force"), (Times{0, 50}));
  EXPECT_EQ(times.at("/objects/cube/pose"), (Times{0, 50}));
}

TEST(FoxgloveWriter, ShowsAShapeThatCameBetweenItsFrames) {
  EXPECT_EQ(written({.rate = 16}).at("/scene/meshes/patch"), (std::vector<std::uint64_t>{0, 63}));
  EXPECT_EQ(written({.rate = 1e5}).at("/tf").size(), 100u) << "never more often than there are ticks";
}

TEST(FoxgloveWriter, AForceThatIsNotKnownHasNoTopic) {
  TraceInfo info = info_of();
  for (const RecordedForces known : {RecordedForces::both, RecordedForces::rendered, RecordedForces::server}) {
    info.users[0].forces = known;
    const auto times = written({.rate = 20}, info);
    EXPECT_EQ(times.contains("/users/hand/force"), known != RecordedForces::server);
    EXPECT_EQ(times.contains("/users/hand/server_force"), known != RecordedForces::rendered);
  }
}

TEST(FoxgloveWriter, RefusesWhatIsNoRate) {
  for (const double wrong : {0.0, -1.0, 1e300 * 1e300, std::nan("")}) {
    EXPECT_FALSE(FoxgloveWriter::create("/dev/null", info_of(), {}, {.rate = wrong})) << wrong;
    EXPECT_FALSE(FoxgloveWriter::create("/dev/null", info_of(), {}, {.metres_per_newton = wrong})) << wrong;
  }
}

// ==== foxglove messages ====

/// Skips an entity up to its arrows and hands out the first one's pose and lengths.
TEST(FoxgloveMessages, ArrowsPointAlongTheForce) {
  for (const Vec3 along : {Vec3{0, 0, -2}, Vec3{3, 0, 0}, Vec3{-3, 0, 0}, Vec3{-1, 2, 0.5}}) {
    const foxglove::Entity entity{.frame = "world", .id = "e", .arrows = {{{1, 2, 3}, along, 0.1, {}}}};
    std::vector<std::uint8_t> message;
    foxglove::encode_scene_update(message, 1'500'000'000, {&entity, 1});
    CdrReader in(message);
    EXPECT_EQ(in.u32(), 0u);  // deletions
    EXPECT_EQ(in.u32(), 1u);
    EXPECT_EQ(in.u32(), 1u);  // seconds
    EXPECT_EQ(in.u32(), 500'000'000u);
    EXPECT_EQ(in.text(), "world");
    EXPECT_EQ(in.text(), "e");
    EXPECT_EQ(in.u32() + in.u32(), 0u);  // lifetime
    EXPECT_EQ(in.u8(), 0u);
    EXPECT_EQ(in.u32(), 0u);  // metadata
    EXPECT_EQ(in.u32(), 1u);
    const Pose pose = in.pose();
    EXPECT_EQ(pose.position, (Vec3{1, 2, 3}));
    const double shaft = in.f64(), thickness = in.f64(), head = in.f64();
    EXPECT_EQ(thickness, 0.1);
    EXPECT_LT(norm(rotate(pose.rotation, {shaft + head, 0, 0}) - along), 1e-12);
  }
}

}  // namespace
}  // namespace tactus
