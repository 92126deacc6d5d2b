// SPDX-License-Identifier: Apache-2.0
/// Packets, their numbers and substreams, and files of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <optional>
#include <random>
#include <sstream>
#include <string>
#include <string_view>
#include <tuple>

#include <tactus/base/bytes.h>
#include <tactus/file/stream_file.h>
#include <tactus/packet/packet.h>
#include <tactus/packet/substream.h>
#include <tactus/tactus.h>
#include "tests/unit/deformable_fixture.h"

namespace tactus {
namespace {

// ==== packet numbers ====
/// A packet does not name its number: the sender counts it, or the caller gives it, with gaps.

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

std::vector<Bytes> bytes_of(std::span<const Packet> packets) {
  std::vector<Bytes> out;
  for (const Packet& packet : packets) out.emplace_back(packet.bytes.begin(), packet.bytes.end());
  return out;
}

/// Numbers that follow each other make the same packets, whatever the first one is.
TEST(PacketNumbers, OfAPacketMakeNoDifferenceToItsBytes) {
  for (const std::uint8_t span : {std::uint8_t{1}, std::uint8_t{8}}) {
    SceneSpec spec = testing::spec_of(2);
    spec.baseline_span = span;
    const SharedScene scene = testing::shared(std::move(spec));
    auto counted = Sender::create(scene, with(Baseline::previous)).value(),
         given = Sender::create(scene, with(Baseline::previous)).value();
    auto receiver = Receiver::create(scene).value();
    std::vector<testing::Motion> motions{testing::Motion(1), testing::Motion(2)};
    std::uint64_t number = 1, first = std::uint64_t{1} << 40;
    for (std::int64_t tick = 0; number < 100; ++tick) {
      const std::vector<RigidSample> samples{motions[0].step(1e-3), motions[1].step(1e-3)};
      const auto a = testing::all(counted.encode(tick, {samples}));
      const auto b = testing::all(given.encode(tick, {samples}, first + number));
      ASSERT_EQ(bytes_of(a), bytes_of(b)) << tick;
      if (a.empty()) continue;
      EXPECT_EQ(a[0].number, number);
      EXPECT_EQ(b[0].number, first + number);
      ASSERT_TRUE(receiver.push(b[0].number, b[0].bytes));
      EXPECT_EQ(receiver.state_hash(0), counted.state_hash(0));
      ++number;
    }
  }
}

/// All packets of a tick have the number that is given, the second one of a layered object the next.
TEST(PacketNumbers, OfLayersFollowEachOther) {
  const SharedScene scene = make_scene();
  auto sender = Sender::create(scene, with(Baseline::previous)).value();
  auto receiver = Receiver::create(scene).value();
  World world;
  std::size_t packets = 0, seconds = 0;
  for (std::int64_t tick = 0; tick < 100; ++tick) {
    const auto number = static_cast<std::uint64_t>(3 * tick + 1);
    const auto sent = testing::all(sender.encode(tick, world.step(tick), number));
    for (std::size_t i = 0; i < sent.size(); ++i, ++packets) {
      const bool second = i > 0 && sent[i - 1].substream == sent[i].substream;
      seconds += second ? 1 : 0;
      EXPECT_EQ(sent[i].number, number + (second ? 1 : 0));
      const auto decoded = receiver.push(sent[i].number, sent[i].bytes);
      ASSERT_TRUE(decoded) << decoded.error().rule;
      EXPECT_EQ(decoded->number, sent[i].number);
      if (sent[i].layer == Layer::haptic) continue;  // the hash is that after both layers
      EXPECT_EQ(receiver.state_hash(sent[i].substream), sender.state_hash(sent[i].substream));
    }
  }
  EXPECT_GT(packets, 200u);
  EXPECT_GT(seconds, 30u);
}

/// Beside a sender that never got the wrong calls.
TEST(PacketNumbers, RiseAtASender) {
  const SharedScene scene = make_scene();
  auto sender = Sender::create(scene, with(Baseline::previous)).value(),
       spared = Sender::create(scene, with(Baseline::previous)).value();
  World world;
  constexpr std::uint64_t kLimit = std::uint64_t{1} << 62;
  std::uint64_t last = 0;
  for (std::int64_t tick = 0; tick < 40; ++tick) {
    const Truth truth = world.step(tick);
    const std::uint64_t number = last + 1 + static_cast<std::uint64_t>(tick % 3);
    for (const std::uint64_t wrong : {std::uint64_t{0}, last / 2, last, kLimit - 1, kLimit, ~std::uint64_t{0}}) {
      const auto refused = sender.encode(tick, truth, wrong);
      ASSERT_FALSE(refused) << wrong;
      EXPECT_EQ(refused.error().code, Errc::invalid_argument);
      EXPECT_STREQ(refused.error().rule, "R-API-5");
    }
    const auto sent = testing::all(sender.encode(tick, truth, number));
    ASSERT_EQ(bytes_of(sent), bytes_of(testing::all(spared.encode(tick, truth, number)))) << tick;
    for (const Packet& packet : sent) last = std::max(last, packet.number);
  }
  EXPECT_GT(last, 40u);
  EXPECT_TRUE(sender.encode(40, world.step(40), kLimit - 2)) << "the highest, with one more for a layer";
}

/// With gaps a packet on an acknowledged state is decoded after any pause and at any number.
TEST(PacketNumbers, MayLeap) {
  const SharedScene scene = make_scene();
  auto sender = Sender::create(scene, with(Baseline::acknowledged)).value();
  auto receiver = Receiver::create(scene).value();
  World world;
  std::mt19937_64 random(4);
  std::uint64_t number = 5;
  std::int64_t tick = 0;
  std::size_t decoded = 0, keys = 0;
  for (int i = 0; i < 400; ++i) {
    if (i == 200) number = std::uint64_t{1} << 61;
    number += i % 40 == 39 ? 100000 : 2 + random() % 9;
    tick += i % 40 == 39 ? 10000 : 1 + static_cast<std::int64_t>(random() % 3);
    for (const Packet& packet : testing::all(sender.encode(tick, world.step(tick), number))) {
      keys += packet.key ? 1 : 0;
      if (random() % 4 == 0 && packet.substream != 1) continue;  // layers build on each other
      const auto after = receiver.push(packet.number, packet.bytes);
      ASSERT_TRUE(after) << after.error().rule << " in substream " << packet.substream;
      if (packet.layer != Layer::haptic) {
        EXPECT_EQ(receiver.state_hash(packet.substream), sender.state_hash(packet.substream));
      }
      sender.acknowledge(packet.substream, packet.number);
      ++decoded;
    }
  }
  EXPECT_GT(decoded, 700u);
  EXPECT_LT(keys, decoded / 8);
}

/// A sender names no baseline that is more than 4095 numbers back, and none at all after a gap where one state is kept.
TEST(PacketNumbers, OfABaselineAreNotTooFarBack) {
  for (const std::uint8_t span : {std::uint8_t{1}, std::uint8_t{2}, std::uint8_t{64}}) {
    SceneSpec spec = testing::spec_of(1);
    spec.baseline_span = span;
    SenderOptions options = with(Baseline::previous);
    options.triggers.reduction = Reduction::none;
    auto sender = Sender::create(testing::shared(std::move(spec)), options).value();
    testing::Motion motion(1);
    std::uint64_t number = 1;
    std::int64_t tick = 0;
    const auto is_key = [&](std::uint64_t gap) {
      const RigidSample sample = motion.step(1e-3);
      return testing::only(sender.encode(tick++, {{&sample, 1}}, number += gap)).key;
    };
    EXPECT_TRUE(is_key(1));
    EXPECT_FALSE(is_key(1));
    EXPECT_EQ(is_key(2), span == 1);
    EXPECT_EQ(is_key(4095), span == 1);
    EXPECT_TRUE(is_key(4096));
    EXPECT_TRUE(is_key(std::uint64_t{1} << 61));
    EXPECT_FALSE(is_key(1));
  }
}

/// A packet that was dropped had the number of the next one, unless numbers are given: then it leaves a gap.
TEST(PacketNumbers, OfForgottenPacketsAreCountedAgain) {
  for (const bool is_given : {false, true}) {
    for (const std::uint8_t span : {std::uint8_t{1}, std::uint8_t{2}}) {
      SceneSpec spec = testing::spec_of(1);
      spec.baseline_span = span;
      const SharedScene scene = testing::shared(std::move(spec));
      SenderOptions options = with(Baseline::previous);
      options.triggers.reduction = Reduction::none;
      auto sender = Sender::create(scene, options).value();
      auto receiver = Receiver::create(scene).value();
      testing::Motion motion(1);
      std::uint64_t keys = 0, number = 0, sent = 0;
      for (std::int64_t tick = 0; tick < 40; ++tick) {
        const RigidSample sample = motion.step(1e-3);
        const auto given = is_given ? std::optional(static_cast<std::uint64_t>(tick + 1)) : std::nullopt;
        const Packet packet = testing::only(sender.encode(tick, {{&sample, 1}}, given));
        if (tick % 4 == 2) {
          sender.forget_last(0);
          continue;
        }
        ++sent;
        keys += packet.key ? 1 : 0;
        number = packet.number;
        ASSERT_TRUE(receiver.push(packet.number, packet.bytes));
        ASSERT_EQ(receiver.state_hash(0), sender.state_hash(0));
      }
      EXPECT_EQ(sent, 30u);
      EXPECT_EQ(number, is_given ? 40u : 30u);
      EXPECT_EQ(keys, is_given && span == 1 ? 11u : 1u);
    }
  }
}

TEST(PacketNumbers, ThatAreWrongAreRefused) {
  const SharedScene scene = make_scene();
  SenderOptions options = with(Baseline::acknowledged);
  options.triggers.reduction = Reduction::none;
  auto sender = Sender::create(scene, options).value();
  auto receiver = Receiver::create(scene).value();
  World world;
  std::span<const Packet> packets = testing::all(sender.encode(1, world.step(1), 7));
  const Bytes first(packets[0].bytes.begin(), packets[0].bytes.end());
  ASSERT_TRUE(receiver.push(7, first));
  EXPECT_STREQ(receiver.push(7, first).error().rule, "R-PKT-5") << "twice";
  EXPECT_STREQ(receiver.push(6, first).error().rule, "R-PKT-5") << "before the first";
  sender.acknowledge(0, 7);
  packets = testing::all(sender.encode(60, world.step(60), 9));
  ASSERT_FALSE(packets[0].key);
  const Bytes second(packets[0].bytes.begin(), packets[0].bytes.end());
  EXPECT_STREQ(receiver.push(10, second).error().rule, "R-PKT-4") << "under another number it builds on another state";
  EXPECT_STREQ(receiver.push(std::uint64_t{1} << 61, second).error().rule, "R-PKT-4") << "however far";
  EXPECT_TRUE(receiver.push(9, second));
  EXPECT_STREQ(receiver.push(11, Bytes{}).error().rule, "R-PKT-6");
}

/// The layers of the first shape in the wrong order: the visual one, number 6, is refused, and its baseline comes after it.
TEST(PacketNumbers, TheFirstMayBeRefusedAndAnEarlierOneCome) {
  const SharedScene scene = make_scene();
  auto sender = Sender::create(scene, with(Baseline::previous)).value();
  auto receiver = Receiver::create(scene).value();
  World world;
  std::vector<Packet> layers;
  const auto packets = testing::all(sender.encode(30, world.step(30), 5));
  for (const Packet& packet : packets)
    if (packet.substream == 1) layers.push_back(packet);
  ASSERT_EQ(layers.size(), 2u);
  ASSERT_EQ(layers[1].number, 6u);
  const auto refused = receiver.push(6, layers[1].bytes);
  ASSERT_FALSE(refused);
  EXPECT_STREQ(refused.error().rule, "R-PKT-4");
  EXPECT_TRUE(receiver.push(5, layers[0].bytes));
  EXPECT_TRUE(receiver.push(6, layers[1].bytes));
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

/// What a sender makes begins with its substream's number, if there are several.
TEST(Substream, WhatWasSentIsSplitAgain) {
  for (const SharedScene& of : {scene(2, Dof::all), scene(1, Dof::none), scene(0, Dof::all), scene(2, Dof::none)}) {
    auto sender = Sender::create(of).value();
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
    EXPECT_TRUE(writer.add(static_cast<std::int64_t>(10 * i), i, Bytes(i, static_cast<std::uint8_t>(i)), i % 3 == 1));
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
    EXPECT_EQ(packet->number, i);
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
    const FilePacket packet = *reader.next().value();
    EXPECT_EQ(packet.tick, expected);
    EXPECT_EQ(packet.number, 1u) << "counted from there";
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

TEST(StreamFile, MayBeginAtAnyNumber) {
  std::ostringstream out;
  auto writer = StreamFileWriter::create(out, *one_object()).value();
  EXPECT_STREQ(writer.add(5, 0, Bytes{1}, false).error().rule, "R-API-5");
  EXPECT_STREQ(writer.add(5, std::uint64_t{1} << 62, Bytes{1}, false).error().rule, "R-API-5");
  EXPECT_TRUE(writer.add(5, 700, Bytes{1}, false));
  EXPECT_STREQ(writer.add(6, 702, Bytes{1}, false).error().rule, "R-API-5");
  EXPECT_TRUE(writer.add(6, 701, Bytes{1}, false));
}

TEST(StreamFile, WriterRefusesFallingTicksAndOtherNumbersThanTheNext) {
  std::ostringstream out;
  auto writer = StreamFileWriter::create(out, *one_object()).value();
  const auto rule = [&](std::int64_t tick, std::uint64_t number) {
    const std::uint64_t before = writer.bytes();
    const auto added = writer.add(tick, number, Bytes{1}, false);
    EXPECT_EQ(writer.bytes() > before, added.has_value());
    return added ? "" : added.error().rule;
  };
  EXPECT_STREQ(rule(5, 1), "");
  EXPECT_STREQ(rule(5, 2), "");
  EXPECT_STREQ(rule(4, 3), "R-API-5");
  EXPECT_STREQ(rule(6, 2), "R-API-5");
  EXPECT_STREQ(rule(6, 4), "R-API-5");
  EXPECT_STREQ(rule(6, 3), "") << "what was refused does not count";
}

/// Each substream counts its own packets, whatever is in them.
TEST(StreamFile, CountsThePacketsOfEachSubstream) {
  std::ostringstream out;
  auto writer = StreamFileWriter::create(out, *scene(2, Dof::all)).value();
  const std::vector<std::pair<std::uint8_t, std::uint64_t>> packets{{0, 1}, {1, 1}, {0, 2}, {2, 1},
                                                                    {1, 2}, {0, 3}, {0, 4}, {2, 2}};
  for (const auto& [substream, number] : packets) ASSERT_TRUE(writer.add(1, number, Bytes{substream, 0xff}, false));
  ASSERT_TRUE(writer.finish());
  const std::string text = out.str();
  const Bytes file(text.begin(), text.end());
  auto reader = StreamFileReader::open(file).value();
  auto receiver = Receiver::create(reader.scene(), {.replica = {}, .limits = {.packet_bytes = 0}}).value();
  for (const auto& [substream, number] : packets) {
    const FilePacket packet = *reader.next().value();
    EXPECT_EQ(packet.bytes[0], substream);
    EXPECT_EQ(packet.number, number);
    EXPECT_STREQ(receiver.push(packet.number, packet.bytes).error().rule, "R-PKT-1") << "those that are refused count, too";
  }
}

/// A file whose records are made by hand.
class FileByHand {
 public:
  explicit FileByHand(const Scene& scene) : bytes_(write_scene(scene).value()) {}
  FileByHand& record(std::uint8_t type, const Bytes& payload) {
    Bytes out{type};
    ByteWriter w(out);
    w.varint(payload.size());
    w.bytes(payload);
    w.u32(crc32(out));
    bytes_.insert(bytes_.end(), out.begin(), out.end());
    return *this;
  }
  FileByHand& packet(std::uint64_t tick_delta, const Bytes& packet) {
    Bytes out;
    ByteWriter w(out);
    w.varint(tick_delta);
    w.bytes(packet);
    return record(1, out);
  }
  FileByHand& numbered(std::uint64_t tick_delta, std::uint64_t number, const Bytes& packet) {
    Bytes out;
    ByteWriter w(out);
    w.varint(tick_delta);
    w.varint(number);
    w.bytes(packet);
    return record(4, out);
  }
  const Bytes& bytes() const { return bytes_; }

 private:
  Bytes bytes_;
};

/// The rule that ends a file, or nothing.   out  numbers of the packets before
std::string_view ends_with(const FileByHand& file, std::vector<std::uint64_t>& numbers, const DecodeLimits& limits = {}) {
  auto reader = StreamFileReader::open(file.bytes(), limits).value();
  for (numbers.clear();;) {
    const auto packet = reader.next();
    if (!packet) {
      const std::uint64_t at = reader.position();
      EXPECT_FALSE(reader.next());
      EXPECT_EQ(reader.position(), at);
      return packet.error().rule;
    }
    if (!*packet) return {};
    numbers.push_back((*packet)->number);
  }
}

TEST(StreamFile, NumberedRecordsNameTheirNumbers) {
  using Numbers = std::vector<std::uint64_t>;
  constexpr std::uint64_t kLimit = std::uint64_t{1} << 62;
  const Bytes five(5, 1);
  const auto file = [&](std::uint64_t number) {
    return FileByHand(*one_object()).numbered(3, 70, five).numbered(0, 9, five).record(128, five).numbered(2, number, five);
  };
  Numbers numbers;
  EXPECT_EQ(ends_with(file(kLimit - 1), numbers), "");
  EXPECT_EQ(numbers, (Numbers{70, 9, kLimit - 1}));
  for (const std::uint64_t number : {std::uint64_t{0}, kLimit, ~std::uint64_t{0}}) {
    EXPECT_EQ(ends_with(file(number), numbers), "R-FIL-6") << number;
    EXPECT_EQ(numbers, (Numbers{70, 9}));
  }
  EXPECT_EQ(ends_with(FileByHand(*one_object()).record(4, {1}), numbers), "R-FIL-6") << "no number";
  EXPECT_EQ(ends_with(FileByHand(*one_object()).record(4, {1, 0x80}), numbers), "R-FIL-6") << "half of one";
  EXPECT_EQ(ends_with(FileByHand(*one_object()).record(5, {1, 1}), numbers), "R-FIL-3") << "there is no such type";
}

/// Also before what is wrong inside the record is seen.
TEST(StreamFile, RecordsOfPacketsAreAllOfOneType) {
  const Bytes five(5, 1);
  std::vector<std::uint64_t> numbers;
  EXPECT_EQ(ends_with(FileByHand(*one_object()).packet(1, five).numbered(1, 2, five), numbers), "R-FIL-9");
  EXPECT_EQ(numbers.size(), 1u);
  EXPECT_EQ(ends_with(FileByHand(*one_object()).numbered(1, 2, five).record(128, five).packet(1, five), numbers), "R-FIL-9");
  EXPECT_EQ(numbers.size(), 1u);
  EXPECT_EQ(ends_with(FileByHand(*one_object()).packet(1, five).record(4, {}), numbers), "R-FIL-9");
  EXPECT_EQ(ends_with(FileByHand(*one_object()).packet(1, five).record(4, Bytes(500)), numbers, {.packet_bytes = 8}), "R-FIL-9");
}

TEST(StreamFile, RecordsHaveTheLimitOfPacketsAndWhatIsBefore) {
  std::vector<std::uint64_t> numbers;
  const DecodeLimits limits{.packet_bytes = 100};
  for (const auto& [type, before] : {std::pair{std::uint8_t{1}, 6u}, {std::uint8_t{4}, 15u}}) {
    EXPECT_EQ(ends_with(FileByHand(*one_object()).record(type, Bytes(100 + before, 1)), numbers, limits), "");
    EXPECT_EQ(ends_with(FileByHand(*one_object()).record(type, Bytes(101 + before, 1)), numbers, limits), "R-FIL-4");
  }
}

TEST(StreamFile, AFullDiskIsAnError) {
  std::ostringstream out;
  auto writer = StreamFileWriter::create(out, *one_object()).value();
  out.setstate(std::ios::badbit);
  EXPECT_EQ(writer.add(1, 1, Bytes{1}, false).error().code, Errc::io);
}

}  // namespace
}  // namespace tactus
