// SPDX-License-Identifier: Apache-2.0
/// Loads from the sender to the receiver: bounds, baselines, what is left out.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>

#include <tactus/tactus.h>
#include "tests/unit/rigid_fixture.h"

namespace tactus {
namespace {

constexpr std::size_t kUsers = 2;

/// Two cubes that stand still and a wall, and forces that vary: slowly, with steps, and with noise.
class Pushed {
 public:
  Truth step(std::int64_t tick) {
    const double t = 1e-3 * static_cast<double>(tick);
    const double noise = std::uniform_real_distribution<double>(-0.01, 0.01)(random_);
    const double push = tick % 700 < 400 ? 2 * std::sin(3 * t) + noise : 0;
    forces_ = {Vec3{-push, 0.1 * push, 0},
               Vec3{0, 0, 1.3 + std::max(0.0, push)},
               Vec3{push, 0, 0},
               Vec3{0, 0, tick > 900 ? -5.0 : 0.0},
               Vec3{0, noise, 0},
               Vec3{0, 0, 2},
               Vec3{},
               Vec3{1e-4, 0, 0}};
    loads_ = {of(0), {}, of(4)};
    return {.objects = objects_, .loads = loads_};
  }
  const Vec3& force(std::size_t object, std::size_t vector) const { return forces_[(object == 0 ? 0 : 4) + vector]; }
  std::vector<RigidSample> objects_ = std::vector<RigidSample>(3);

