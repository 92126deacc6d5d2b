// SPDX-License-Identifier: Apache-2.0
#include <tactus/player.h>

#include <gtest/gtest.h>

#include <sstream>
#include <string>

#include <tactus/base/bytes.h>
#include "tests/unit/deformable_fixture.h"

namespace tactus {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes bytes_of(const std::ostringstream& out) {
  const std::string text = out.str();
  return {text.begin(), text.end()};
}

double shown_x(Player& player, std::int64_t tick) { return player.pose(0, tick).position.x; }

/// Stream of a cube that jumps 1 m at tick 10 and again at 20; `record_offset` is added to the ticks of the file's records.
Bytes jumping_stream(std::int64_t record_offset = 0) {
  const SharedScene scene =
      SceneBuilder().rigid("cube").rigid("table", {}, {.dof = Dof::none}).rigid_profile(RigidProfile::thesis).build().value();
  auto sender = Sender::create(scene, {.triggers = {.heartbeat = 0, .haptic = HapticRule::off}, .deformable = {}, .policy = {}});
  std::ostringstream out;
  auto writer = StreamFileWriter::create(out, *scene).value();
  std::vector<RigidSample> samples(2);
  for (std::int64_t tick = 0; tick < 30; ++tick) {
    samples[0].pose.position.x = static_cast<double>(tick / 10);
    for (const Packet& packet : testing::all(sender->encode(tick, {samples})))
      EXPECT_TRUE(writer.add(tick + record_offset, packet.number, packet.bytes, packet.key));
  }
  EXPECT_TRUE(writer.finish());
  return bytes_of(out);
}

TEST(Player, AppliesPacketsWhenTheyAreDue) {
  const Bytes file = jumping_stream();
  auto player = Player::open(file).value();
  EXPECT_EQ(player.scene().objects[1].name, "table");
  EXPECT_EQ(*player.next_tick(), 10);
  EXPECT_FALSE(*player.play(9));
  EXPECT_NEAR(shown_x(player, 9), 0, 1e-6);
  const auto played = player.play(10);
  ASSERT_TRUE(played && *played);
  EXPECT_EQ((*played)->substream, 0u);
  EXPECT_EQ((*played)->number, 1u);
  EXPECT_EQ((*played)->tick, 10);
  EXPECT_TRUE((*played)->key);
  ASSERT_EQ((*played)->updates.size(), 1u);
  EXPECT_EQ((*played)->updates[0].reason, Reason::visual);
  EXPECT_GT((*played)->offset, player.header_bytes());
  EXPECT_LE((*played)->offset + (*played)->bytes, file.size());
  EXPECT_NEAR(shown_x(player, 10), 1, 0.006);
  EXPECT_EQ(*player.next_tick(), 20);
  EXPECT_TRUE(*player.play(25));
  EXPECT_FALSE(player.complete());
  EXPECT_EQ(*player.next_tick(), std::nullopt);
  EXPECT_TRUE(player.complete());
  EXPECT_FALSE(*player.play(1000)) << "the end stays the end";
}

TEST(Player, RefusesARecordWithAnotherTickThanItsPacket) {
  const Bytes file = jumping_stream(1);
  auto player = Player::open(file).value();
  const auto played = player.play(11);
  ASSERT_FALSE(played);
  EXPECT_EQ(played.error().code, Errc::invalid);
  EXPECT_STREQ(played.error().rule, "R-FIL-7");
  EXPECT_GT(played.error().bit_offset, 8 * player.header_bytes());
}

TEST(Player, AFileThatWasCutPlaysToItsLastWholePacket) {
  const Bytes whole = jumping_stream();
  const auto second = [&] {
    auto player = Player::open(whole).value();
    (void)player.play(10);
    return (*player.play(20))->offset;
  }();
  const auto cut = std::span(whole).first(second + 1);
  auto player = Player::open(cut).value();
  EXPECT_TRUE(*player.play(10));
  const auto next = player.next_tick();
  ASSERT_FALSE(next);
  EXPECT_EQ(next.error().code, Errc::truncated);
  EXPECT_STREQ(next.error().rule, "R-FIL-2");
  EXPECT_FALSE(player.complete());
}

TEST(Player, OptionsAndLimitsAreTheReceivers) {
  const Bytes file = jumping_stream();
  EXPECT_STREQ(Player::open(file, {.replica = {.fraction = 2}, .limits = {}}).error().rule, "R-API-4");
  EXPECT_STREQ(Player::open(file, {.replica = {}, .limits = {.objects = 1}}).error().rule, "R-STR-14");
  EXPECT_EQ(Player::open(std::span(file).first(10)).error().code, Errc::truncated);
  auto narrow = Player::open(file, {.replica = {}, .limits = {.packet_bytes = 5}}).value();
  EXPECT_STREQ(narrow.play(10).error().rule, "R-PKT-1");
  auto smooth = Player::open(file, {.replica = {.interpolation = Interpolation::linear}, .limits = testing::kWithThesis}).value();
  EXPECT_TRUE(*smooth.play(10));
  EXPECT_TRUE(*smooth.play(20));
  EXPECT_NEAR(shown_x(smooth, 20), 1, 0.006) << "an interpolation begins where the object was shown";
  EXPECT_NEAR(shown_x(smooth, 30), 2, 0.006);
}

/// A cube and two sheets, one of each profile.
class Recorded {
 public:
  static constexpr std::int64_t kTicks = 240;

