// SPDX-License-Identifier: Apache-2.0
/// Packets, their substreams, and files of them.
#include <gtest/gtest.h>

#include <array>
#include <random>
#include <sstream>
#include <string>
#include <string_view>
#include <tuple>

#include <tactus/file/stream_file.h>
#include <tactus/packet/substream.h>
#include <tactus/tactus.h>
#include "tests/unit/deformable_fixture.h"

namespace tactus {
namespace {

// ==== packet numbered ====
/// Packets that do not carry their numbers: a session gives them, with gaps.

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint32_t kSquares = 4;

SharedScene make_scene() {
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  return SceneBuilder(60)
      .rigid("cube")
      .deformable("layered", mesh, {.layered = true})
      .deformable("thesis", mesh, {.profile = DeformableProfile::thesis})
      .baselines(64)
      .build()
      .value();
}

struct World {
  testing::Motion cube{1};
  TriMesh mesh = testing::sheet(kSquares, kSquares);
  testing::DentedSheet sheet{mesh, kSquares, 3e-4};
  RigidSample sample;
  testing::SheetFrame frame;
  std::vector<DeformableTruth> shapes;

  Truth step(std::int64_t tick) {
    sample = cube.step(1.0 / 60);
    frame = sheet.frame(tick);
    shapes.assign(2, frame.truth());
    return {.objects = {&sample, 1}, .deformables = shapes};
  }
};

SenderOptions with(Baseline baseline) {
  return {.triggers = {}, .deformable = {}, .policy = {.key_interval = 0, .baseline = baseline}};
}

TEST(NumberedPackets, AreShorterByTheSequenceAndDecodeToTheSame) {
  const SharedScene scene = make_scene();
  auto counted = Sender::create(scene, with(Baseline::previous)).value(),
       given = Sender::create(scene, with(Baseline::previous)).value();
  auto receiver = Receiver::create(scene).value();
  World one, other;
  std::size_t packets = 0;
  for (std::int64_t tick = 0; tick < 100; ++tick) {
    const auto a = testing::all(counted.encode(tick, one.step(tick)));
    const auto b = testing::all(given.encode_numbered(static_cast<std::uint64_t>(2 * tick + 1), tick, other.step(tick)));
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i, ++packets) {
      if (a[i].key) {
        EXPECT_EQ(a[i].bytes.size(), b[i].bytes.size() + 2);
      }
      const bool second = i > 0 && b[i - 1].substream == b[i].substream;
      EXPECT_EQ(b[i].number, static_cast<std::uint64_t>(2 * tick + (second ? 2 : 1)));
      const auto decoded = receiver.push_numbered(b[i].number, b[i].bytes);
      ASSERT_TRUE(decoded) << decoded.error().rule;
      EXPECT_EQ(decoded->number, b[i].number);
      if (b[i].layer == Layer::haptic) continue;  // the hash is that after both layers
      EXPECT_EQ(receiver.state_hash(b[i].substream), counted.state_hash(b[i].substream));
    }
  }
  EXPECT_GT(packets, 200u);
}

/// After any pause and at any number a packet on an acknowledged state is decoded, and nothing counts as another sender.
TEST(NumberedPackets, NumbersMayLeap) {
  const SharedScene scene = make_scene();
  auto sender = Sender::create(scene, with(Baseline::acknowledged)).value();
  auto receiver = Receiver::create(scene).value();
  World world;
  std::mt19937_64 random(4);
  std::uint64_t number = 5;
  std::int64_t tick = 0;
  std::size_t decoded = 0, keys = 0;
  for (int i = 0; i < 400; ++i) {
    number += i % 40 == 39 ? 100000 : 2 + random() % 9;
    tick += i % 40 == 39 ? 10000 : 1 + static_cast<std::int64_t>(random() % 3);
    for (const Packet& packet : testing::all(sender.encode_numbered(number, tick, world.step(tick)))) {
      keys += packet.key ? 1 : 0;
      if (random() % 4 == 0 && packet.substream != 1) continue;  // layers build on each other
      const auto after = receiver.push_numbered(packet.number, packet.bytes);
      ASSERT_TRUE(after) << after.error().rule << " in substream " << packet.substream;
      EXPECT_FALSE(after->restarts);
      if (packet.layer != Layer::haptic) {
        EXPECT_EQ(receiver.state_hash(packet.substream), sender.state_hash(packet.substream));
      }
      sender.acknowledge(packet.substream, packet.sequence);
      ++decoded;
    }
  }
  EXPECT_GT(decoded, 700u);
  EXPECT_LT(keys, decoded / 8);
}

TEST(NumberedPackets, AreRefusedLikeOthers) {
  const SharedScene scene = make_scene();
  SenderOptions options = with(Baseline::acknowledged);
  options.triggers.reduction = Reduction::none;
  auto sender = Sender::create(scene, options).value();
  auto receiver = Receiver::create(scene).value();
  World world;
  std::span<const Packet> packets = testing::all(sender.encode_numbered(7, 1, world.step(1)));
  const Bytes first(packets[0].bytes.begin(), packets[0].bytes.end());
  ASSERT_TRUE(receiver.push_numbered(7, first));
  EXPECT_STREQ(receiver.push_numbered(7, first).error().rule, "R-PKT-5") << "twice";
  EXPECT_STREQ(receiver.push_numbered(6, first).error().rule, "R-PKT-5") << "before the first";
  sender.acknowledge(0, 7);
  packets = testing::all(sender.encode_numbered(9, 60, world.step(60)));
  ASSERT_FALSE(packets[0].key);
  const Bytes second(packets[0].bytes.begin(), packets[0].bytes.end());
  EXPECT_STREQ(receiver.push_numbered(10, second).error().rule, "R-PKT-4") << "under another number it builds on another state";
  EXPECT_STREQ(receiver.push_numbered(200000, second).error().rule, "R-PKT-4") << "however far";
  EXPECT_TRUE(receiver.push_numbered(9, second));
  EXPECT_STREQ(receiver.push_numbered(11, Bytes{}).error().rule, "R-PKT-6");
}

/// The layers of the first shape in the wrong order: the visual one, number 6, is refused, and its baseline comes after it.
TEST(NumberedPackets, TheFirstMayBeRefusedAndAnEarlierOneCome) {
  const SharedScene scene = make_scene();
  auto sender = Sender::create(scene, with(Baseline::previous)).value();
  auto receiver = Receiver::create(scene).value();
  World world;
  std::vector<Packet> layers;
  const auto packets = testing::all(sender.encode_numbered(5, 30, world.step(30)));
  for (const Packet& packet : packets)
    if (packet.substream == 1) layers.push_back(packet);
  ASSERT_EQ(layers.size(), 2u);
  ASSERT_EQ(layers[1].number, 6u);
  const auto refused = receiver.push_numbered(6, layers[1].bytes);
  ASSERT_FALSE(refused);
  EXPECT_STREQ(refused.error().rule, "R-PKT-4");
  EXPECT_TRUE(receiver.push_numbered(5, layers[0].bytes));
  EXPECT_TRUE(receiver.push_numbered(6, layers[1].bytes));
  EXPECT_EQ(receiver.state_hash(1), sender.state_hash(1));
}

// ==== packet substream ====

SharedScene scene(std::size_t deformables, std::uint8_t dof) {
  SceneSpec spec = testing::sheet_spec(testing::sheet(1, 1));
  spec.deformables.resize(deformables, spec.deformables[0]);
  for (std::size_t i = 0; i < deformables; ++i) spec.deformables[i].name = "sheet " + std::to_string(i);
  spec.objects.push_back({"box", dof, {}});
  return testing::shared(std::move(spec));
}

TEST(Substream, OneAloneHasNoNumber) {
  const std::array<std::uint8_t, 3> packet{7, 8, 9};
  for (const auto& [deformables, dof, substream] : {std::tuple{0U, Dof::all, 0U}, {1U, Dof::none, 1U}, {0U, Dof::none, 0U}}) {
    const auto split = split_substream(*scene(deformables, dof), packet);
    ASSERT_TRUE(split);
    EXPECT_EQ(split->substream, substream);
    EXPECT_EQ(split->bytes.size(), 3U);
  }
}

TEST(Substream, OfSeveralEachIsReported) {
  const auto substream_of = [](const SharedScene& of, std::uint8_t byte) {
    const std::array<std::uint8_t, 2> packet{byte, 5};
    const auto split = split_substream(*of, packet);
    EXPECT_EQ(split ? split->bytes.size() : 1, 1U);
    return split ? static_cast<int>(split->substream) : -1;
  };
  EXPECT_EQ(substream_of(scene(1, Dof::all), 0), 0);
  EXPECT_EQ(substream_of(scene(1, Dof::all), 1), 1);
  EXPECT_EQ(substream_of(scene(1, Dof::all), 2), -1);
  EXPECT_EQ(substream_of(scene(2, Dof::none), 0), -1);
  EXPECT_EQ(substream_of(scene(2, Dof::none), 2), 2);
  EXPECT_STREQ(split_substream(*scene(2, Dof::none), {}).error().rule, "R-PKT-6");
  EXPECT_EQ(split_substream(*scene(2, Dof::none), {}).error().code, Errc::truncated);
}

/// What a sender makes begins with its substream's number, if there are several, and then its sequence number.
TEST(Substream, WhatWasSentIsSplitAgain) {
  for (const SharedScene& of : {scene(2, Dof::all), scene(1, Dof::none), scene(0, Dof::all), scene(2, Dof::none)}) {
    auto sender = Sender::create(of, {.triggers = {}, .deformable = {}, .policy = {.first_sequence = 0x1234}}).value();
    RigidSample moved;
    moved.pose.position.x = 0.1;
    const std::vector<float> shape = testing::moved_by(4, {0, 0, 0.01});
    const std::vector<DeformableTruth> shapes(of->deformables.size(), {shape, {}});
    const auto packets = sender.encode(3, {.objects = {&moved, 1}, .deformables = shapes});
    ASSERT_TRUE(packets) << packets.error().rule;
    ASSERT_EQ(packets->size(), of->moving().size() + of->deformables.size());
    for (const Packet& packet : *packets) {
      const auto split = split_substream(*of, packet.bytes);
      ASSERT_TRUE(split);
      EXPECT_EQ(split->substream, packet.substream);
      EXPECT_EQ(packet.bytes.size() - split->bytes.size(), has_substream_number(*of) ? 1u : 0u);
      EXPECT_EQ(split->bytes[0], 0x34);
      EXPECT_EQ(split->bytes[1], 0x12);
    }
    EXPECT_EQ(has_substream_number(*of), packets->size() > 1);
  }
}

// ==== stream file ====

SharedScene one_object() {
  SceneSpec spec;
  spec.objects.resize(1);
  spec.objects[0].name = "cube";
  return Scene::create(std::move(spec)).value();
}

/// Packets of i bytes of value i at tick 10 i; every third is a key packet.
Bytes sample_file(std::size_t packets, bool finish = true) {
  std::ostringstream out;
  auto writer = StreamFileWriter::create(out, *one_object()).value();
  for (std::size_t i = 1; i <= packets; ++i) {
    EXPECT_TRUE(writer.add(static_cast<std::int64_t>(10 * i), Bytes(i, static_cast<std::uint8_t>(i)), i % 3 == 1));
  }
  EXPECT_TRUE(!finish || writer.finish());
  const std::string text = out.str();
  return {text.begin(), text.end()};
}

TEST(StreamFile, PacketsComeBackWithTheirTicks) {
  const Bytes file = sample_file(7);
  auto reader = StreamFileReader::open(file).value();
  for (std::size_t i = 1; i <= 7; ++i) {
    const auto packet = reader.next().value();
    ASSERT_TRUE(packet);
    EXPECT_EQ(packet->tick, static_cast<std::int64_t>(10 * i));
    EXPECT_EQ(Bytes(packet->bytes.begin(), packet->bytes.end()), Bytes(i, static_cast<std::uint8_t>(i)));
  }
  EXPECT_FALSE(reader.next().value());
  EXPECT_TRUE(reader.complete());
}

TEST(StreamFile, AFileWithoutItsEndIsReadableAndSaysSo) {
  const Bytes file = sample_file(4, false);
  auto reader = StreamFileReader::open(file).value();
  int packets = 0;
  while (reader.next().value()) ++packets;
  EXPECT_EQ(packets, 4);
  EXPECT_FALSE(reader.complete());
  EXPECT_FALSE(reader.seek(40)) << "no index, no seek";
}

TEST(StreamFile, SeekFindsTheLastKeyPacketAtOrBefore) {
  const Bytes file = sample_file(9);  // keys at ticks 10, 40, 70
  auto reader = StreamFileReader::open(file).value();
  for (const auto& [tick, expected] : {std::pair{10, 10}, {39, 10}, {40, 40}, {69, 40}, {90, 70}, {100000, 70}}) {
    ASSERT_TRUE(reader.seek(tick));
    EXPECT_EQ(reader.next().value()->tick, expected);
  }
  EXPECT_TRUE(reader.seek(45));
  std::int64_t last = 0;
  while (const auto packet = reader.next().value()) last = packet->tick;
  EXPECT_EQ(last, 90) << "reading goes on to the end from there";
  EXPECT_FALSE(reader.seek(9));
  EXPECT_FALSE(reader.seek(-1));
}

TEST(StreamFile, DamageIsNamedAndTheReaderStays) {
  const Bytes file = sample_file(3);
  const auto header_size = static_cast<std::size_t>(StreamFileReader::open(file).value().position());
  Bytes damaged = file;
  damaged[header_size + 4] ^= 1;  // inside the first packet
  auto reader = StreamFileReader::open(damaged).value();
  const auto packet = reader.next();
  ASSERT_FALSE(packet);
  EXPECT_EQ(packet.error().code, Errc::checksum);
  EXPECT_STREQ(packet.error().rule, "R-FIL-5");
  EXPECT_EQ(reader.position(), header_size);

  damaged = file;
  damaged[header_size] = 77;
  EXPECT_STREQ(StreamFileReader::open(damaged).value().next().error().rule, "R-FIL-3");

  damaged = file;
  damaged.push_back(1);
  auto trailing = StreamFileReader::open(damaged).value();
  while (trailing.next().value_or(std::nullopt)) {
  }
  EXPECT_STREQ(trailing.next().error().rule, "R-FIL-8");
}

TEST(StreamFile, EveryCutGivesAWholePrefixOrTruncated) {
  const Bytes file = sample_file(5);
  const auto header_size = static_cast<std::size_t>(StreamFileReader::open(file).value().position());
  for (std::size_t size = header_size; size < file.size(); ++size) {
    auto reader = StreamFileReader::open(std::span(file).first(size)).value();
    for (;;) {
      const auto packet = reader.next();
      if (!packet) {
        EXPECT_EQ(packet.error().code, Errc::truncated);
        break;
      }
      if (!*packet) break;
    }
    EXPECT_FALSE(reader.complete());
  }
}

TEST(StreamFile, WriterRefusesFallingTicks) {
  std::ostringstream out;
  auto writer = StreamFileWriter::create(out, *one_object()).value();
  EXPECT_TRUE(writer.add(5, Bytes{1}, false));
  EXPECT_TRUE(writer.add(5, Bytes{1}, false));
  const auto result = writer.add(4, Bytes{1}, false);
  ASSERT_FALSE(result);
  EXPECT_STREQ(result.error().rule, "R-API-5");
}

TEST(StreamFile, AFullDiskIsAnError) {
  std::ostringstream out;
  auto writer = StreamFileWriter::create(out, *one_object()).value();
  out.setstate(std::ios::badbit);
  EXPECT_EQ(writer.add(1, Bytes{1}, false).error().code, Errc::io);
}

}  // namespace
}  // namespace tactus
