// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/trace_file.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include <tactus/base/bytes.h>
#include <tactus/trace/byte_source.h>
#include <tactus/trace/cdr.h>
#include <tactus/trace/mcap_reader.h>
#include <tactus/trace/mcap_writer.h>
#include <tactus/trace/message_schemas.h>
#include <tactus/trace/messages.h>
#include "tests/unit/rule_fixture.h"
#include "tests/unit/trace_fixture.h"

namespace tactus {
namespace {

void expect_prefix(const Recording& recording, const std::vector<TraceFrame>& frames) {
  ASSERT_LE(frames.size(), recording.frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) ASSERT_EQ(image(frames[i]), image(recording.frames[i])) << "frame " << i;
}

TEST(Trace, RoundTripIsExactToTheBit) {
  for (const std::uint32_t rate : {1u, 148u, 1000u, 999'983u, 1'000'000u}) {
    const Recording recording = make_recording(200, rate);
    const TempFile file;
    write_recording(recording, file.path());
    auto reader = TraceReader::open(file.path());
    ASSERT_TRUE(reader);
    EXPECT_EQ(reader->info().tick_rate, rate);
    EXPECT_EQ(reader->info().source, "test");
    EXPECT_EQ(reader->info().scene, recording.info.scene);
    EXPECT_EQ(reader->info().users, recording.info.users);
    ASSERT_EQ(reader->info().objects.size(), 2u);
    EXPECT_EQ(reader->info().objects[1].name, recording.info.objects[1].name);
    EXPECT_EQ(reader->info().objects[1].dof, Dof::none);
    EXPECT_EQ(reader->frame_count(), 200u);
    const Reading reading = read_all(std::move(reader));
    EXPECT_FALSE(reading.error);
    EXPECT_FALSE(reading.cut_short);
    EXPECT_EQ(reading.frames.size(), 200u);
    expect_prefix(recording, reading.frames);
  }
}

TEST(Trace, EqualRecordingsGiveEqualBytes) {
  const TempFile a, b;
  EXPECT_EQ(write_recording(make_recording(50), a.path()), write_recording(make_recording(50), b.path()));
}

TEST(Trace, TickAndTimeBelongTogether) {
  std::mt19937_64 random(3);
  for (const std::uint32_t rate : {1u, 3u, 148u, 1000u, 44'100u, 999'999u, 1'000'000u}) {
    for (int i = 0; i < 10'000; ++i) {
      const auto tick = static_cast<std::int64_t>(random() % (static_cast<std::uint64_t>(kMaxSeconds) * rate));
      ASSERT_EQ(tick_of_time(time_of_tick(tick, rate), rate), tick) << rate;
    }
  }
}

TEST(Trace, OnlyStaticObjectsStillCarryTicks) {
  const TempFile file;
  Recording recording;
  recording.info.objects = {{"wall", Dof::none}, {"floor", Dof::none}};
  for (const std::int64_t tick : {0, 5, 6})
    recording.frames.push_back({tick, {{{{1, 2, 3}, {}}, {}, {}}, {{{4, 5, 6}, {}}, {}, {}}}, {}});
  const Reading reading = read_bytes(write_recording(recording, file.path()));
  EXPECT_EQ(reading.frames.size(), 3u);
  expect_prefix(recording, reading.frames);
}

TEST(Trace, UserWithoutObjects) {
  const TempFile file;
  Recording recording;
  recording.info.users = {{"hand"}};
  for (std::int64_t tick = 0; tick < 4; ++tick) {
    UserSample user;
    user.device.position = {static_cast<double>(tick), 0.5, 0};
    recording.frames.push_back({tick, {}, {user}});
  }
  const Reading reading = read_bytes(write_recording(recording, file.path()));
  EXPECT_EQ(reading.frames.size(), 4u);
  expect_prefix(recording, reading.frames);
}

TEST(Trace, WriterRefusesWhatATraceCannotHold) {
  const TempFile file;
  const auto rule = [&](const TraceInfo& info) {
    const auto writer = TraceWriter::create(file.path(), info);
    return std::string(writer ? "" : writer.error().rule);
  };
  EXPECT_EQ(rule({}), "R-TRC-17");
  EXPECT_EQ(rule({1000, {{"a/b", Dof::all}}, {}, "", ""}), "R-TRC-17");
  EXPECT_EQ(rule({1000, {{"", Dof::all}}, {}, "", ""}), "R-TRC-17");
  EXPECT_EQ(rule({1000, {{"a", Dof::all}, {"a", Dof::all}}, {}, "", ""}), "R-TRC-17");
  EXPECT_EQ(rule({1000, {{"a\n", Dof::all}}, {}, "", ""}), "R-TRC-17");
  EXPECT_EQ(rule({1000, {{"\xC0\x80", Dof::all}}, {}, "", ""}), "R-TRC-17");
  EXPECT_EQ(rule({1000, {{"a", 64}}, {}, "", ""}), "R-TRC-17");
  EXPECT_EQ(rule({0, {{"a", Dof::all}}, {}, "", ""}), "R-TRC-17");
  EXPECT_EQ(rule({1000, {{"a", Dof::all}}, {}, "\xFF", ""}), "R-TRC-11");

  const Recording recording = make_recording(4);
  auto writer = TraceWriter::create(file.path(), recording.info);
  ASSERT_TRUE(writer);
  ASSERT_TRUE(writer->write(recording.frames[0]));
  const auto refused = [&](auto change) {
    TraceFrame frame = recording.frames[1];
    change(frame);
    const auto written = writer->write(frame);
    return std::string(written ? "" : written.error().rule);
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refused([](TraceFrame& f) { f.tick = 0; }), "R-API-5");
  EXPECT_EQ(refused([](TraceFrame& f) { f.tick = std::numeric_limits<std::int64_t>::max(); }), "R-API-5");
  EXPECT_EQ(refused([](TraceFrame& f) { f.users.pop_back(); }), "R-API-5");
  EXPECT_EQ(refused([](TraceFrame& f) { f.users[0].contact.object = 2; }), "R-API-5");
  EXPECT_EQ(refused([](TraceFrame& f) { f.users[0].contact.stiffness = 0; }), "R-API-5");
  EXPECT_EQ(refused([](TraceFrame& f) { f.users[0].device.position.x += 1; }), "R-API-5")
      << "a contact with another device sample";
  EXPECT_EQ(refused([](TraceFrame& f) { f.users[1].device.time = -1; }), "R-API-5");
  EXPECT_EQ(refused([](TraceFrame& f) { f.users[1].device.orientation.w = kNan; }), "R-API-1");
  EXPECT_EQ(refused([](TraceFrame& f) { f.objects[0].pose.rotation.z = kNan; }), "R-API-1");
  EXPECT_EQ(refused([](TraceFrame& f) { f.users[1].force.y = -HUGE_VAL; }), "R-API-1");
  EXPECT_EQ(refused([](TraceFrame& f) { f.objects[1].pose.position.x += 1; }), "R-API-6");
  EXPECT_EQ(refused([](TraceFrame& f) { f.objects[1].velocity.x = 1; }), "R-API-6");
  for (std::size_t i = 1; i < 4; ++i) ASSERT_TRUE(writer->write(recording.frames[i]));
  ASSERT_TRUE(writer->finish());
  const Reading reading = read_bytes(file.bytes());  // the refused frames left no trace
  EXPECT_EQ(reading.frames.size(), 4u);
  expect_prefix(recording, reading.frames);
}

TEST(Trace, AWriterThatIsDestroyedLeavesAReadableFile) {
  const Recording recording = make_recording(20);
  const TempFile file;
  {
    auto writer = TraceWriter::create(file.path(), recording.info);
    ASSERT_TRUE(writer);
    for (const TraceFrame& frame : recording.frames) ASSERT_TRUE(writer->write(frame));
  }
  auto reader = TraceReader::open(file.path());
  ASSERT_TRUE(reader);
  EXPECT_FALSE(reader->frame_count());
  const Reading reading = read_all(std::move(reader));
  EXPECT_TRUE(reading.cut_short);
  EXPECT_EQ(reading.frames.size(), 20u);
  expect_prefix(recording, reading.frames);
}

TEST(Trace, ACutFileReadsToItsLastWholeChunk) {
  const Recording recording = make_recording(2500);  // 5 s: a chunk a second
  const TempFile file;
  const Bytes bytes = write_recording(recording, file.path());
  const Reading reading = read_bytes(std::span(bytes).first(bytes.size() / 2));
  EXPECT_FALSE(reading.error);
  EXPECT_TRUE(reading.cut_short);
  EXPECT_GE(reading.frames.size(), 500u);
  EXPECT_LT(reading.frames.size(), 2500u);
  expect_prefix(recording, reading.frames);
}

TEST(Trace, EveryTruncationIsAnErrorOrAWholePrefix) {
  const Recording recording = make_recording(12);
  const TempFile file;
  const Bytes bytes = write_recording(recording, file.path());
  std::size_t readable = 0;
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const Reading reading = read_bytes(std::span(bytes).first(size));
    ASSERT_TRUE(reading.error || reading.cut_short) << size;
    if (reading.error) {
      ASSERT_EQ(reading.error->code, Errc::truncated) << size << " " << reading.error->rule;
    }
    expect_prefix(recording, reading.frames);
    readable += reading.frames.size() == recording.frames.size();
  }
  EXPECT_GT(readable, 0u);
  EXPECT_TRUE(read_bytes(bytes).error == std::nullopt);
  Bytes longer = bytes;
  longer.push_back(0);
  EXPECT_STREQ(read_bytes(longer).error.value().rule, "R-TRC-2");
}

TEST(Trace, DamageIsAnErrorOrLeavesAReadableFile) {
  const Recording recording = make_recording(2);
  const TempFile file;
  const Bytes bytes = write_recording(recording, file.path());
  std::size_t errors = 0;
  const auto check = [&](const Bytes& damaged) {
    const Reading reading = read_bytes(damaged);
    if (reading.error) {
      ++errors;
      ASSERT_EQ(std::string_view(reading.error->rule).substr(0, 6), "R-TRC-");
      ASSERT_LE(reading.error->bit_offset, 8 * damaged.size());
    }
    ASSERT_LE(reading.frames.size(), recording.frames.size());
  };
  Bytes damaged = bytes;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      damaged[i] = static_cast<std::uint8_t>(bytes[i] ^ (1u << bit));
      check(damaged);
    }
    for (const std::uint8_t value : {std::uint8_t{0x00}, std::uint8_t{0xFF}}) {
      damaged[i] = value;
      check(damaged);
    }
    damaged[i] = bytes[i];
  }
  EXPECT_GT(errors, bytes.size());  // most damage is noticed
}