  Recorded() {
    const TriMesh mesh = testing::sheet(4, 4);
    scene = SceneBuilder(60)
                .rigid("cube")
                .deformable("main", mesh, {.layered = true})
                .deformable("thesis", mesh, {.profile = DeformableProfile::thesis})
                .build(testing::kWithThesis)
                .value();
    auto sender = Sender::create(scene, {.triggers = {}, .deformable = {}, .policy = {.key_interval = 0.5}}).value();
    auto receiver = Receiver::create(scene).value();
    std::ostringstream out;
    auto writer = StreamFileWriter::create(out, *scene).value();
    testing::DentedSheet sheet(mesh, 4);
    testing::Motion motion(1);
    for (std::int64_t tick = 0; tick < kTicks; ++tick) {
      const RigidSample sample = motion.step(1.0 / 60);
      const testing::SheetFrame frame = sheet.frame(tick);
      const std::vector<DeformableTruth> shapes(2, frame.truth());
      for (const Packet& packet : testing::all(sender.encode(tick, {.objects = {&sample, 1}, .deformables = shapes}))) {
        EXPECT_TRUE(receiver.push(packet.number, packet.bytes));
        EXPECT_TRUE(writer.add(tick, packet.number, packet.bytes, packet.key));
        ++packets;
      }
      seen.push_back(look(receiver, tick));
    }
    EXPECT_TRUE(writer.finish());
    file = bytes_of(out);
  }

  /// Everything that a client shows at a tick.
  static std::vector<std::int64_t> look(Receiver& receiver, std::int64_t tick) {
    std::vector<std::int64_t> out{static_cast<std::int64_t>(receiver.replica().pose_hash(tick))};
    for (std::size_t i = 0; i < receiver.scene()->deformables.size(); ++i)
      for (const Vec3i& u : receiver.replica().displacements(i, tick)) out.insert(out.end(), u.begin(), u.end());
    return out;
  }

