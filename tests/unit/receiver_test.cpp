// SPDX-License-Identifier: Apache-2.0
/// What a receiver does with packets that it cannot decode, in a scene of several substreams.
#include <tactus/receiver.h>

#include <gtest/gtest.h>

#include <string_view>

#include "tests/unit/deformable_fixture.h"

namespace tactus {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint32_t kSquares = 4;
constexpr std::size_t kSubstreams = 4;

struct Sent {
  Bytes bytes;
  std::size_t substream = 0;
  std::uint16_t sequence = 0;
  std::int64_t tick = 0;
  bool key = false;
};

/// Something happens to every object at every tick.
std::vector<Sent> record(const SharedScene& scene, std::int64_t ticks, const SenderPolicy& policy = {}) {
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  testing::DentedSheet sheet(mesh, kSquares, 3e-4);
  testing::Motion cube(1);
  auto sender = Sender::create(scene, {.triggers = {.reduction = Reduction::none}, .deformable = {}, .policy = policy}).value();
  std::vector<Sent> out;
  std::vector<RigidSample> samples(3);
  for (std::int64_t tick = 0; tick < ticks; ++tick) {
    samples[0] = cube.step(1.0 / 60);
    samples[2].pose.position.x = 0.1 * std::sin(0.1 * static_cast<double>(tick));
    const testing::SheetFrame frame = sheet.frame(tick);
    const std::vector<DeformableTruth> shapes(3, frame.truth());
    for (const Packet& packet : testing::all(sender.encode(tick, {.objects = samples, .deformables = shapes})))
      out.push_back({Bytes(packet.bytes.begin(), packet.bytes.end()), packet.substream, packet.sequence, tick, packet.key});
  }
  return out;
}

/// Everything that a receiver holds and shows.
std::vector<std::int64_t> image(Receiver& receiver, std::int64_t now) {
  std::vector<std::int64_t> out{static_cast<std::int64_t>(receiver.replica().pose_hash(now))};
  for (std::size_t i = 0; i < kSubstreams; ++i) {
    out.push_back(receiver.tick(i));
    out.push_back(static_cast<std::int64_t>(receiver.state_hash(i)));
  }
  for (std::size_t i = 0; i + 1 < kSubstreams; ++i)
    for (const Vec3i& u : receiver.replica().displacements(i, now)) out.insert(out.end(), u.begin(), u.end());
  return out;
}

TEST(Receiver, ReportsWhatItDecoded) {
  const SharedScene scene = testing::scene_of_every_kind(kSquares);
  auto receiver = Receiver::create(scene).value();
  EXPECT_EQ(receiver.scene(), scene);
  std::array<std::size_t, kSubstreams> count{};
  for (const Sent& sent : record(scene, 30)) {
    const auto decoded = receiver.push(sent.bytes);
    ASSERT_TRUE(decoded) << decoded.error().rule;
    EXPECT_EQ(decoded->substream, sent.substream);
    EXPECT_EQ(decoded->sequence, sent.sequence);
    EXPECT_EQ(decoded->tick, sent.tick);
    EXPECT_EQ(decoded->key, sent.key);
    EXPECT_EQ(receiver.tick(sent.substream), sent.tick);
    EXPECT_EQ(decoded->updates.empty(), sent.substream != 0);
    EXPECT_EQ(decoded->vertices > 0, sent.substream != 0);
    EXPECT_EQ(decoded->layer == Layer::all, sent.substream != 1);
    ++count.at(sent.substream);
  }
  for (const std::size_t c : count) EXPECT_GE(c, 29u);
  EXPECT_EQ(receiver.object(1), RigidState{}) << "what cannot move is where the scene declares it";
}

/// Every substream in turn gets packets that are damaged, too short, too long, copied, late, and of no baseline.
TEST(Receiver, AfterAnErrorEverythingIsWhatItWas) {
  const SharedScene scene = testing::scene_of_every_kind(kSquares, 2);
  const std::vector<Sent> sent = record(scene, 40, {.key_interval = 0});
  auto receiver = Receiver::create(scene, {.replica = {}, .limits = {.packet_bytes = 4000}}).value();
  std::array<const Sent*, kSubstreams> last{};
  std::mt19937 random(4);
  std::size_t refused = 0;
  for (std::size_t i = 0; i < sent.size(); ++i) {
    const auto before = image(receiver, sent[i].tick);
    const auto refuses = [&](const Bytes& bytes, std::string_view rule, Advice what) {
      const auto decoded = receiver.push(bytes);
      ASSERT_FALSE(decoded) << rule;
      if (!rule.empty()) {
        EXPECT_EQ(decoded.error().rule, rule);
      }
      EXPECT_EQ(advice(decoded.error()), what) << decoded.error().rule;
      EXPECT_LE(decoded.error().bit_offset, 8 * bytes.size());
      ASSERT_EQ(image(receiver, sent[i].tick), before) << decoded.error().rule;
      ++refused;
    };
    const Bytes& good = sent[i].bytes;
    refuses({}, "R-PKT-6", Advice::drop);
    refuses({kSubstreams, 1, 0, 5}, "R-PKT-6", Advice::drop);
    refuses({good[0], good[1]}, "R-PKT-2", Advice::drop);
    Bytes longer = good;
    longer.resize(good.size() + 60, 1);
    refuses(longer, "", Advice::drop);  // R-RNG-2, if what it says then breaks no other rule
    longer.resize(5000);
    refuses(longer, "R-PKT-1", Advice::drop);
    if (last[sent[i].substream] != nullptr) {
      refuses(last[sent[i].substream]->bytes, "R-PKT-5", Advice::drop);
      Bytes ahead = good;  // it builds on a packet that never was
      ahead[1] = static_cast<std::uint8_t>(good[1] + 60);
      if (ahead[1] > good[1]) refuses(ahead, "R-PKT-4", Advice::request_key);
      Bytes noise = good;
      for (int round = 0; round < 20; ++round) {
        const std::size_t at = 3 + random() % (good.size() - 3);
        noise[at] = static_cast<std::uint8_t>(random());
        auto other = Receiver::create(scene).value();
        for (std::size_t k = 0; k < i; ++k)
          if (sent[k].substream == sent[i].substream) (void)other.push(sent[k].bytes);
        if (const auto decoded = other.push(noise); !decoded) refuses(noise, decoded.error().rule, advice(decoded.error()));
      }
    }
    if (HasFatalFailure()) return;
    ASSERT_TRUE(receiver.push(good));
    last[sent[i].substream] = &sent[i];
  }
  EXPECT_GT(refused, 1000u);
}

TEST(Receiver, AdviceIsOfTheError) {
  EXPECT_EQ(advice({Errc::truncated, "R-PKT-2"}), Advice::drop);
  EXPECT_EQ(advice({Errc::malformed, "R-RNG-2"}), Advice::drop);
  EXPECT_EQ(advice({Errc::invalid, "R-RIG-4"}), Advice::drop);
  EXPECT_EQ(advice({Errc::limit_exceeded, "R-PKT-1"}), Advice::drop);
  EXPECT_EQ(advice({Errc::state, "R-PKT-5"}), Advice::drop);
  EXPECT_EQ(advice({Errc::state, "R-PKT-4"}), Advice::request_key);
  EXPECT_EQ(advice({Errc::state, "R-PKT-7"}), Advice::request_key);
  EXPECT_EQ(advice({Errc::limit_exceeded, "R-STR-14"}), Advice::close);
  EXPECT_EQ(advice({Errc::limit_exceeded, "R-STR-18"}), Advice::close);
  EXPECT_EQ(advice({Errc::unsupported, "R-STR-2"}), Advice::close);
}

TEST(Receiver, ALossInOneSubstreamDoesNotStopTheOthers) {
  const SharedScene scene = testing::scene_of_every_kind(kSquares);
  const std::vector<Sent> sent = record(scene, 30, {.key_interval = 0});
  for (std::size_t lost = 0; lost < kSubstreams; ++lost) {
    auto receiver = Receiver::create(scene).value();
    std::size_t refused = 0, seen = 0;
    for (const Sent& packet : sent) {
      if (packet.substream == lost && ++seen == 5) continue;
      const auto decoded = receiver.push(packet.bytes);
      if (!decoded) {
        EXPECT_EQ(packet.substream, lost);
        EXPECT_EQ(advice(decoded.error()), Advice::request_key);
        ++refused;
      }
    }
    EXPECT_EQ(refused, seen - 5);
  }
}

/// Numbers of another sender: baselines are forgotten, and the next key packet is taken, whatever its number and tick.
TEST(Receiver, AnotherSendersPacketsAreRefusedUpToItsKeyPacket) {
  const SharedScene scene = testing::scene_of_every_kind(kSquares);
  const std::vector<Sent> first = record(scene, 20), second = record(scene, 10, {.first_sequence = 40000});
  auto receiver = Receiver::create(scene).value();
  for (const Sent& packet : first) ASSERT_TRUE(receiver.push(packet.bytes));
  const auto before = image(receiver, 20);
  std::array<bool, kSubstreams> foreign{};
  for (const Sent& packet : second) {
    if (packet.key) continue;
    const auto decoded = receiver.push(packet.bytes);
    ASSERT_FALSE(decoded);
    EXPECT_STREQ(decoded.error().rule, foreign[packet.substream] ? "R-PKT-4" : "R-PKT-7");
    EXPECT_EQ(advice(decoded.error()), Advice::request_key);
    foreign[packet.substream] = true;
  }
  EXPECT_EQ(image(receiver, 20), before) << "what is shown stays";
  for (const Sent& packet : second) ASSERT_TRUE(receiver.push(packet.bytes)) << packet.substream << ' ' << packet.sequence;
  EXPECT_EQ(receiver.tick(0), 9);
}

/// A clock shows that the receiver was away for long: what it holds is too old to be sure of.
TEST(Receiver, AfterALongSilenceOnlyAKeyPacketIsTaken) {
  const SharedScene scene = testing::scene_of_every_kind(kSquares);
  const std::vector<Sent> sent = record(scene, 30, {.key_interval = 0.25});
  auto receiver = Receiver::create(scene).value();
  constexpr std::int64_t kPause = 1'000'000;
  std::array<bool, kSubstreams> heard{};
  std::size_t refused = 0;
  for (const Sent& packet : sent) {
    const bool after = packet.tick >= 10;
    const auto decoded = receiver.push(packet.bytes, packet.tick + (after ? kPause : 0));
    bool& again = heard[packet.substream];
    if (!after || packet.key) again = after;
    EXPECT_EQ(decoded.has_value(), !after || again);
    if (decoded) continue;
    EXPECT_EQ(advice(decoded.error()), Advice::request_key);
    ++refused;
  }
  EXPECT_GT(refused, 4u);
  for (const bool again : heard) EXPECT_TRUE(again);
}

/// The position of an error counts from the front of the packet, with the number of the substream.
TEST(Receiver, PositionsCountTheSubstreamsNumber) {
  const SharedScene several = testing::scene_of_every_kind(kSquares), alone = testing::scene_of(1);
  auto a = Receiver::create(several).value(), b = Receiver::create(alone).value();
  const Bytes packet{7, 0, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff};
  Bytes numbered = packet;
  numbered.insert(numbered.begin(), 0);
  const auto of_several = a.push(numbered), of_one = b.push(packet);
  ASSERT_FALSE(of_several);
  ASSERT_FALSE(of_one);
  EXPECT_GE(of_one.error().bit_offset, 16u);
  EXPECT_STREQ(a.push(Bytes{0, 1}).error().rule, "R-PKT-2");
  EXPECT_EQ(a.push(Bytes{0, 1}).error().bit_offset, 8u);
  EXPECT_EQ(a.push(Bytes{9, 1, 1}).error().bit_offset, 0u);
  EXPECT_EQ(b.push(Bytes{1}).error().bit_offset, 0u);
}

/// With a clock an update is shown from when it came, without one from its tick.
/// In metres what the replica shows in integers.
TEST(Receiver, ShowsPosesAndShapesInMetres) {
  const SharedScene scene = testing::scene_of_every_kind(kSquares);
  auto receiver = Receiver::create(scene).value();
  for (const Sent& packet : record(scene, 20)) ASSERT_TRUE(receiver.push(packet.bytes));
  const unsigned grid = scene->grid.position;
  for (std::uint32_t i = 0; i < scene->objects.size(); ++i) {
    EXPECT_EQ(scene->find(scene->objects[i].name), i);
    const Pose exact = to_pose(receiver.replica().pose(i, 25), grid), shown = receiver.pose(i, 25);
    EXPECT_EQ(norm(shown.position - exact.position), 0);
    EXPECT_EQ(angle_between(shown.rotation, exact.rotation), 0);
  }
  for (std::uint32_t i = 0; i < scene->deformables.size(); ++i) {
    EXPECT_EQ(scene->find(scene->deformables[i].name), i);
    const auto of = receiver.replica().displacements(i, 25);
    const std::vector<Vec3i> exact(of.begin(), of.end());
    const auto shown = receiver.displacements(i, 25);
    ASSERT_EQ(shown.size(), 3 * exact.size());
    for (std::size_t v = 0; v < shown.size(); ++v)
      EXPECT_EQ(shown[v], static_cast<float>(std::ldexp(exact[v / 3][v % 3], -static_cast<int>(grid)))) << i << ", " << v;
  }
  EXPECT_EQ(scene->find("nothing of this name"), std::nullopt);
}

TEST(Receiver, ArrivalIsWhenAPacketCame) {
  const SharedScene scene = testing::scene_of(1);
  auto sender = Sender::create(scene, {.triggers = {.reduction = Reduction::none}, .deformable = {}, .policy = {}}).value();
  const ReceiverOptions smooth{.replica = {.interpolation = Interpolation::linear}, .limits = {}};
  auto live = Receiver::create(scene, smooth).value(), file = Receiver::create(scene, smooth).value();
  RigidSample sample;
  for (std::int64_t tick = 0; tick <= 80; tick += 40) {
    if (tick == 80) sample.pose.position.x = 0.03;
    const Packet packet = testing::only(sender.encode(tick, {{&sample, 1}}));
    ASSERT_TRUE(live.push(packet.bytes, tick + 100));
    ASSERT_TRUE(file.push(packet.bytes));
  }
  const auto x = [&](Receiver& receiver, std::int64_t now) {
    return to_pose(receiver.replica().pose(0, now), scene->grid.position).position.x;
  };
  EXPECT_NEAR(x(file, 80), 0, 1e-6);
  EXPECT_NEAR(x(file, 95), 0.015, 1e-6) << "t_N is 30 ticks";
  EXPECT_NEAR(x(live, 180), 0, 1e-6);
  EXPECT_NEAR(x(live, 195), 0.015, 1e-6);
  EXPECT_NEAR(x(live, 210), 0.03, 1e-6);
  EXPECT_EQ(live.tick(0), 80);
}

TEST(Receiver, OptionsAndScenesBeyondTheLimitsAreRefused) {
  const SharedScene scene = testing::scene_of_every_kind(kSquares);
  const auto rule = [&](const ReceiverOptions& options) {
    const auto receiver = Receiver::create(scene, options);
    return receiver ? std::string_view() : std::string_view(receiver.error().rule);
  };
  EXPECT_EQ(rule({}), "");
  EXPECT_EQ(rule({.replica = {.fraction = 0}, .limits = {}}), "R-API-4");
  EXPECT_EQ(rule({.replica = {}, .limits = {.objects = 5}}), "R-STR-14");
  EXPECT_EQ(rule({.replica = {}, .limits = {.vertices = 74}}), "R-STR-14");
  EXPECT_EQ(rule({.replica = {}, .limits = {.triangles = 95}}), "R-STR-14");
  EXPECT_EQ(rule({.replica = {}, .limits = {.state_bytes = state_bytes(*scene) - 1}}), "R-STR-18");
  EXPECT_EQ(rule({.replica = {}, .limits = {.objects = 6, .vertices = 75, .triangles = 96, .state_bytes = state_bytes(*scene)}}),
            "");
}

}  // namespace
}  // namespace tactus