// ---- files that no writer of ours makes ----

void put_text(ByteWriter& out, std::string_view text) {
  out.u32(static_cast<std::uint32_t>(text.size()));
  out.bytes({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

void put_record(ByteWriter& out, mcap::Opcode opcode, std::span<const std::uint8_t> content) {
  out.u8(static_cast<std::uint8_t>(opcode));
  out.u64(content.size());
  out.bytes(content);
}

Bytes schema_record(std::uint16_t id, MessageType type) {
  Bytes content, record;
  ByteWriter out(content), whole(record);
  out.u16(id);
  put_text(out, schema_name(type));
  put_text(out, "ros2msg");
  put_text(out, schema_text(type));
  put_record(whole, mcap::Opcode::schema, content);
  return record;
}

Bytes channel_record(std::uint16_t id, std::uint16_t schema, std::string_view topic) {
  Bytes content, record;
  ByteWriter out(content), whole(record);
  out.u16(id);
  out.u16(schema);
  put_text(out, topic);
  put_text(out, "cdr");
  out.u32(0);
  put_record(whole, mcap::Opcode::channel, content);
  return record;
}

Bytes message_record(std::uint16_t channel, std::uint64_t time, std::span<const std::uint8_t> data) {
  Bytes content, record;
  ByteWriter out(content), whole(record);
  out.u16(channel);
  out.u32(0);
  out.u64(time);
  out.u64(time);
  out.bytes(data);
  put_record(whole, mcap::Opcode::message, content);
  return record;
}

Bytes pose_record(std::uint16_t channel, std::uint64_t time, const Pose& pose) {
  Bytes data;
  encode_pose(data, time, pose);
  return message_record(channel, time, data);
}

struct ChunkClaim {
  std::string_view compression;
  std::uint64_t size = 0;
};

Bytes chunk_record(const ChunkClaim& claim, std::span<const std::uint8_t> records) {
  Bytes content, record;
  ByteWriter out(content), whole(record);
  out.u64(0);
  out.u64(0);
  out.u64(claim.size);
  out.u32(0);
  put_text(out, claim.compression);
  out.u64(records.size());
  out.bytes(records);
  put_record(whole, mcap::Opcode::chunk, content);
  return record;
}

/// Magic, header, the given records, data end, footer, magic; no check values, as the format allows.
Bytes file_of(const std::vector<Bytes>& records) {
  Bytes bytes, header;
  ByteWriter out(bytes), header_out(header);
  out.bytes(mcap::kMagic);
  put_text(header_out, "ros2");
  put_text(header_out, "somebody else");
  put_record(out, mcap::Opcode::header, header);
  for (const Bytes& record : records) out.bytes(record);
  put_record(out, mcap::Opcode::data_end, Bytes(4));
  put_record(out, mcap::Opcode::footer, Bytes(mcap::kFooterContent));
  out.bytes(mcap::kMagic);
  return bytes;
}

std::string rule_of(const std::vector<Bytes>& records) {
  const Reading reading = read_bytes(file_of(records));
  return reading.error ? reading.error->rule : "";
}

Bytes join(const std::vector<Bytes>& parts) {
  Bytes all;
  for (const Bytes& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

constexpr std::uint64_t kStart = 1'700'000'000'000'000'000;  // [ns] a wall clock, as recorders use

TEST(Trace, ForeignRecordingBecomesObjects) {
  Bytes twist;
  encode_twist(twist, kStart, {{1, 2, 3}, {4, 5, 6}});
  std::vector<Bytes> records{schema_record(7, MessageType::pose),     schema_record(9, MessageType::twist),
                             channel_record(3, 7, "/arm/pose"),       channel_record(4, 9, "/arm/speed"),
                             channel_record(5, 7, "/base/link/pose"), channel_record(6, 9, "/other/twist")};
  for (std::uint64_t i = 0; i < 100; ++i) {
    const std::uint64_t time = kStart + i * 10'000'000 + (i % 7) * 1000;  // 100 Hz with jitter
    const double x = static_cast<double>(i);
    records.push_back(pose_record(3, time, {{x, 0, 0}, {}}));
    records.push_back(message_record(4, time, twist));
    records.push_back(message_record(6, time, twist));
    if (i % 2 == 0) records.push_back(pose_record(5, time, {{0, x, 0}, {}}));
  }
  const Bytes bytes = file_of(records);
  auto reader = TraceReader::open_memory(bytes);
  ASSERT_TRUE(reader);
  EXPECT_EQ(reader->info().tick_rate, 100u);
  ASSERT_EQ(reader->info().objects.size(), 2u);
  EXPECT_EQ(reader->info().objects[0].name, "arm");
  EXPECT_EQ(reader->info().objects[1].name, "base.link");
  const Reading reading = read_all(std::move(reader));
  ASSERT_FALSE(reading.error);
  ASSERT_EQ(reading.frames.size(), 100u);
  for (std::size_t i = 0; i < 100; ++i) {
    const TraceFrame& frame = reading.frames[i];
    EXPECT_EQ(frame.tick, static_cast<std::int64_t>(i));
    EXPECT_NEAR(frame.objects[0].pose.position.x, static_cast<double>(i), 1e-3);  // at the ticks, not at times with jitter
    EXPECT_EQ(frame.objects[0].angular_velocity, (Vec3{4, 5, 6}));
    EXPECT_NEAR(frame.objects[1].pose.position.y, static_cast<double>(std::min<std::size_t>(i, 98)),
                1e-3);                                                     // between its samples
    EXPECT_NEAR(frame.objects[1].velocity.y, i <= 98 ? 100.0 : 0.0, 0.1);  // of its samples; at the last one from the one before
  }
}

TEST(Trace, ForeignFilesThatCannotBeRead) {
  const Bytes schema = schema_record(1, MessageType::pose);
  const Bytes channel = channel_record(1, 1, "/a/pose");
  EXPECT_EQ(rule_of({}), "R-TRC-16");
  EXPECT_EQ(rule_of({schema_record(1, MessageType::twist), channel_record(1, 1, "/a/twist")}), "R-TRC-16");
  EXPECT_EQ(rule_of({schema, channel, channel_record(2, 1, "a.pose/pose"), channel_record(3, 1, "/a/pose/pose"),
                     pose_record(2, 0, {}), pose_record(3, 0, {})}),
            "");                                                                            // two objects of one name
  EXPECT_EQ(rule_of({schema, channel, pose_record(1, 5, {}), pose_record(1, 4, {})}), "");  // sorted
  EXPECT_EQ(rule_of({schema, channel, pose_record(1, 0, {{NAN, 0, 0}, {}})}), "R-TRC-14");
  EXPECT_EQ(rule_of({schema, channel, message_record(1, 0, Bytes{0, 1, 0, 0, 9})}), "R-TRC-13");
  EXPECT_EQ(rule_of({schema, channel, message_record(1, 0, Bytes{0, 0, 0, 0, 9})}), "R-TRC-7");
  EXPECT_EQ(rule_of({schema, pose_record(1, 0, {})}), "R-TRC-10");
  EXPECT_EQ(rule_of({channel}), "R-TRC-10");
  EXPECT_EQ(rule_of({schema, channel, channel_record(1, 1, "/b/pose")}), "R-TRC-10");
  EXPECT_EQ(rule_of({schema, channel_record(1, 1, "/\xFF/pose")}), "R-TRC-11");
  EXPECT_EQ(rule_of({schema, channel, pose_record(1, 0, {})}), "");
}

TEST(Trace, ChunksOfOtherWriters) {
  const Bytes inside = join({schema_record(1, MessageType::pose), channel_record(1, 1, "/a/pose"), pose_record(1, 0, {})});
  EXPECT_EQ(rule_of({chunk_record({"", inside.size()}, inside)}), "");
  EXPECT_EQ(rule_of({chunk_record({"", inside.size() + 1}, inside)}), "R-TRC-8");
  EXPECT_EQ(rule_of({chunk_record({"lz4", inside.size()}, inside)}), "R-TRC-8");
  EXPECT_EQ(rule_of({chunk_record({"br", inside.size()}, inside)}), "R-TRC-7");
  EXPECT_EQ(rule_of({chunk_record({"zstd", inside.size()}, inside)}), "R-TRC-8");
  const Bytes nested = chunk_record({"", inside.size()}, inside);
  EXPECT_EQ(rule_of({chunk_record({"", nested.size()}, nested)}), "R-TRC-9");
  const Bytes short_record = {0x05, 200, 0, 0, 0, 0, 0, 0, 0, 1};
  EXPECT_EQ(rule_of({chunk_record({"", short_record.size()}, short_record)}), "R-TRC-4");
  Bytes unknown_record;
  ByteWriter out(unknown_record);
  put_record(out, mcap::Opcode{0x90}, Bytes(3));
  const Bytes with_unknown = join({unknown_record, inside});
  EXPECT_EQ(rule_of({unknown_record, chunk_record({"", with_unknown.size()}, with_unknown)}), "");
}

TEST(Trace, LengthsAreEarnedBeforeTheyAreAllocated) {
  Compressor compressor;
  const auto compress = [&compressor](const Bytes& input) {
    const auto output = compressor.compress(input).value();
    return Bytes(output.begin(), output.end());
  };
  const Bytes tiny = compress({});
  EXPECT_EQ(rule_of({chunk_record({"zstd", 200u << 20}, tiny)}), "R-TRC-18");
  EXPECT_EQ(rule_of({chunk_record({"zstd", 1ull << 40}, tiny)}), "R-TRC-5");
  Bytes huge;
  ByteWriter out(huge);
  out.u8(static_cast<std::uint8_t>(mcap::Opcode::metadata));
  out.u64(1ull << 62);
  EXPECT_EQ(rule_of({huge}), "R-TRC-5");

  const Bytes bomb_content(300u << 20);
  const Bytes bomb = compress(bomb_content);
  EXPECT_EQ(rule_of({chunk_record({"zstd", bomb_content.size()}, bomb)}), "R-TRC-5");
  EXPECT_EQ(rule_of({chunk_record({"zstd", 1u << 20}, bomb)}), "R-TRC-8");
}

TEST(Trace, OurMetadataMustAgreeWithTheChannels) {
  const auto metadata = [](std::initializer_list<std::pair<std::string_view, std::string_view>> entries) {
    Bytes map, content, record;
    ByteWriter map_out(map), out(content), whole(record);
    for (const auto& [key, value] : entries) put_text(map_out, key), put_text(map_out, value);
    put_text(out, "tactus");
    out.u32(static_cast<std::uint32_t>(map.size()));
    out.bytes(map);
    put_record(whole, mcap::Opcode::metadata, content);
    return record;
  };
  EXPECT_EQ(rule_of({metadata({{"format_version", "3"}})}), "R-TRC-7");
  EXPECT_EQ(rule_of({metadata({{"format_version", "1"}})}), "R-TRC-12");
  EXPECT_EQ(rule_of({metadata({{"format_version", "1"}, {"tick_rate", "0"}, {"users", "a"}})}), "R-TRC-12");
  EXPECT_EQ(rule_of({metadata({{"format_version", "1"}, {"tick_rate", "1000x"}, {"users", "a"}})}), "R-TRC-12");
  EXPECT_EQ(rule_of({metadata({{"format_version", "1"}, {"tick_rate", "1000"}})}), "R-TRC-12");
  EXPECT_EQ(rule_of({metadata({{"format_version", "1"}, {"tick_rate", "1000"}, {"users", "a"}})}), "R-TRC-12");
  EXPECT_EQ(rule_of({metadata({{"users", "a"}, {"users", "a"}})}), "R-TRC-11");
}

TEST(Mcap, CheckValuesAreWritten) {
  const TempFile file;
  const Bytes bytes = write_recording(make_recording(3), file.path());
  ByteReader ending(std::span<const std::uint8_t>(bytes).last(mcap::kMagic.size() + mcap::kFooterContent));
  const std::uint64_t summary_start = ending.u64();
  ending.u64();
  const auto summary = std::span(bytes).subspan(summary_start, bytes.size() - summary_start - mcap::kMagic.size() - 4);
  EXPECT_EQ(ending.u32(), crc32(summary));
  constexpr std::size_t kDataEnd = mcap::kRecordPrefix + 4;
  ByteReader data_end(std::span<const std::uint8_t>(bytes).subspan(summary_start - 4, 4));
  EXPECT_EQ(data_end.u32(), crc32(std::span(bytes).first(summary_start - kDataEnd)));
}

TEST(Mcap, StatisticsCountWhatIsThere) {
  const TempFile file;
  const Bytes bytes = write_recording(make_recording(6), file.path());
  auto reader = mcap::Reader::open(ByteSource::over_memory(bytes));
  ASSERT_TRUE(reader);
  const auto statistics = reader->statistics();
  ASSERT_TRUE(statistics);
  std::uint64_t messages = 0, attachments = 0, metadata = 0;
  for (auto item = reader->next(); item && *item != mcap::Item::end; item = reader->next()) {
    messages += *item == mcap::Item::message;
    attachments += *item == mcap::Item::attachment;
    metadata += *item == mcap::Item::metadata;
  }
  EXPECT_EQ(statistics->message_count, messages);
  EXPECT_EQ(statistics->attachment_count, attachments);
  EXPECT_EQ(statistics->metadata_count, metadata);
  EXPECT_EQ(statistics->channel_count, reader->channels().size());
  EXPECT_EQ(statistics->schema_count, reader->schemas().size());
  EXPECT_EQ(statistics->message_end_time, time_of_tick(10, 1000));
  // 6 ticks: pose, twist, 2 x (device, force, server force), orientation, velocity, time; one static pose; 4 contacts; buttons anew 3 times
  EXPECT_EQ(messages, 6u * 11u + 1u + 4u + 3u);
}

TEST(Mcap, ChannelsAreOfferedAsTheProfileWantsIt) {
  const TempFile file;
  const Bytes bytes = write_recording(make_recording(6), file.path());
  auto reader = mcap::Reader::open(ByteSource::over_memory(bytes));
  ASSERT_TRUE(reader);
  for (auto item = reader->next(); item && *item != mcap::Item::end; item = reader->next()) {
  }
  EXPECT_GT(reader->channels().size(), 4u);
  std::size_t once = 0;
  for (const auto& [id, channel] : reader->channels()) {
    const auto offered = channel.metadata.find("offered_qos_profiles");
    ASSERT_NE(offered, channel.metadata.end()) << channel.topic;
    EXPECT_NE(offered->second.find("reliability: 1\n"), std::string::npos) << channel.topic;
    once += offered->second.find("durability: 1\n") != std::string::npos;
  }
  EXPECT_EQ(once, 1u);  // the pose of what cannot move
}

TEST(Mcap, ContactsNameTheFrameOfTheirObject) {
  std::vector<std::uint8_t> message;
  encode_contact(message, 0, {ContactKind::surface, 1, {1, 2, 3}, {0, 0, 1}, {}, 630.0}, "the cube");
  CdrReader contact(message);
  contact.u32(), contact.u32();
  EXPECT_EQ(contact.text(), "the cube");
  encode_vector(message, 0, {1, 2, 3});
  CdrReader vector(message);
  vector.u32(), vector.u32();
  EXPECT_EQ(vector.text(), "world");
}

TEST(Trace, TheTableOfRulesNamesItsLimits) {
  const mcap::ReadLimits limits;
  testing::expect_limits("R-TRC-5", {testing::mib(limits.chunk_bytes), testing::mib(limits.declaration_bytes)});
}

}  // namespace
}  // namespace tactus
