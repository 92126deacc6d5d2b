// SPDX-License-Identifier: Apache-2.0
/// What a receiver does with packets that it cannot decode, in a scene of several substreams.
#include <tactus/receiver.h>

#include <gtest/gtest.h>

#include <cmath>
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
  std::uint64_t number = 0;
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
      out.push_back({Bytes(packet.bytes.begin(), packet.bytes.end()), packet.substream, packet.number, tick, packet.key});
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
    const auto decoded = receiver.push(sent.number, sent.bytes);
    ASSERT_TRUE(decoded) << decoded.error().rule;
    EXPECT_EQ(decoded->substream, sent.substream);
    EXPECT_EQ(decoded->number, sent.number);
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
    const auto refuses = [&](std::uint64_t number, const Bytes& bytes, std::string_view rule, Advice what) {
      const auto decoded = receiver.push(number, bytes);
      ASSERT_FALSE(decoded) << rule;
      if (!rule.empty()) {
        EXPECT_EQ(decoded.error().rule, rule);
      }
      EXPECT_EQ(advice(decoded.error()), what) << decoded.error().rule;
      EXPECT_LE(decoded.error().bit_offset, 8 * bytes.size());
      ASSERT_EQ(image(receiver, sent[i].tick), before) << decoded.error().rule;
      ++refused;
    };
    const auto& [good, substream, number, tick, key] = sent[i];
    refuses(number, {}, "R-PKT-6", Advice::drop);
    refuses(number, {kSubstreams, 1, 0, 5}, "R-PKT-6", Advice::drop);
    refuses(number, {good[0]}, "", Advice::drop);
    Bytes longer = good;
    longer.resize(good.size() + 60, 1);
    refuses(number, longer, "", Advice::drop);  // R-RNG-2, if what it says then breaks no other rule
    longer.resize(5000);
    refuses(number, longer, "R-PKT-1", Advice::drop);
    if (last[substream] != nullptr) {
      refuses(last[substream]->number, last[substream]->bytes, "R-PKT-5", Advice::drop);
      for (const std::uint64_t ahead : {60u, 1u << 16}) refuses(number + ahead, good, "R-PKT-4", Advice::request_key);
      Bytes noise = good;
      for (int round = 0; round < 20; ++round) {
        const std::size_t at = 1 + random() % (good.size() - 1);
        noise[at] = static_cast<std::uint8_t>(random());
        auto other = Receiver::create(scene).value();
        for (std::size_t k = 0; k < i; ++k)
          if (sent[k].substream == substream) (void)other.push(sent[k].number, sent[k].bytes);
        if (const auto decoded = other.push(number, noise); !decoded)
          refuses(number, noise, decoded.error().rule, advice(decoded.error()));
      }
    }
    if (HasFatalFailure()) return;
    ASSERT_TRUE(receiver.push(number, good));
    last[substream] = &sent[i];
  }
  EXPECT_GT(refused, 1000u);
}

TEST(Receiver, AdviceIsOfTheError) {
  EXPECT_EQ(advice({Errc::truncated, "R-PKT-6"}), Advice::drop);
  EXPECT_EQ(advice({Errc::malformed, "R-RNG-2"}), Advice::drop);
  EXPECT_EQ(advice({Errc::invalid, "R-RIG-4"}), Advice::drop);
  EXPECT_EQ(advice({Errc::limit_exceeded, "R-PKT-1"}), Advice::drop);
  EXPECT_EQ(advice({Errc::state, "R-PKT-5"}), Advice::drop);
  EXPECT_EQ(advice({Errc::state, "R-PKT-4"}), Advice::request_key);
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
      const auto decoded = receiver.push(packet.number, packet.bytes);
      if (!decoded) {
        EXPECT_EQ(packet.substream, lost);
        EXPECT_EQ(advice(decoded.error()), Advice::request_key);
        ++refused;
      }
    }
    EXPECT_EQ(refused, seen - 5);
  }
}

