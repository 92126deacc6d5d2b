// SPDX-License-Identifier: Apache-2.0
/// The substream of the rigid objects, from samples to what a receiver holds and shows.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <tactus/rigid/rigid_predictor.h>
#include <tactus/tactus.h>
#include "tests/unit/rigid_fixture.h"

namespace tactus {
namespace {

using testing::Motion;
using testing::only;
using testing::scene_of;
using testing::shared;
using testing::spec_of;
using testing::touch;

constexpr double kTick = 1e-3;

SenderOptions with(const RigidTriggers& triggers, const SenderPolicy& policy = {}) {
  return {.triggers = triggers, .deformable = {}, .policy = policy};
}

Pose shown(Receiver& receiver, std::uint32_t object, std::int64_t now) {
  return to_pose(receiver.replica().pose(object, now), receiver.scene()->grid.position);
}

TEST(Rigid, PredictionFollowsAStraightLineAndASteadyTurn) {
  const SharedScene scene = scene_of(1);
  const RigidPredictor predictor(*scene);
  const RigidState state = to_grid({{{1, 2, 3}, {}}, {0.5, -0.25, 0}, {0, 0, 2.0}}, 0, scene->grid).value();
  for (const std::int64_t tick : {0, 1, 10, 333, 1500}) {
    const double t = static_cast<double>(tick) * kTick;
    const Pose pose = to_pose(predictor.pose(state, tick), scene->grid.position);
    EXPECT_NEAR(pose.position.x, 1 + 0.5 * t, 1e-6);
    EXPECT_NEAR(pose.position.y, 2 - 0.25 * t, 1e-6);
    const Quat turned{std::cos(t), 0, 0, std::sin(t)};
    EXPECT_NEAR(angle_between(pose.rotation, turned), 0, 2e-5);
  }
}

TEST(Rigid, PredictionStopsAtItsLimit) {
  const SharedScene scene = scene_of(1);
  const RigidPredictor predictor(*scene);
  const RigidState state = to_grid({{}, {1, 0, 0}, {0, 0, 1}}, 0, scene->grid).value();
  EXPECT_EQ(predictor.pose(state, 2000), predictor.pose(state, 1'000'000));
  EXPECT_NE(predictor.pose(state, 1999), predictor.pose(state, 2000));
}

TEST(Rigid, PredictionSurvivesExtremeStates) {
  SceneSpec spec = spec_of(1);
  spec.max_extrapolation = 65535;
  spec.tick_rate = 1;
  RigidState state;
  state.position = {2147483647, -2147483647 - 1, 0};
  state.velocity = {2147483647, -2147483647 - 1, 2147483647};
  state.angular_velocity = {1 << 25, 1 << 25, -(1 << 25)};
  const RigidPose pose = RigidPredictor(*shared(spec)).pose(state, 65535);
  EXPECT_EQ(pose.position[0], 2147483647);
  EXPECT_EQ(pose.position[1], -2147483647 - 1);
  double square = 0;
  for (const auto c : pose.rotation) square += static_cast<double>(c) * c;
  EXPECT_NEAR(std::sqrt(square), kTick * 1000 * (1 << 30), 4.0);
}

TEST(Rigid, GridRefusesWhatItCannotHold) {
  const GridExponents grid;
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const auto rule = [&](const RigidSample& s) { return std::string(to_grid(s, 0, grid).error().rule); };
  EXPECT_EQ(rule({{{nan, 0, 0}, {}}, {}, {}}), "R-API-1");
  EXPECT_EQ(rule({{{}, {1, inf, 0, 0}}, {}, {}}), "R-API-1");
  EXPECT_EQ(rule({{}, {0, 0, -inf}, {}}), "R-API-1");
  EXPECT_EQ(rule({{}, {}, {nan, 0, 0}}), "R-API-1");
  EXPECT_EQ(rule({{{513, 0, 0}, {}}, {}, {}}), "R-API-2");
  EXPECT_EQ(rule({{}, {}, {9000, 0, 0}}), "R-API-2");
  EXPECT_EQ(rule({{{}, {0.9, 0, 0, 0}}, {}, {}}), "R-API-3");
  EXPECT_TRUE(to_grid({{{511, -511, 0}, {}}, {}, {}}, 0, grid));
}

/// Everything one run of sender and receiver side by side can break.
struct Outcome {
  int packets = 0, updates = 0, visual_violations = 0, haptic_violations = 0;
  std::array<int, 4> reasons{};
};

Outcome run(const SharedScene& scene, const RigidTriggers& triggers, std::uint64_t seed, int ticks, bool contacts) {
  std::vector<Motion> motions;
  for (std::size_t i = 0; i < scene->objects.size(); ++i) motions.emplace_back(seed * 100 + i);
  auto sender = Sender::create(scene, with(triggers)).value();
  auto receiver = Receiver::create(scene).value();
  Outcome out;
  std::vector<RigidSample> samples(scene->objects.size());
  for (int tick = 0; tick < ticks; ++tick) {
    for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = motions[i].step(kTick);
    std::vector<Contact> touching;
    if (contacts && tick % 1000 < 700) {
      touching.push_back(touch(0, samples[0].pose, 1e-3 * (1.1 + std::sin(0.01 * tick))));
      if (samples.size() > 1) touching.push_back(touch(1, samples[1].pose, 2e-3, 1200));
    }
    const auto packets = sender.encode(tick, {samples, touching});
    EXPECT_TRUE(packets) << packets.error().rule;
    if (!packets) return out;
    for (const Packet& packet : *packets) {
      const auto decoded = receiver.push(packet.number, packet.bytes);
      EXPECT_TRUE(decoded) << decoded.error().rule;
      if (!decoded) return out;
      EXPECT_EQ(decoded->tick, tick);
      EXPECT_EQ(receiver.state_hash(0), sender.state_hash(0));
      ++out.packets;
      out.updates += static_cast<int>(packet.updates);
      for (const RigidUpdate& u : decoded->updates) ++out.reasons[static_cast<std::size_t>(u.reason)];
    }
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const Pose pose = shown(receiver, static_cast<std::uint32_t>(i), tick);
      if (norm(pose.position - samples[i].pose.position) > triggers.visual_position ||
          angle_between(pose.rotation, samples[i].pose.rotation) > triggers.visual_rotation) {
        ++out.visual_violations;
      }
      for (const Contact& c : touching) {
        if (c.object != i) continue;
        const double ratio = haptic_ratio(triggers, contact_force(c, samples[i].pose), contact_force(c, pose));
        if (ratio > 1) ++out.haptic_violations;
      }
    }
  }
  return out;
}

TEST(Rigid, BoundsHoldOnWhatIsShownForEveryRule) {
  for (const bool is_smoothed : {false, true}) {
    SceneSpec spec = testing::spec_of(3);
    spec.is_smoothed = is_smoothed;
    for (const HapticRule rule : {HapticRule::off, HapticRule::isotropic, HapticRule::cone}) {
      for (const double p : {0.01, 0.04, 0.3}) {
        RigidTriggers triggers{.haptic = rule, .weber_fraction = p};
        const Outcome result = run(testing::shared(spec), triggers, 1, 4000, rule != HapticRule::off);
        EXPECT_GT(result.packets, 20);
        EXPECT_EQ(result.visual_violations, 0);
        EXPECT_EQ(result.haptic_violations, 0) << "p = " << p;
        EXPECT_EQ(result.reasons[3] > 0, rule != HapticRule::off);
      }
    }
  }
}

TEST(Rigid, ATighterHapticRuleSendsMore) {
  RigidTriggers loose, tight;
  loose.weber_fraction = 0.3;
  tight.weber_fraction = 0.02;
  EXPECT_GT(run(scene_of(1), tight, 2, 4000, true).packets, run(scene_of(1), loose, 2, 4000, true).packets);
}

TEST(Rigid, FixedThresholdsHoldInContact) {
  RigidTriggers triggers;
  triggers.haptic = HapticRule::fixed;
  triggers.visual_position = 0.05;
  triggers.visual_rotation = 0.5;
  const Outcome result = run(scene_of(1), triggers, 3, 3000, true);
  EXPECT_GT(result.reasons[static_cast<std::size_t>(Reason::haptic)], 0);
}

TEST(Rigid, WithoutReductionEveryTickIsSent) {
  const Outcome result = run(scene_of(2), {.reduction = Reduction::none}, 4, 300, false);
  EXPECT_EQ(result.packets, 300);
  EXPECT_EQ(result.updates, 600);
}

TEST(Rigid, HeartbeatOfAnObjectAtRest) {
  auto sender = Sender::create(scene_of(1), with({}, {.key_interval = 0})).value();
  const RigidSample rest;
  std::vector<std::int64_t> sent;
  for (std::int64_t tick = 0; tick < 3500; ++tick) {
    const Packet packet = only(sender.encode(tick, {{&rest, 1}}));
    if (packet.bytes.empty()) continue;
    EXPECT_EQ(packet.reason, Reason::heartbeat);
    EXPECT_LE(packet.bytes.size(), tick == 1000 ? 5u : 4u);
    sent.push_back(tick);
  }
  EXPECT_EQ(sent, (std::vector<std::int64_t>{1000, 2000, 3000}));
}

TEST(Rigid, ObjectsAtRestStayAtRestAtTheReceiver) {
  const SharedScene scene = scene_of(1);
  auto sender = Sender::create(scene).value();
  auto receiver = Receiver::create(scene).value();
  RigidSample sample;
  sample.pose.position = {0.1, 0.0123456, 0};
  sample.velocity = {0.3, 0, 0};
  for (std::int64_t tick = 0; tick < 4000; ++tick) {
    if (tick == 100) sample.velocity = {};
    if (tick < 100) sample.pose.position.x += 0.3e-3;
    const Packet packet = only(sender.encode(tick, {{&sample, 1}}));
    ASSERT_TRUE(packet.bytes.empty() || receiver.push(packet.number, packet.bytes));
  }
  EXPECT_EQ(receiver.object(0).velocity, (std::array<std::int32_t, 3>{}));
}

TEST(Rigid, AnObjectThatCanOnlySlideSendsOneCoordinate) {
  const auto bytes_of = [&](std::uint8_t dof) {
    auto sender = Sender::create(scene_of(1, dof), with({.reduction = Reduction::none})).value();
    std::size_t bytes = 0;
    for (std::int64_t tick = 0; tick < 500; ++tick) {
      RigidSample sample;
      sample.pose.position.x = 0.05 * std::sin(0.02 * static_cast<double>(tick));
      sample.velocity.x = std::cos(0.02 * static_cast<double>(tick));
      bytes += only(sender.encode(tick, {{&sample, 1}})).bytes.size();
    }
    return bytes;
  };
  EXPECT_LT(bytes_of(Dof::x), bytes_of(Dof::all)) << "zeros are cheap, absent coordinates are free";
}

TEST(Rigid, MotionAlongALockedAxisIsHeld) {
  auto sender = Sender::create(scene_of(1, Dof::x | Dof::rz)).value();
  std::int64_t tick = 0;
  const auto rule = [&](const RigidSample& s) {
    testing::all(sender.encode(++tick, {{&s, 1}}));
    return sender.held().empty() ? std::string() : std::string(sender.held()[0].rule);
  };
  RigidSample sample;
  sample.pose.position = {0, 0.001, 0};
  EXPECT_EQ(rule(sample), "R-API-6");
  sample.pose = {{}, {std::cos(0.1), std::sin(0.1), 0, 0}};
  EXPECT_EQ(rule(sample), "R-API-6");
  sample.pose = {{0.3, 0, 0}, {std::cos(0.1), 0, 0, std::sin(0.1)}};
  EXPECT_EQ(rule(sample), "");
}

TEST(Rigid, StaticObjectsCostNothing) {
  SceneSpec walls = spec_of(1);
  walls.objects.insert(walls.objects.begin(), 50, {});
  for (std::size_t i = 0; i < 50; ++i) {
    walls.objects[i].name = "wall " + std::to_string(i);
    walls.objects[i].dof = Dof::none;
  }
  auto a = Sender::create(shared(walls)).value(), b = Sender::create(scene_of(1)).value();
  Motion motion(5);
  for (std::int64_t tick = 0; tick < 2000; ++tick) {
    std::vector<RigidSample> samples(51);
    samples[50] = motion.step(kTick);
    const Packet pa = only(a.encode(tick, {samples})), pb = only(b.encode(tick, {{&samples[50], 1}}));
    ASSERT_TRUE(std::ranges::equal(pa.bytes, pb.bytes)) << "tick " << tick;
  }
}

TEST(Rigid, BadCallsLeaveTheSenderAsItWas) {
  auto sender = Sender::create(scene_of(1)).value();
  RigidSample sample;
  sample.pose.position.x = 0.2;
  ASSERT_FALSE(only(sender.encode(5, {{&sample, 1}})).bytes.empty());
  const auto refuse = [&](std::int64_t tick, std::span<const RigidSample> s, std::vector<Contact> c) {
    const std::uint64_t before = sender.state_hash(0);
    const auto result = sender.encode(tick, {s, c});
    if (result) return std::string();
    EXPECT_EQ(sender.state_hash(0), before);
    return std::string(result.error().rule);
  };
  EXPECT_EQ(refuse(5, {&sample, 1}, {}), "R-API-5") << "same tick twice";
  EXPECT_EQ(refuse(6, {}, {}), "R-API-5") << "no samples";
  std::int64_t tick = 5;
  const auto held = [&](const Contact& contact) {
    testing::all(sender.encode(++tick, {{&sample, 1}, {&contact, 1}}));
    return sender.held().empty() ? std::string() : std::string(sender.held()[0].rule);
  };
  Contact contact = touch(1, sample.pose, 0.001);
  EXPECT_EQ(held(contact), "R-API-15") << "no such object";
  contact = touch(0, sample.pose, 0.001);
  contact.stiffness = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(held(contact), "R-API-1");
  contact = touch(0, sample.pose, 0.001);
  contact.normal = {0, 0, 2};
  EXPECT_EQ(held(contact), "R-API-15");
  contact = touch(0, sample.pose, 1e-3, 1e9);
  EXPECT_EQ(held(contact), "") << "the held state may be good enough";
  sample.pose.position.x = 0.3;
  contact = touch(0, sample.pose, 1e-10, 1e9);
  contact.normal = {1, 0, 0};  // 0.3 m is no multiple of the grid step
  contact.point = {0.02, 0, 0};
  contact.device = {0.32 - 1e-10, 0, 0};
  EXPECT_EQ(held(contact), "") << "finer than the grid: the nearest point on it";
}

/// 4 % of 1 mN at 630 N/m is a third of a grid step: what can be kept is the grid's rounding, in the middle of a run too.
TEST(Rigid, AForceBoundFinerThanTheGridMeansTheNearestPointOnIt) {
  const SharedScene scene = scene_of(1);
  auto sender = Sender::create(scene, with({.heartbeat = 0, .weber_fraction = 0.04, .force_floor = 0.001})).value();
  auto receiver = Receiver::create(scene).value();
  Motion motion(3);
  RigidSample sample;
  const double step = std::ldexp(1.0, -scene->grid.position);
  const auto send = [&](std::int64_t tick) {
    const Contact contact = touch(0, sample.pose, 1e-7, 630);
    const Packet packet = only(sender.encode(tick, {{&sample, 1}, {&contact, 1}}));
    if (packet.bytes.empty()) return false;
    EXPECT_TRUE(receiver.push(packet.number, packet.bytes));
    return true;
  };
  for (std::int64_t tick = 0; tick < 500; ++tick) {
    sample = motion.step(kTick);
    send(tick);
    const Contact contact = touch(0, sample.pose, 1e-7, 630);
    const Vec3 estimate = contact_force(contact, shown(receiver, 0, tick));
    EXPECT_LT(norm(estimate - contact_force(contact, sample.pose)), 630 * 2 * step) << tick;
  }
  sample.velocity = sample.angular_velocity = {};
  int sent = 0;
  for (std::int64_t tick = 500; tick < 1000; ++tick) sent += send(tick) ? 1 : 0;
  EXPECT_LT(sent, 5) << "at rest nothing can be sent better";
}

TEST(Rigid, OptionsOutsideTheirRangeAreRefused) {
  const auto rule = [](auto change) {
    SenderOptions options;
    change(options);
    const auto sender = Sender::create(scene_of(1), options);
    return sender ? std::string() : std::string(sender.error().rule);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(rule([](auto& o) { o.triggers.visual_position = 1e-7; }), "R-API-4") << "finer than the grid";
  EXPECT_EQ(rule([](auto& o) { o.triggers.visual_rotation = 4; }), "R-API-4");
  EXPECT_EQ(rule([](auto& o) { o.triggers.weber_fraction = 0; }), "R-API-4");
  EXPECT_EQ(rule([](auto& o) { o.triggers.weber_fraction = 4; }), "R-API-4") << "400 %";
  EXPECT_EQ(rule([](auto& o) { o.triggers.perceptual_fraction = 4; }), "R-API-4") << "of what people notice";
  EXPECT_EQ(rule([&](auto& o) { o.triggers.weber_fraction = nan; }), "R-API-4");
  EXPECT_EQ(rule([&](auto& o) { o.triggers.visual_position = nan; }), "R-API-4");
  EXPECT_EQ(rule([](auto& o) { o.triggers.heartbeat = -1; }), "R-API-4");
  EXPECT_EQ(rule([](auto& o) { o.policy.key_interval = -1; }), "R-API-4");
  EXPECT_EQ(rule([&](auto& o) { o.policy.key_interval = nan; }), "R-API-4");
  EXPECT_EQ(rule([](auto&) {}), "");
}

TEST(Rigid, AKeyPacketAloneRestoresTheWholeScene) {
  const SharedScene scene = scene_of(4);
  auto sender = Sender::create(scene, with({}, {.key_interval = 0.5})).value();
  std::vector<Motion> motions{Motion(1), Motion(2), Motion(3), Motion(4)};
  int keys = 0;
  for (std::int64_t tick = 0; tick < 3000; ++tick) {
    std::vector<RigidSample> samples;
    for (Motion& m : motions) samples.push_back(m.step(kTick));
    const Packet packet = only(sender.encode(tick, {samples}));
    if (!packet.key) continue;
    ++keys;
    auto late = Receiver::create(scene).value();
    ASSERT_TRUE(late.push(packet.number, packet.bytes));
    EXPECT_EQ(late.state_hash(0), sender.state_hash(0));
  }
  EXPECT_GE(keys, 5);
}

TEST(Rigid, AKeyPacketHoldsTheBoundsAfterAHalfTurn) {
  const SharedScene scene = scene_of(1);
  for (int i = -20; i <= 20; ++i) {
    auto sender = Sender::create(scene).value();
    auto receiver = Receiver::create(scene).value();
    const double half = (std::numbers::pi + 1e-5 * i) / 2;
    RigidSample sample;
    sample.pose.rotation = {std::cos(half), 0.6 * std::sin(half), 0, 0.8 * std::sin(half)};
    const Contact contact = touch(0, sample.pose, 1e-4);
    ASSERT_TRUE(receiver.push(1, only(sender.encode(0, {{&sample, 1}, {&contact, 1}})).bytes));
    const Vec3 estimate = contact_force(contact, shown(receiver, 0, 0));
    EXPECT_LE(haptic_ratio({}, contact_force(contact, sample.pose), estimate), 1);
  }
}

TEST(Rigid, JumpsAcrossTheWholeGridStayDecodable) {
  SceneSpec spec = spec_of(1);
  spec.grid = {30, 30, 28, 20};
  const SharedScene scene = shared(spec);
  auto sender = Sender::create(scene, with({.reduction = Reduction::none})).value();
  auto receiver = Receiver::create(scene).value();
  for (std::int64_t tick = 0; tick < 20; ++tick) {
    RigidSample sample;
    sample.velocity.x = tick % 2 == 0 ? 1.0 : -1.2;  // a change of more than 2^31 grid steps
    const Packet packet = only(sender.encode(tick, {{&sample, 1}}));
    const auto decoded = receiver.push(packet.number, packet.bytes);
    ASSERT_TRUE(decoded) << decoded.error().rule;
    EXPECT_EQ(receiver.state_hash(0), sender.state_hash(0));
  }
}

TEST(Rigid, AStiffContactBeyondTheReachOfTheFinestLevelIsSentOneLevelUp) {
  SceneSpec spec = spec_of(1);
  spec.objects[0].initial.position = {-2100000000, 0, 0};  // farther from the truth than 2^31 steps of level 0
  const SharedScene scene = shared(spec);
  auto sender = Sender::create(scene, with({.haptic = HapticRule::isotropic, .weber_fraction = 0.04})).value();
  auto receiver = Receiver::create(scene).value();
  const double stiffness = 5e4;  // one grid step is 0.3 of the permitted error
  RigidSample sample;
  sample.pose.position = {500, 0, 11 * 0x1p-22};  // eleven grid steps: one off at level 1
  const Contact contact = touch(0, sample.pose, 1 / stiffness, stiffness);
  ASSERT_TRUE(receiver.push(1, only(sender.encode(1, {{&sample, 1}, {&contact, 1}})).bytes));
  const Vec3 estimate = contact_force(contact, shown(receiver, 0, 1));
  EXPECT_LE(haptic_ratio({.weber_fraction = 0.04}, contact_force(contact, sample.pose), estimate), 1);
}

TEST(Rigid, LostAndStalePacketsChangeNothing) {
  const SharedScene scene = scene_of(1);
  auto sender = Sender::create(scene, with({.reduction = Reduction::none})).value();
  auto receiver = Receiver::create(scene).value();
  Motion motion(6);
  std::vector<std::vector<std::uint8_t>> packets;
  for (std::int64_t tick = 0; tick < 4; ++tick) {
    const RigidSample sample = motion.step(kTick);
    const Packet packet = only(sender.encode(tick, {{&sample, 1}}));
    packets.emplace_back(packet.bytes.begin(), packet.bytes.end());
  }
  ASSERT_TRUE(receiver.push(1, packets[0]));
  const auto hash = receiver.state_hash(0);
  EXPECT_STREQ(receiver.push(3, packets[2]).error().rule, "R-PKT-4") << "its baseline never arrived";
  EXPECT_STREQ(receiver.push(1, packets[0]).error().rule, "R-PKT-5") << "a duplicate";
  EXPECT_EQ(receiver.state_hash(0), hash);
  EXPECT_TRUE(receiver.push(2, packets[1])) << "what was lost may still come";
}

/// A packet is lost, and the receiver asks for a key packet as soon as it notices.
TEST(Rigid, ARequestedKeyPacketRepairsALoss) {
  constexpr std::size_t kObjects = 3;
  for (const std::uint8_t span : {std::uint8_t{1}, std::uint8_t{8}}) {
    SceneSpec spec = spec_of(kObjects);
    spec.baseline_span = span;
    const SharedScene scene = shared(spec);
    auto sender = Sender::create(scene, with({}, {.key_interval = 0})).value();
    auto receiver = Receiver::create(scene).value();
    std::vector<Motion> motions{Motion(1), Motion(2), Motion(3)};
    std::vector<RigidSample> samples(kObjects);
    std::size_t lost = 0, refused = 0, keys = 0;
    for (std::int64_t tick = 0; tick < 2000; ++tick) {
      for (std::size_t i = 0; i < kObjects; ++i) samples[i] = motions[i].step(kTick);
      const Packet packet = only(sender.encode(tick, {samples}));
      if (packet.bytes.empty()) continue;
      keys += packet.key ? 1U : 0U;
      if (tick >= 200 && lost < 5 && lost == refused && !packet.key) {
        ++lost;
        continue;
      }
      if (const auto decoded = receiver.push(packet.number, packet.bytes); !decoded) {
        ASSERT_STREQ(decoded.error().rule, "R-PKT-4") << tick;
        ++refused;
        sender.request_key();
        continue;
      }
      ASSERT_EQ(receiver.state_hash(0), sender.state_hash(0)) << tick;
    }
    EXPECT_EQ(lost, 5U);
    EXPECT_EQ(refused, lost) << "the packet after each loss, and no other";
    EXPECT_EQ(keys, 1 + lost);
  }
}

TEST(Rigid, ARequestedKeyPacketComesWithoutATrigger) {
  const SharedScene scene = scene_of(2);
  auto sender = Sender::create(scene, with({.heartbeat = 0}, {.key_interval = 0})).value();
  auto late = Receiver::create(scene).value();
  std::vector<RigidSample> samples(2);
  sender.request_key();
  EXPECT_TRUE(sender.encode(0, {samples})->empty()) << "nothing has left the initial state";
  samples[1].pose.position = {1, 0, 0};
  ASSERT_TRUE(only(sender.encode(1, {samples})).key);
  EXPECT_TRUE(sender.encode(2, {samples})->empty());
  sender.request_key();
  const Packet packet = only(sender.encode(3, {samples}));
  ASSERT_TRUE(packet.key);
  EXPECT_EQ(packet.updates, 1U);
  ASSERT_TRUE(late.push(packet.number, packet.bytes));
  EXPECT_EQ(late.state_hash(0), sender.state_hash(0));
  EXPECT_TRUE(sender.encode(4, {samples})->empty()) << "once for each request";
}

}  // namespace
}  // namespace tactus
