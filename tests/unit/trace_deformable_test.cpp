// SPDX-License-Identifier: Apache-2.0
// Meshes in traces: io/trace/trace_file.h, messages.h.
#include <gtest/gtest.h>

#include <limits>
#include <map>

#include <tactus/base/bytes.h>
#include <tactus/trace/mcap_reader.h>
#include <tactus/trace/mcap_writer.h>
#include <tactus/trace/message_schemas.h>
#include <tactus/trace/messages.h>
#include "tests/unit/trace_fixture.h"

namespace tactus {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

void expect_equal(const std::vector<TraceFrame>& frames, const Recording& recording) {
  ASSERT_EQ(frames.size(), recording.frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) ASSERT_EQ(image(frames[i]), image(recording.frames[i])) << "frame " << i;
}

TEST(MeshTrace, RoundTripIsExactToTheBit) {
  const Recording recording = make_mesh_recording(50);
  const TempFile file;
  const Bytes bytes = write_recording(recording, file.path());
  auto reader = TraceReader::open_memory(bytes);
  ASSERT_TRUE(reader) << reader.error().rule;
  const TraceInfo info = reader->info();
  ASSERT_EQ(info.meshes.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(info.meshes[i].name, recording.info.meshes[i].name);
    EXPECT_EQ(info.meshes[i].rest.vertices, recording.info.meshes[i].rest.vertices);
    EXPECT_EQ(info.meshes[i].rest.triangles, recording.info.meshes[i].rest.triangles);
  }
  EXPECT_EQ(reader->frame_count(), 50u);
  const Reading reading = read_all(std::move(reader));
  EXPECT_FALSE(reading.error);
  expect_equal(reading.frames, recording);
}

/// A recording cannot tell what moved, whatever the frame said that it is read into.
TEST(MeshTrace, WhatChangedIsNotInAFile) {
  const TempFile file;
  const Bytes bytes = write_recording(make_mesh_recording(3), file.path());
  auto reader = TraceReader::open_memory(bytes);
  ASSERT_TRUE(reader);
  TraceFrame frame;
  for (int i = 0; i < 3; ++i) {
    frame.changed.emplace();
    ASSERT_TRUE(reader->next(frame).value());
    EXPECT_FALSE(frame.changed);
  }
}

/// Everything that stands in a file, but not how it was compressed.
std::uint64_t content_hash(std::span<const std::uint8_t> bytes) {
  Fnv1a hash;
  const auto put = [&hash](std::string_view text) {
    for (const char c : text) hash.add_byte(static_cast<std::uint8_t>(c));
  };
  auto reader = mcap::Reader::open(ByteSource::over_memory(bytes)).value();
  for (auto item = reader.next(); item && *item != mcap::Item::end; item = reader.next()) {
    if (*item == mcap::Item::metadata)
      for (const auto& [key, value] : reader.metadata().entries) put(key), put(value);
    if (*item != mcap::Item::message) continue;
    hash.add32(std::uint32_t{reader.message().channel_id});
    for (const std::uint8_t byte : reader.message().data) hash.add_byte(byte);
  }
  for (const auto& [id, schema] : reader.schemas()) hash.add32(std::uint32_t{id}), put(schema.name), put(schema.data);
  for (const auto& [id, channel] : reader.channels())
    hash.add32(std::uint32_t{id}), hash.add32(std::uint32_t{channel.schema_id}), put(channel.topic);
  return hash.value();
}

TEST(MeshTrace, WithoutMeshesAndWithPlainDevicesNothingChanged) {
  const TempFile file;
  Recording recording = make_recording(12);
  recording.info.users[0].senses = {};
  // Computed with neither in the program, but for the format version, which became 2.
  EXPECT_EQ(content_hash(write_recording(recording, file.path())), 10957181023397424448u);
}

TEST(MeshTrace, MeshesAloneStillCarryTicks) {
  Recording recording = make_mesh_recording(5);
  recording.info.objects.clear();
  recording.info.users.clear();
  for (TraceFrame& frame : recording.frames) frame.objects.clear(), frame.users.clear();
  const TempFile file;
  const Reading reading = read_bytes(write_recording(recording, file.path()));
  EXPECT_FALSE(reading.error);
  for (TraceFrame& frame : recording.frames) frame.meshes[0].updated = true;  // it came every tick
  expect_equal(reading.frames, recording);
}

TEST(MeshTrace, FixedVerticesAndPeriodAreKept) {
  Recording recording = make_mesh_recording(3);
  recording.info.meshes[0].fixed = {0, 3};
  recording.info.meshes[0].period = 50.0 / 3;
  const TempFile file;
  const Bytes bytes = write_recording(recording, file.path());
  const auto reader = TraceReader::open_memory(bytes);
  ASSERT_TRUE(reader) << reader.error().rule;
  EXPECT_EQ(reader->info().meshes[0].fixed, recording.info.meshes[0].fixed);
  EXPECT_EQ(reader->info().meshes[0].period, recording.info.meshes[0].period);
  EXPECT_TRUE(reader->info().meshes[1].fixed.empty());
  EXPECT_EQ(reader->info().meshes[1].period, 1);
}

TEST(MeshTrace, WriterRefusesWhatATraceCannotHold) {
  const TempFile file;
  const Recording recording = make_mesh_recording(4);
  const auto rule = [&](auto change) {
    TraceInfo info = recording.info;
    change(info);
    const auto writer = TraceWriter::create(file.path(), info);
    return std::string(writer ? "" : writer.error().rule);
  };
  EXPECT_EQ(rule([](TraceInfo& i) { i.meshes[1].name = "blob"; }), "R-TRC-17");
  EXPECT_EQ(rule([](TraceInfo& i) { i.meshes[0].name = "a/b"; }), "R-TRC-17");
  EXPECT_EQ(rule([](TraceInfo& i) { i.meshes[0].rest.vertices[0].x = HUGE_VAL; }), "R-SRF-8");
  EXPECT_EQ(rule([](TraceInfo& i) { i.meshes[0].rest.triangles[2][1] = 4; }), "R-SRF-9");
  EXPECT_EQ(rule([](TraceInfo& i) { i.meshes[0].fixed = {4}; }), "R-TRC-17");
  EXPECT_EQ(rule([](TraceInfo& i) { i.meshes[0].fixed = {1, 1}; }), "R-TRC-17");
  EXPECT_EQ(rule([](TraceInfo& i) { i.meshes[0].period = static_cast<double>(kNan); }), "R-TRC-17");
  EXPECT_EQ(rule([](TraceInfo& i) { i.meshes[0].period = 0; }), "R-TRC-17");

  auto writer = TraceWriter::create(file.path(), recording.info);
  ASSERT_TRUE(writer);
  const auto refused = [&](auto change) {
    TraceFrame frame = recording.frames[2];
    change(frame);
    const auto written = writer->write(frame);
    return std::string(written ? "" : written.error().rule);
  };
  EXPECT_EQ(refused([](TraceFrame& f) { f.meshes.pop_back(); }), "R-API-5");
  EXPECT_EQ(refused([](TraceFrame& f) { f.meshes[1].displacements.pop_back(); }), "R-API-5");
  EXPECT_EQ(refused([](TraceFrame& f) { f.meshes[1].updated = true, f.meshes[1].displacements[3] = kNan; }), "R-API-1");
  EXPECT_EQ(refused([](TraceFrame& f) { f.users[1].surface_contact->mesh = 2; }), "R-API-5");
  EXPECT_EQ(refused([](TraceFrame& f) { f.users[1].surface_contact->triangle = 4; }), "R-API-5");
  EXPECT_EQ(refused([](TraceFrame& f) { f.users[1].surface_contact->weights[0] = 0.3; }), "R-API-5");
  EXPECT_EQ(refused([](TraceFrame& f) { f.users[1].surface_contact->weights = {1.5, -0.5, 0}; }), "R-API-5");
  EXPECT_EQ(refused([](TraceFrame& f) { f.users[1].surface_contact->weights[2] = static_cast<double>(kNan); }), "R-API-5");
  EXPECT_EQ(refused([](TraceFrame& f) { f.users[1].surface_contact->proxy.z = HUGE_VAL; }), "R-API-5");
  EXPECT_EQ(refused([](TraceFrame& f) { f.users[1].surface_contact->stiffness = 0; }), "R-API-5");
  EXPECT_EQ(refused([](TraceFrame&) {}), "");
}

TEST(MeshTrace, EveryTruncationIsAnErrorOrAWholePrefix) {
  const Recording recording = make_mesh_recording(6);
  const TempFile file;
  const Bytes bytes = write_recording(recording, file.path());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const Reading reading = read_bytes(std::span(bytes).first(size));
    ASSERT_TRUE(reading.error || reading.cut_short) << size;
    if (reading.error) {
      ASSERT_EQ(reading.error->code, Errc::truncated) << size << " " << reading.error->rule;
    }
    for (std::size_t i = 0; i < reading.frames.size(); ++i) ASSERT_EQ(image(reading.frames[i]), image(recording.frames[i]));
  }
}