 private:
  ObjectLoad of(std::size_t first) const {
    return {forces_[first], forces_[first + 1], std::span(forces_).subspan(first + kPushes, kUsers)};
  }
  std::mt19937_64 random_{45};
  std::vector<Vec3> forces_;
  std::vector<ObjectLoad> loads_;
};

SharedScene make_scene(std::uint8_t span = 1) {
  return SceneBuilder()
      .rigid("a")
      .rigid("wall", {}, {.dof = Dof::none})
      .rigid("b")
      .loads({.force_exp = 10, .users = kUsers})
      .baselines(span)
      .build()
      .value();
}

/// How far a receiver is off, as a fraction of the bound.
double worst(const Receiver& receiver, const Pushed& world, std::int64_t tick, const LoadThresholds& bound = {}) {
  double out = 0;
  for (const std::uint32_t object : {0u, 2u}) {
    const auto held = receiver.load(object, tick);
    EXPECT_EQ(held.size(), kPushes + kUsers);
    for (std::size_t v = 0; v < held.size(); ++v) {
      const Vec3& truth = world.force(object, v);
      out =
          std::max(out, norm(to_force(held[v], 10) - truth) / (bound.weber_fraction * std::max(norm(truth), bound.force_floor)));
    }
  }
  return out;
}

TEST(Loads, StayWithinTheirBoundsInAFewPackets) {
  const SharedScene scene = make_scene();
  auto sender = Sender::create(scene).value();
  auto receiver = Receiver::create(scene).value();
  Pushed world;
  std::size_t packets = 0, bytes = 0;
  for (std::int64_t tick = 0; tick < 3000; ++tick) {
    for (const Packet& packet : testing::all(sender.encode(tick, world.step(tick)))) {
      const auto decoded = receiver.push(packet.number, packet.bytes);
      ASSERT_TRUE(decoded) << decoded.error().rule;
      EXPECT_EQ(sender.state_hash(packet.substream), receiver.state_hash(packet.substream));
      if (packet.substream != load_substream(*scene)) continue;
      EXPECT_EQ(decoded->loads, packet.updates);
      ++packets;
      bytes += packet.bytes.size();
    }
    ASSERT_LE(worst(receiver, world, tick), 1 + 1e-9) << tick;
  }
  EXPECT_GT(packets, 40u);
  EXPECT_LT(packets, 150u) << "in 3 s";
  EXPECT_LT(bytes, 20 * packets);
}

TEST(Loads, EveryPacketThatArrivesCanBeUsedWhenBaselinesAreAcknowledged) {
  const SharedScene scene = make_scene(64);
  auto sender = Sender::create(scene, {.policy = {.key_interval = 0, .baseline = Baseline::acknowledged}}).value();
  sender.set_link({.ack_timeout = 60, .loss = 0.3});
  auto receiver = Receiver::create(scene).value();
  Pushed world;
  std::mt19937_64 random(7);
  std::deque<std::pair<std::int64_t, std::uint64_t>> acknowledgements;
  std::size_t lost = 0, over = 0;
  for (std::int64_t tick = 0; tick < 6000; ++tick) {
    while (!acknowledgements.empty() && acknowledgements.front().first <= tick) {
      sender.acknowledge(load_substream(*scene), acknowledgements.front().second);
      acknowledgements.pop_front();
    }
    for (const Packet& packet : testing::all(sender.encode(tick, world.step(tick)))) {
      if (packet.substream == load_substream(*scene) && random() % 10 < 3) {
        ++lost;
        continue;
      }
      ASSERT_TRUE(receiver.push(packet.number, packet.bytes));
      if (packet.substream == load_substream(*scene)) acknowledgements.emplace_back(tick + 40, packet.number);
    }
    if (tick >= 100) over += worst(receiver, world, tick) > 1 + 1e-9;
  }
  EXPECT_GT(lost, 50u);
  EXPECT_LT(over, 900u) << "of 5900 ticks at 30 % loss";
  for (std::int64_t tick = 6000; tick < 6400; ++tick) {  // then all arrives, and nothing changes
    for (const Packet& packet : testing::all(sender.encode(tick, {.objects = world.objects_, .loads = world.step(5999).loads})))
      ASSERT_TRUE(receiver.push(packet.number, packet.bytes));
  }
  EXPECT_LE(worst(receiver, world, 6399), 1 + 1e-9) << "what was lost is sent again";
}

/// Nobody names packets then: what is not acknowledged is not taken for lost.
TEST(Loads, AreNotSentAgainWhenEachPacketBuildsOnTheOneBefore) {
  std::size_t packets[2]{};
  for (const int linked : {0, 1}) {
    auto sender = Sender::create(make_scene()).value();
    if (linked) sender.set_link({.ack_timeout = 30, .loss = 0.1});
    Pushed world;
    for (std::int64_t tick = 0; tick < 2000; ++tick)
      for (const Packet& packet : testing::all(sender.encode(tick, world.step(tick)))) packets[linked] += packet.substream > 0;
  }
  EXPECT_EQ(packets[1], packets[0]);
}

TEST(Loads, OfAPastTickAreThoseOfItsState) {
  const SharedScene scene = make_scene(64);
  auto sender = Sender::create(scene).value();
  auto receiver = Receiver::create(scene).value();
  std::vector<RigidSample> still(3);
  const std::vector<Vec3> nobody(kUsers);
  for (std::int64_t tick = 0; tick < 50; tick += 10) {
    std::vector<ObjectLoad> loads(3, ObjectLoad{{static_cast<double>(tick), 0, 0}, {}, nobody});
    for (const Packet& packet : testing::all(sender.encode(tick, {.objects = still, .loads = loads})))
      ASSERT_TRUE(receiver.push(packet.number, packet.bytes));
  }
  EXPECT_NEAR(to_force(receiver.load(0, 25)[kExternal], 10).x, 20, 2);
  EXPECT_NEAR(to_force(receiver.load(2, 1000)[kExternal], 10).x, 40, 4);
  EXPECT_TRUE(receiver.load(1, 25).empty()) << "the wall cannot move";
}

TEST(Loads, AreAbsentUnlessTheSceneAsks) {
  const SharedScene plain = SceneBuilder().rigid("a").build().value();
  auto receiver = Receiver::create(plain).value();
  EXPECT_TRUE(receiver.load(0, 0).empty());
  auto sender = Sender::create(plain).value();
  const std::vector<RigidSample> still(1);
  const std::vector<ObjectLoad> loads(1);
  EXPECT_STREQ(sender.encode(0, {.objects = still, .loads = loads}).error().rule, "R-API-5");
  const SharedScene asked = SceneBuilder().rigid("a").loads({}).build().value();
  EXPECT_EQ(write_scene(*asked)->size(), write_scene(*plain)->size() + 2);
  EXPECT_EQ(state_bytes(*asked) - state_bytes(*plain), 3u * 3 * 12);
}

TEST(Loads, AreHeldOrRefusedIfTheyDoNotSuitTheScene) {
  const SharedScene scene = make_scene();
  auto sender = Sender::create(scene).value();
  const std::vector<RigidSample> still(3);
  std::vector<Vec3> nobody(kUsers);
  std::vector<ObjectLoad> loads(3, ObjectLoad{{}, {}, nobody});
  std::int64_t tick = 0;
  const auto rule = [&] {
    if (const auto packets = sender.encode(tick++, {.objects = still, .loads = loads}); !packets)
      return std::string(packets.error().rule);
    return sender.held().empty() ? std::string() : std::string(sender.held()[0].rule);
  };
  loads[0].external.x = std::nan("");
  EXPECT_EQ(rule(), "R-API-1");
  loads[0].external.x = 3e6;
  EXPECT_EQ(rule(), "R-API-2");
  loads[0].external.x = 0;
  EXPECT_EQ(rule(), "");
  nobody[1].z = INFINITY;
  EXPECT_EQ(rule(), "R-API-1");
  nobody[1].z = 0;
  EXPECT_EQ(rule(), "");
  loads[2].pushes = {};
  EXPECT_EQ(rule(), "R-API-5");
  loads.pop_back();
  EXPECT_EQ(rule(), "R-API-5");
  for (const LoadThresholds bad : {LoadThresholds{0, 1}, LoadThresholds{0.1, -1}, LoadThresholds{NAN, 1}})
    EXPECT_STREQ(Sender::create(scene, {.load = bad}).error().rule, "R-API-4");
  EXPECT_STREQ(SceneBuilder().rigid("a").loads({.force_exp = 21}).build().error().error.rule, "R-STR-19");
  EXPECT_STREQ(SceneBuilder().rigid("a", {}, {.dof = Dof::none}).loads({}).build().error().error.rule, "R-STR-19");
}

TEST(Loads, ScaleWithTheOtherBounds) {
  const SharedScene scene = make_scene();
  std::size_t packets[2]{};
  for (const int wide : {0, 1}) {
    auto sender = Sender::create(scene).value();
    if (wide) sender.set_bound_scale(4);
    Pushed world;
    for (std::int64_t tick = 0; tick < 1000; ++tick)
      for (const Packet& packet : testing::all(sender.encode(tick, world.step(tick)))) packets[wide] += packet.substream > 0;
  }
  EXPECT_LT(2 * packets[1], packets[0]);
}

TEST(Loads, ADeclarationSurvivesBytes) {
  SceneBuilder builder;
  builder.rigid("a").loads({.force_exp = 7, .users = 3}).declare_bounds({}, {}, {.weber_fraction = 0.2, .force_floor = 1});
  const SharedScene scene = builder.build().value();
  const auto parsed = parse_scene(*write_scene(*scene)).value();
  EXPECT_EQ(parsed.scene->loads, scene->loads);
  EXPECT_EQ(parsed.scene->bounds, scene->bounds);
}

}  // namespace
}  // namespace tactus
