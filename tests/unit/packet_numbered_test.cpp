// SPDX-License-Identifier: Apache-2.0
/// Packets that do not carry their numbers: a session gives them, with gaps.
#include <gtest/gtest.h>

#include <random>
#include <string_view>

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

}  // namespace
}  // namespace tactus