TEST(MeshTrace, DamageIsAnErrorOrLeavesAReadableFile) {
  const Recording recording = make_mesh_recording(2);
  const TempFile file;
  Bytes damaged = write_recording(recording, file.path());
  std::size_t errors = 0;
  for (std::size_t i = 0; i < damaged.size(); ++i) {
    const std::uint8_t right = damaged[i];
    damaged[i] = static_cast<std::uint8_t>(right ^ (1u << (i % 8)));
    const Reading reading = read_bytes(damaged);
    errors += reading.error.has_value();
    ASSERT_LE(reading.frames.size(), recording.frames.size());
    damaged[i] = right;
  }
  EXPECT_GT(errors, damaged.size() / 2);
}

/// A file whose metadata announces one mesh "m", with these messages in its first tick (topic, bytes) besides the user's.
class Forgery {
 public:
  Forgery() {
    encode_mesh(rest_, square());
    const std::vector<float> zeros(12);
    encode_displacements(displacement_, 0, zeros);
    encode_mesh_contact(contact_, 0, {0, 1, {0.5, 0.25, 0.25}, {}, {0, 0, 1}, 20}, "m");
  }
  static TriMesh square() { return {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}}; }

  Bytes rest_, displacement_, contact_;

  std::string rule() const {
    const TempFile file;
    write(file.path());
    const Reading reading = read_bytes(file.bytes());
    return reading.error ? reading.error->rule : "";
  }

 private:
  void write(const std::string& path) const {
    auto out = mcap::Writer::create(path, "ros2").value();
    ASSERT_TRUE(
        out.add(mcap::Metadata{"tactus", {{"format_version", "1"}, {"tick_rate", "1000"}, {"users", "u"}, {"meshes", "m"}}}));
    Bytes vector;
    encode_vector(vector, 0, {});
    const std::vector<std::tuple<const char*, MessageType, const Bytes*>> channels{
        {"/users/u/device", MessageType::point, &vector},
        {"/users/u/force", MessageType::vector, &vector},
        {"/users/u/server_force", MessageType::vector, &vector},
        {"/users/u/contact", MessageType::contact, nullptr},
        {"/meshes/m/rest", MessageType::mesh, &rest_},
        {"/meshes/m/displacement", MessageType::displacements, &displacement_},
        {"/users/u/mesh_contact", MessageType::surface_contact, &contact_}};
    std::uint16_t id = 0;
    for (const auto& [topic, type, message] : channels) {
      const auto schema = static_cast<std::uint16_t>(100 + id);
      ASSERT_TRUE(out.add(mcap::Schema{schema, std::string(schema_name(type)), "ros2msg", schema_text(type)}));
      ASSERT_TRUE(out.add(mcap::Channel{id++, schema, topic, "cdr", {}}));
    }
    for (id = 0; id < channels.size(); ++id)
      if (const Bytes* message = std::get<2>(channels[id]); message && !message->empty())
        out.add(mcap::Message{id, 0, 0, 0, *message});
    ASSERT_TRUE(out.finish());
  }
};