  SharedScene scene;
  Bytes file;
  std::size_t packets = 0;
  std::vector<std::vector<std::int64_t>> seen;  // by tick
};

TEST(Player, ShowsOfEverySubstreamWhatAReceiverShows) {
  const Recorded recorded;
  auto player = Player::open(recorded.file, {.limits = testing::kWithThesis}).value();
  std::array<std::size_t, 3> packets{};
  for (std::int64_t tick = 0; tick < Recorded::kTicks; ++tick) {
    for (;;) {
      const auto played = player.play(tick);
      ASSERT_TRUE(played) << played.error().rule;
      if (!*played) break;
      EXPECT_EQ((*played)->tick, tick);
      EXPECT_EQ(recorded.file[(*played)->offset], (*played)->substream) << "the packet begins with its substream's number";
      ++packets.at((*played)->substream);
    }
    ASSERT_EQ(Recorded::look(player.receiver(), tick), recorded.seen[static_cast<std::size_t>(tick)]) << tick;
  }
  EXPECT_EQ(packets[0] + packets[1] + packets[2], recorded.packets);
  for (const std::size_t count : packets) EXPECT_GT(count, 5u);
}

/// A stream as it came over a network: a third of the packets are lost, and numbers have gaps.
TEST(Player, PlaysNumberedRecords) {
  const SharedScene scene = SceneBuilder().rigid("cube").baselines(8).build().value();
  auto sender = Sender::create(scene, {.triggers = {.reduction = Reduction::none},
                                       .deformable = {},
                                       .policy = {.key_interval = 0, .baseline = Baseline::acknowledged}})
                    .value();
  auto receiver = Receiver::create(scene).value();
  Bytes file = write_scene(*scene).value();
  testing::Motion motion(1);
  std::vector<std::uint64_t> numbers;
  std::int64_t last = 0;
  for (std::int64_t tick = 0; tick < 60; ++tick) {
    const RigidSample sample = motion.step(1e-3);
    const auto number = static_cast<std::uint64_t>(7 * tick + 1 + tick % 5);
    const Packet packet = testing::only(sender.encode(tick, {.objects = {&sample, 1}}, number));
    if (tick % 3 == 1) continue;
    ASSERT_TRUE(receiver.push(number, packet.bytes));
    sender.acknowledge(0, number);
    Bytes payload, record{4};
    ByteWriter w(payload), r(record);
    w.varint(static_cast<std::uint64_t>(tick - last));
    w.varint(number);
    w.bytes(packet.bytes);
    r.varint(payload.size());
    r.bytes(payload);
    r.u32(crc32(record));
    file.insert(file.end(), record.begin(), record.end());
    numbers.push_back(number);
    last = tick;
  }
  auto player = Player::open(file).value();
  for (const std::uint64_t number : numbers) {
    const auto played = player.play(60);
    ASSERT_TRUE(played && *played);
    EXPECT_EQ((*played)->number, number);
  }
  EXPECT_EQ(player.receiver().state_hash(0), receiver.state_hash(0));
  EXPECT_EQ(player.next_tick().value(), std::nullopt);
}

/// A packet that the check value of its record does not betray, because it was written so.
TEST(Player, ReportsTheFileOffsetOfADamagedPacketAndGoesOn) {
  const Recorded recorded;
  std::ostringstream out;
  auto writer = StreamFileWriter::create(out, *recorded.scene).value();
  auto reader = StreamFileReader::open(recorded.file, testing::kWithThesis).value();
  std::size_t count = 0;
  while (const auto packet = reader.next().value()) {
    Bytes bytes(packet->bytes.begin(), packet->bytes.end());
    if (++count == 20) bytes.resize(bytes.size() + 12, 1);
    ASSERT_TRUE(writer.add(packet->tick, packet->number, bytes, false));
  }
  ASSERT_TRUE(writer.finish());
  const Bytes file = bytes_of(out);
  auto player = Player::open(file, {.limits = testing::kWithThesis}).value();
  std::size_t played = 0, refused = 0, end = 0;
  while (player.next_tick().value()) {
    const auto packet = player.play(Recorded::kTicks);
    if (packet) {
      ++played;
      end = (*packet)->offset + (*packet)->bytes;
      continue;
    }
    if (++refused == 1) {
      EXPECT_EQ(played, 19u);
      EXPECT_STREQ(packet.error().rule, "R-RNG-2");
      EXPECT_GT(packet.error().bit_offset, 8 * end);
      EXPECT_LT(packet.error().bit_offset, 8 * (end + 400));
    } else {
      EXPECT_EQ(advice(packet.error()), Advice::request_key) << "what builds on it";
    }
  }
  EXPECT_EQ(played + refused, recorded.packets);
  EXPECT_GT(played, 50u) << "the other substreams, and after the next key packet all";
  EXPECT_EQ(Recorded::look(player.receiver(), Recorded::kTicks - 1), recorded.seen.back());
}

}  // namespace
}  // namespace tactus
