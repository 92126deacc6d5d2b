// SPDX-License-Identifier: Apache-2.0
// From a scene and a replica to a trace: io/trace/trace_scene.h, and the ticks that a client shows.
#include <tactus/trace/trace_scene.h>

#include <tuple>

#include <tactus/base/rule.h>
#include <tactus/receiver.h>
#include <tactus/trace/mcap_writer.h>
#include <tactus/trace/message_schemas.h>
#include <tactus/trace/messages.h>
#include "tests/unit/trace_fixture.h"

namespace tactus {
namespace {

SharedScene scene_of(const Recording& recording) {
  TraceFrame first = recording.frames[0];
  for (RigidSample& object : first.objects) object.pose = {{0.25, -0.5, 0.125}, {}};
  return scene_builder(recording.info, first).value().declare_bounds({}, {}).build().value();
}

TEST(TraceReplica, DescribesWhatTheSceneDeclares) {
  const Recording recording = make_mesh_recording(1);
  const SharedScene scene = scene_of(recording);
  const TraceInfo info = replica_info(*scene, "a client");
  EXPECT_EQ(info.source, "a client");
  EXPECT_EQ(info.tick_rate, 1000u);
  EXPECT_FALSE(info.shows_past);
  ASSERT_EQ(info.objects.size(), 2u);
  EXPECT_EQ(info.objects[1].name, recording.info.objects[1].name);
  EXPECT_EQ(info.objects[1].dof, Dof::none);
  ASSERT_EQ(info.meshes.size(), 2u);
  EXPECT_EQ(info.meshes[0].rest.triangles, recording.info.meshes[0].rest.triangles);
  EXPECT_EQ(info.meshes[0].rest.vertices, recording.info.meshes[0].rest.vertices);
  ASSERT_TRUE(info.bounds);
  EXPECT_EQ(info.bounds->rings.size(), 2u);
}

TEST(TraceReplica, AShapeIsNewWhenAVertexIsElsewhere) {
  const SharedScene scene = scene_of(make_mesh_recording(1));
  auto receiver = Receiver::create(scene).value();
  TraceFrame frame = replica_frame(*scene);
  take_shown(receiver.replica(), *scene, 0, frame);
  EXPECT_EQ(frame.objects[0].pose.position, (Vec3{0.25, -0.5, 0.125}));
  EXPECT_FALSE(frame.meshes[0].updated);
  frame.meshes[0].displacements[11] = 1;
  take_shown(receiver.replica(), *scene, 1, frame);
  EXPECT_TRUE(frame.meshes[0].updated);
  EXPECT_FALSE(frame.meshes[1].updated);
  EXPECT_EQ(frame.meshes[0].displacements[11], 0);
}

/// What a client shows at ticks 0, 1, 2, 6, 8 ...
Recording delayed(std::vector<std::int64_t> shown) {
  Recording recording = make_recording(shown.size());
  recording.info.shows_past = true;
  for (std::size_t i = 0; i < shown.size(); ++i) recording.frames[i].shown = shown[i];
  return recording;
}

TEST(TraceReplica, TheTicksThatAClientShowsAreKept) {
  const std::vector<std::int64_t> shown{0, 0, 1, 1, 4, 5};
  const TempFile file;
  const Bytes bytes = write_recording(delayed(shown), file.path());
  EXPECT_TRUE(TraceReader::open_memory(bytes)->info().shows_past);
  const Reading reading = read_bytes(bytes);
  ASSERT_EQ(reading.frames.size(), shown.size());
  for (std::size_t i = 0; i < shown.size(); ++i) EXPECT_EQ(reading.frames[i].shown, shown[i]) << i;
}

TEST(TraceReplica, AWriterRefusesAClientThatStepsBack) {
  for (const auto& shown : {std::vector<std::int64_t>{-1}, {3, 2}, {0, kMaxSeconds * 1000}}) {
    const Recording recording = delayed(shown);
    const TempFile file;
    auto writer = TraceWriter::create(file.path(), recording.info);
    Result<void> written;
    for (const TraceFrame& frame : recording.frames) written = writer->write(frame);
    ASSERT_FALSE(written);
    EXPECT_STREQ(written.error().rule, "R-API-5");
  }
}

TEST(TraceReplica, AForceThatIsNotKnownIsMarked) {
  Recording recording = make_recording(3);
  for (const RecordedForces left : {RecordedForces::both, RecordedForces::rendered, RecordedForces::server}) {
    recording.info.users[0].forces = left;
    const TempFile file;
    const auto reader = TraceReader::open_memory(write_recording(recording, file.path()));
    ASSERT_TRUE(reader);
    EXPECT_EQ(reader->info().users[0].forces, left);
    EXPECT_EQ(reader->info().users[1].forces, RecordedForces::both);
  }
}

/// A user of whose two forces the channels say this.
std::string rule_of_forces(const char* rendered, const char* server) {
  const TempFile file;
  auto out = mcap::Writer::create(file.path(), "ros2").value();
  EXPECT_TRUE(out.add(mcap::Metadata{"tactus", {{"format_version", "2"}, {"tick_rate", "1000"}, {"users", "hand"}}}));
  const std::tuple<const char*, MessageType, const char*> channels[]{{"/users/hand/device", MessageType::point, ""},
                                                                     {"/users/hand/force", MessageType::vector, rendered},
                                                                     {"/users/hand/server_force", MessageType::vector, server},
                                                                     {"/users/hand/contact", MessageType::contact, ""}};
  std::uint16_t id = 0;
  for (const auto& [topic, type, known] : channels) {
    ++id;
    EXPECT_TRUE(out.add(mcap::Schema{id, std::string(schema_name(type)), "ros2msg", schema_text(type)}));
    EXPECT_TRUE(out.add(mcap::Channel{id, id, topic, "cdr", {{"known", known}}}));
  }
  EXPECT_TRUE(out.finish());
  const Reading reading = read_bytes(file.bytes());
  return reading.error ? reading.error->rule : "";
}

TEST(TraceReplica, AReaderRefusesAUserOfWhomNoForceIsKnown) {
  EXPECT_EQ(rule_of_forces("", ""), "");
  EXPECT_EQ(rule_of_forces("no", "anything"), "");
  EXPECT_EQ(rule_of_forces("no", "no"), "R-TRC-12");
}

/// Two frames of a cube, and the times of what they show.
std::string rule_of(std::int64_t first, std::int64_t second) {
  const TempFile file;
  auto out = mcap::Writer::create(file.path(), "ros2").value();
  EXPECT_TRUE(out.add(mcap::Metadata{"tactus", {{"format_version", "2"}, {"tick_rate", "3000"}, {"objects", "cube"}}}));
  const std::pair<const char*, MessageType> channels[]{{"/objects/cube/pose", MessageType::pose},
                                                       {"/objects/cube/twist", MessageType::twist},
                                                       {"/shown", MessageType::time_reference}};
  for (std::uint16_t id = 0; id < 3; ++id) {
    const auto schema = static_cast<std::uint16_t>(id + 1);
    const MessageType type = channels[id].second;
    EXPECT_TRUE(out.add(mcap::Schema{schema, std::string(schema_name(type)), "ros2msg", schema_text(type)}));
    EXPECT_TRUE(out.add(mcap::Channel{id, schema, channels[id].first, "cdr", {{"dof", "63"}}}));
  }
  const std::int64_t shown[]{first, second};
  for (std::uint32_t tick = 0; tick < 2; ++tick) {
    const std::uint64_t time = time_of_tick(tick, 3000);
    Bytes messages[3];
    encode_pose(messages[0], time, {});
    encode_twist(messages[1], time, {});
    encode_time_reference(messages[2], time, shown[tick]);
    for (std::uint16_t id = 0; id < 3; ++id) out.add(mcap::Message{id, tick, time, time, messages[id]});
  }
  EXPECT_TRUE(out.finish());
  const Reading reading = read_bytes(file.bytes());
  return reading.error ? reading.error->rule : "";
}

TEST(TraceReplica, AReaderRefusesTimesThatAreNotOfTicks) {
  EXPECT_EQ(rule_of(333'333, 666'667), "");
  EXPECT_EQ(rule_of(333'333, 333'333), "");
  EXPECT_EQ(rule_of(333'333, 0), "R-TRC-15");
  EXPECT_EQ(rule_of(333'333, 666'666), "R-TRC-15");
}

}  // namespace
}  // namespace tactus
