// SPDX-License-Identifier: Apache-2.0
/// A packet does not name its number: the sender counts it, or the caller gives it, with gaps.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <random>
#include <vector>

#include <tactus/packet/packet.h>
#include <tactus/tactus.h>
#include "tests/unit/deformable_fixture.h"

namespace tactus {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint32_t kSquares = 4;

SharedScene make_scene() {
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  return SceneBuilder(60)
      .rigid("cube")
      .deformable("layered", mesh, {.layered = true})
      .deformable("thesis", mesh, {.profile = DeformableProfile::thesis})
      .baselines(64)
      .build(testing::kWithThesis)
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

}  // namespace
}  // namespace tactus