/// What a restarted sender sends has earlier ticks. Its key packets are refused, and what was heard goes on.
TEST(Receiver, AKeyPacketOfAnEarlierTickChangesNothing) {
  const SharedScene scene = testing::scene_of_every_kind(kSquares);
  const std::vector<Sent> sent = record(scene, 30, {.key_interval = 0});
  constexpr std::array<const char*, kSubstreams> kRules{"R-RIG-1", "R-DEF-8", "R-DEF-8", "R-DEF-8"};
  auto receiver = Receiver::create(scene).value();
  std::size_t keys = 0;
  for (const Sent& packet : sent) {
    if (packet.tick == 20 && keys == 0) {
      const auto before = image(receiver, 20);
      for (const Sent& again : sent) {
        if (!again.key) continue;
        const auto decoded = receiver.push(again.number + 1000, again.bytes);
        ASSERT_FALSE(decoded);
        EXPECT_STREQ(decoded.error().rule, kRules.at(again.substream));
        EXPECT_EQ(advice(decoded.error()), Advice::drop);
        ++keys;
      }
      EXPECT_EQ(image(receiver, 20), before);
    }
    ASSERT_TRUE(receiver.push(packet.number, packet.bytes)) << packet.substream << ' ' << packet.number;
  }
  EXPECT_EQ(keys, kSubstreams);
}

TEST(Receiver, NumbersOutsideTheirRangeAreRefused) {
  const SharedScene scene = testing::scene_of_every_kind(kSquares);
  const std::vector<Sent> sent = record(scene, 2);
  auto receiver = Receiver::create(scene).value();
  const auto before = image(receiver, 2);
  constexpr std::uint64_t kLimit = std::uint64_t{1} << 62;
  for (const std::uint64_t number : {std::uint64_t{0}, kLimit, kLimit + 1, ~std::uint64_t{0}}) {
    const auto decoded = receiver.push(number, sent[0].bytes);
    ASSERT_FALSE(decoded);
    EXPECT_EQ(decoded.error().code, Errc::invalid_argument);
    EXPECT_STREQ(decoded.error().rule, "R-API-5") << number;
  }
  EXPECT_EQ(image(receiver, 2), before);
  EXPECT_EQ(receiver.push(kLimit - 1, sent[0].bytes)->number, kLimit - 1);
  EXPECT_STREQ(receiver.push(1, sent[0].bytes).error().rule, "R-PKT-5");
}

/// The position of an error counts from the front of the packet, with the number of the substream.
TEST(Receiver, PositionsCountTheSubstreamsNumber) {
  const SharedScene several = testing::scene_of_every_kind(kSquares), alone = testing::scene_of(1);
  auto a = Receiver::create(several, {.replica = {}, .limits = {.packet_bytes = 6}}).value(), b = Receiver::create(alone).value();
  const Bytes packet{0xff, 0xff, 0xff, 0xff, 0xff, 0xff};
  Bytes of_rigid = packet;
  of_rigid.insert(of_rigid.begin(), 0);
  const auto of_several = a.push(7, of_rigid), of_one = b.push(7, packet);
  ASSERT_FALSE(of_several);
  ASSERT_FALSE(of_one);
  EXPECT_GE(of_several.error().bit_offset, 8u);
  EXPECT_LE(of_one.error().bit_offset, 8 * packet.size());
  EXPECT_EQ(a.push(7, Bytes{9, 1, 1}).error().bit_offset, 0u);
  EXPECT_EQ(a.push(7, Bytes(8)).error().bit_offset, 8u) << "R-PKT-1";
}

/// In metres what the replica shows in integers.
TEST(Receiver, ShowsPosesAndShapesInMetres) {
  const SharedScene scene = testing::scene_of_every_kind(kSquares);
  auto receiver = Receiver::create(scene).value();
  for (const Sent& packet : record(scene, 20)) ASSERT_TRUE(receiver.push(packet.number, packet.bytes));
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

/// An update is shown from the tick that the client gives, or else from its own.
TEST(Receiver, AClientMayShowAPacketLater) {
  const SharedScene scene = testing::scene_of(1);
  auto sender = Sender::create(scene, {.triggers = {.reduction = Reduction::none}, .deformable = {}, .policy = {}}).value();
  const ReceiverOptions smooth{.replica = {.interpolation = Interpolation::linear}, .limits = testing::kWithThesis};
  auto live = Receiver::create(scene, smooth).value(), file = Receiver::create(scene, smooth).value();
  RigidSample sample;
  for (std::int64_t tick = 0; tick <= 80; tick += 40) {
    if (tick == 80) sample.pose.position.x = 0.03;
    const Packet packet = testing::only(sender.encode(tick, {{&sample, 1}}));
    ASSERT_TRUE(live.push(packet.number, packet.bytes, tick + 100));
    ASSERT_TRUE(file.push(packet.number, packet.bytes));
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