/// Little-endian words of a message, behind the encapsulation header.
void put_word(Bytes& message, std::size_t word, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) message.at(4 + 4 * word + i) = static_cast<std::uint8_t>(value >> (8 * i));
}

TEST(MeshTrace, ReaderReportsEachKindOfWrongMessage) {
  const auto rule = [](auto change) {
    Forgery forgery;
    change(forgery);
    return forgery.rule();
  };
  EXPECT_EQ(rule([](Forgery&) {}), "");
  EXPECT_EQ(rule([](Forgery& f) { f.displacement_.clear(); }), "") << "at rest";
  EXPECT_EQ(rule([](Forgery& f) { f.rest_.clear(); }), "R-TRC-14") << "displacements of nothing";
  EXPECT_EQ(rule([](Forgery& f) { f.rest_.clear(), f.displacement_.clear(), f.contact_.clear(); }), "R-TRC-15");
  EXPECT_EQ(rule([](Forgery& f) { f.rest_[1] = 0; }), "R-TRC-7") << "big-endian";
  EXPECT_EQ(rule([](Forgery& f) { f.rest_.pop_back(); }), "R-TRC-13");
  EXPECT_EQ(rule([](Forgery& f) { f.rest_.resize(f.rest_.size() + 8); }), "R-TRC-13");
  EXPECT_EQ(rule([](Forgery& f) { put_word(f.rest_, 0, 0xFFFFFFFF); }), "R-TRC-13") << "more triangles than bytes";
  EXPECT_EQ(rule([](Forgery& f) { put_word(f.rest_, 7, 0x0FFFFFFF); }), "R-TRC-13") << "more vertices than bytes";
  EXPECT_EQ(rule([](Forgery& f) { put_word(f.rest_, 1, 4); }), "R-SRF-9");
  EXPECT_EQ(rule([](Forgery& f) { put_word(f.rest_, 1, 1); }), "R-SRF-10");
  EXPECT_EQ(rule([](Forgery& f) { put_word(f.rest_, 9, 0x7FF00000); }), "R-SRF-8") << "infinite";
  EXPECT_EQ(rule([](Forgery& f) { encode_mesh(f.rest_, {}); }), "R-TRC-14") << "displacements of another mesh";
  EXPECT_EQ(rule([](Forgery& f) { f.displacement_.pop_back(); }), "R-TRC-13");
  EXPECT_EQ(rule([](Forgery& f) { encode_displacements(f.displacement_, 0, std::vector<float>(11)); }), "R-TRC-14");
  EXPECT_EQ(rule([](Forgery& f) { encode_displacements(f.displacement_, 0, std::vector<float>(12, kNan)); }), "R-TRC-14");
  EXPECT_EQ(rule([](Forgery& f) { encode_displacements(f.displacement_, 5, std::vector<float>(12)); }), "R-TRC-15");
  const SurfaceContact good{0, 0, {1, 0, 0}, {}, {0, 0, 1}, 20};
  const auto contact = [&](auto change) {
    return rule([&](Forgery& f) {
      SurfaceContact wrong = good;
      change(wrong);
      encode_mesh_contact(f.contact_, 0, wrong, "m");
    });
  };
  EXPECT_EQ(contact([](SurfaceContact&) {}), "");
  EXPECT_EQ(contact([](SurfaceContact& c) { c.mesh = 1; }), "R-TRC-14");
  EXPECT_EQ(contact([](SurfaceContact& c) { c.triangle = 2; }), "R-TRC-14");
  EXPECT_EQ(contact([](SurfaceContact& c) { c.weights = {0, 0, 0}; }), "R-TRC-14");
  EXPECT_EQ(contact([](SurfaceContact& c) { c.normal.x = static_cast<double>(kNan); }), "R-TRC-14");
  EXPECT_EQ(contact([](SurfaceContact& c) { c.stiffness = -1; }), "R-TRC-14");
}

}  // namespace
}  // namespace tactus
