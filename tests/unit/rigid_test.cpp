// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/rigid.h>

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include <tactus/rigid/rigid_decoder.h>
#include <tactus/rigid/rigid_encoder.h>
#include "tests/unit/rigid_fixture.h"

namespace tactus {
namespace {

using testing::Motion;
using testing::scene_of;
using testing::touch;

constexpr double kTick = 1e-3;

TEST(Rigid, PredictionFollowsAStraightLineAndASteadyTurn) {
  const StreamHeader header = scene_of(1);
  RigidState state = to_grid({{{1, 2, 3}, {}}, {0.5, -0.25, 0}, {0, 0, 2.0}}, 0, header.grid).value();
  for (const std::int64_t tick : {0, 1, 10, 333, 1500}) {
    const double t = static_cast<double>(tick) * kTick;
    const Pose pose = to_pose(predict(state, tick, header), header.grid);
    EXPECT_NEAR(pose.position.x, 1 + 0.5 * t, 1e-6);
    EXPECT_NEAR(pose.position.y, 2 - 0.25 * t, 1e-6);
    const Quat turned{std::cos(t), 0, 0, std::sin(t)};
    EXPECT_NEAR(angle_between(pose.rotation, turned), 0, 2e-5);
  }
}

TEST(Rigid, PredictionStopsAtItsLimit) {
  const StreamHeader header = scene_of(1);
  const RigidState state = to_grid({{}, {1, 0, 0}, {0, 0, 1}}, 0, header.grid).value();
  EXPECT_EQ(predict(state, 2000, header), predict(state, 1'000'000, header));
  EXPECT_NE(predict(state, 1999, header), predict(state, 2000, header));
}

TEST(Rigid, PredictionSurvivesExtremeStates) {
  StreamHeader header = scene_of(1);
  header.max_extrapolation = 65535;
  header.tick_rate = 1;
  RigidState state;
  state.position = {2147483647, -2147483647 - 1, 0};
  state.velocity = {2147483647, -2147483647 - 1, 2147483647};
  state.spin = {1 << 25, 1 << 25, -(1 << 25)};
  const RigidPose pose = predict(state, 65535, header);
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

/// Everything one run of encoder and decoder side by side can break.
struct Outcome {
  int packets = 0, updates = 0, visual_violations = 0, haptic_violations = 0;
  std::array<int, 4> reasons{};
};

Outcome run(StreamHeader header, const RigidEncoderOptions& options, std::uint64_t seed, int ticks, bool contacts) {
  std::vector<Motion> motions;
  for (std::size_t i = 0; i < header.objects.size(); ++i) motions.emplace_back(seed * 100 + i);
  auto encoder = RigidEncoder::create(header, options).value();
  auto decoder = RigidDecoder::create(header).value();
  Outcome out;
  std::vector<RigidSample> samples(header.objects.size());
  for (int tick = 0; tick < ticks; ++tick) {
    for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = motions[i].step(kTick);
    std::vector<Contact> touching;
    if (contacts && tick % 1000 < 700) {
      touching.push_back(touch(0, samples[0].pose, 1e-3 * (1.1 + std::sin(0.01 * tick))));
      if (samples.size() > 1) touching.push_back(touch(1, samples[1].pose, 2e-3, 1200));
    }
    const auto packet = encoder.encode(tick, samples, touching);
    EXPECT_TRUE(packet) << packet.error().rule;
    if (!packet) return out;
    if (!packet->bytes.empty()) {
      const auto decoded = decoder.decode(packet->bytes);
      EXPECT_TRUE(decoded) << decoded.error().rule;
      if (!decoded) return out;
      EXPECT_EQ(decoded->tick, tick);
      EXPECT_EQ(decoder.state_hash(), encoder.state_hash());
      ++out.packets;
      out.updates += static_cast<int>(packet->updates);
      for (const RigidUpdate& u : decoded->updates) ++out.reasons[static_cast<std::size_t>(u.reason)];
    }
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const Pose shown = to_pose(predict(decoder.objects()[i], tick, header), header.grid);
      if (norm(shown.position - samples[i].pose.position) > options.triggers.visual_position ||
          angle_between(shown.rotation, samples[i].pose.rotation) > options.triggers.visual_rotation) {
        ++out.visual_violations;
      }
      for (const Contact& c : touching) {
        if (c.object != i) continue;
        const double ratio = haptic_ratio(options.triggers, contact_force(c, samples[i].pose), contact_force(c, shown));
        if (ratio > 1) ++out.haptic_violations;
      }
    }
  }
  return out;
}

TEST(Rigid, BoundsHoldOnDecoderOutputForEveryRule) {
  for (const HapticRule rule : {HapticRule::off, HapticRule::isotropic, HapticRule::cone}) {
    for (const double p : {0.01, 0.04, 0.3}) {
      RigidEncoderOptions options;
      options.triggers.haptic = rule;
      options.triggers.weber_fraction = p;
      const Outcome result = run(scene_of(3), options, 1, 4000, rule != HapticRule::off);
      EXPECT_GT(result.packets, 20);
      EXPECT_EQ(result.visual_violations, 0);
      EXPECT_EQ(result.haptic_violations, 0) << "p = " << p;
      EXPECT_EQ(result.reasons[3] > 0, rule != HapticRule::off);
    }
  }
}

TEST(Rigid, ATighterHapticRuleSendsMore) {
  RigidEncoderOptions loose, tight;
  loose.triggers.weber_fraction = 0.3;
  tight.triggers.weber_fraction = 0.02;
  EXPECT_GT(run(scene_of(1), tight, 2, 4000, true).packets, run(scene_of(1), loose, 2, 4000, true).packets);
}

TEST(Rigid, FixedThresholdsHoldInContact) {
  RigidEncoderOptions options;
  options.triggers.haptic = HapticRule::fixed;
  options.triggers.visual_position = 0.05;
  options.triggers.visual_rotation = 0.5;
  const Outcome result = run(scene_of(1), options, 3, 3000, true);
  EXPECT_GT(result.reasons[static_cast<std::size_t>(Reason::haptic)], 0);
}

TEST(Rigid, WithoutReductionEveryTickIsSent) {
  RigidEncoderOptions options;
  options.triggers.reduction = Reduction::none;
  const Outcome result = run(scene_of(2), options, 4, 300, false);
  EXPECT_EQ(result.packets, 300);
  EXPECT_EQ(result.updates, 600);
}

TEST(Rigid, HeartbeatOfAnObjectAtRest) {
  const StreamHeader header = scene_of(1);
  RigidEncoderOptions options;
  options.key_interval = 0;
  auto encoder = RigidEncoder::create(header, options).value();
  const RigidSample rest;
  std::vector<std::int64_t> sent;
  for (std::int64_t tick = 0; tick < 3500; ++tick) {
    const auto packet = encoder.encode(tick, {&rest, 1}, {}).value();
    if (packet.bytes.empty()) continue;
    EXPECT_EQ(packet.reason, Reason::heartbeat);
    EXPECT_LE(packet.bytes.size(), tick == 1000 ? 7u : 6u);
    sent.push_back(tick);
  }
  EXPECT_EQ(sent, (std::vector<std::int64_t>{1000, 2000, 3000}));
}

TEST(Rigid, ObjectsAtRestStayAtRestOnTheDecoder) {
  StreamHeader header = scene_of(1);
  auto encoder = RigidEncoder::create(header).value();
  auto decoder = RigidDecoder::create(header).value();
  RigidSample sample;
  sample.pose.position = {0.1, 0.0123456, 0};
  sample.velocity = {0.3, 0, 0};
  for (std::int64_t tick = 0; tick < 4000; ++tick) {
    if (tick == 100) sample.velocity = {};
    if (tick < 100) sample.pose.position.x += 0.3e-3;
    const auto packet = encoder.encode(tick, {&sample, 1}, {}).value();
    ASSERT_TRUE(packet.bytes.empty() || decoder.decode(packet.bytes));
  }
  EXPECT_EQ(decoder.objects()[0].velocity, (std::array<std::int32_t, 3>{}));
}

TEST(Rigid, AnObjectThatCanOnlySlideSendsOneCoordinate) {
  RigidEncoderOptions options;
  options.triggers.reduction = Reduction::none;
  const auto bytes_of = [&](std::uint8_t dof) {
    auto encoder = RigidEncoder::create(scene_of(1, dof), options).value();
    std::size_t bytes = 0;
    for (std::int64_t tick = 0; tick < 500; ++tick) {
      RigidSample sample;
      sample.pose.position.x = 0.05 * std::sin(0.02 * static_cast<double>(tick));
      sample.velocity.x = std::cos(0.02 * static_cast<double>(tick));
      bytes += encoder.encode(tick, {&sample, 1}, {}).value().bytes.size();
    }
    return bytes;
  };
  EXPECT_LT(bytes_of(Dof::x), bytes_of(Dof::all)) << "zeros are cheap, absent coordinates are free";
}

TEST(Rigid, MotionAlongALockedAxisIsRefused) {
  auto encoder = RigidEncoder::create(scene_of(1, Dof::x | Dof::rz)).value();
  const auto rule = [&](const RigidSample& s) {
    const auto result = encoder.encode(1, {&s, 1}, {});
    return result ? std::string() : std::string(result.error().rule);
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
  StreamHeader with = scene_of(1), without = scene_of(1);
  with.objects.insert(with.objects.begin(), 50, {});
  for (std::size_t i = 0; i < 50; ++i) {
    with.objects[i].name = "wall " + std::to_string(i);
    with.objects[i].dof = Dof::none;
  }
  auto a = RigidEncoder::create(with).value(), b = RigidEncoder::create(without).value();
  Motion motion(5);
  for (std::int64_t tick = 0; tick < 2000; ++tick) {
    std::vector<RigidSample> samples(51);
    samples[50] = motion.step(kTick);
    const auto pa = a.encode(tick, samples, {}).value(), pb = b.encode(tick, {&samples[50], 1}, {}).value();
    ASSERT_TRUE(std::ranges::equal(pa.bytes, pb.bytes)) << "tick " << tick;
  }
}

TEST(Rigid, BadCallsLeaveTheEncoderAsItWas) {
  auto encoder = RigidEncoder::create(scene_of(1)).value();
  RigidSample sample;
  sample.pose.position.x = 0.2;
  ASSERT_FALSE(encoder.encode(5, {&sample, 1}, {}).value().bytes.empty());
  const auto before = encoder.state_hash();
  const auto refuse = [&](std::int64_t tick, std::span<const RigidSample> s, std::vector<Contact> c) {
    const auto result = encoder.encode(tick, s, c);
    return result ? std::string() : std::string(result.error().rule);
  };
  EXPECT_EQ(refuse(5, {&sample, 1}, {}), "R-API-5") << "same tick twice";
  EXPECT_EQ(refuse(6, {}, {}), "R-API-5") << "no samples";
  Contact contact = touch(1, sample.pose, 0.001);
  EXPECT_EQ(refuse(6, {&sample, 1}, {contact}), "R-API-5") << "no such object";
  contact = touch(0, sample.pose, 0.001);
  contact.stiffness = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refuse(6, {&sample, 1}, {contact}), "R-API-5");
  contact = touch(0, sample.pose, 0.001);
  contact.normal = {0, 0, 2};
  EXPECT_EQ(refuse(6, {&sample, 1}, {contact}), "R-API-5");
  contact = touch(0, sample.pose, 1e-3, 1e9);
  EXPECT_EQ(refuse(6, {&sample, 1}, {contact}), "") << "the held state may be good enough";
  sample.pose.position.x = 0.3;
  contact = touch(0, sample.pose, 1e-10, 1e9);
  contact.normal = {1, 0, 0};  // 0.3 m is no multiple of the grid step
  contact.point = {0.02, 0, 0};
  contact.device = {0.32 - 1e-10, 0, 0};
  EXPECT_EQ(refuse(7, {&sample, 1}, {contact}), "") << "finer than the grid: the nearest place on it";
  sample.pose.position.x = std::numeric_limits<double>::infinity();
  EXPECT_EQ(refuse(8, {&sample, 1}, {}), "R-API-1");
  sample.pose.position.x = 0.2;
  EXPECT_TRUE(encoder.encode(8, {&sample, 1}, {}));
  EXPECT_NE(before, 0u);
}

/// 4 % of 1 mN at 630 N/m is a third of a grid step: what can be kept is the grid's rounding, in the middle of a run too.
TEST(Rigid, AForceBoundFinerThanTheGridMeansTheNearestPlaceOnIt) {
  const StreamHeader header = scene_of(1);
  RigidEncoderOptions options;
  options.triggers.weber_fraction = 0.04;
  options.triggers.force_floor = 0.001;
  options.triggers.heartbeat = 0;
  auto encoder = RigidEncoder::create(header, options).value();
  auto decoder = RigidDecoder::create(header).value();
  Motion motion(3);
  RigidSample sample;
  const double step = std::ldexp(1.0, -header.grid.position);
  const auto send = [&](std::int64_t tick) {
    const Contact contact = touch(0, sample.pose, 1e-7, 630);
    const auto packet = encoder.encode(tick, {&sample, 1}, {&contact, 1});
    EXPECT_TRUE(packet) << tick;
    if (!packet || packet->bytes.empty()) return false;
    EXPECT_TRUE(decoder.decode(packet->bytes));
    return true;
  };
  for (std::int64_t tick = 0; tick < 500; ++tick) {
    sample = motion.step(kTick);
    send(tick);
    const Pose shown = to_pose(predict(decoder.objects()[0], tick, header), header.grid);
    const Contact contact = touch(0, sample.pose, 1e-7, 630);
    EXPECT_LT(norm(contact_force(contact, shown) - contact_force(contact, sample.pose)), 630 * 2 * step) << tick;
  }
  sample.velocity = sample.angular_velocity = {};
  int sent = 0;
  for (std::int64_t tick = 500; tick < 1000; ++tick) sent += send(tick) ? 1 : 0;
  EXPECT_LT(sent, 5) << "at rest nothing can be told better";
}

TEST(Rigid, OptionsOutsideTheirRangeAreRefused) {
  const auto rule = [](auto change) {
    RigidEncoderOptions options;
    change(options);
    const auto encoder = RigidEncoder::create(scene_of(1), options);
    return encoder ? std::string() : std::string(encoder.error().rule);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(rule([](auto& o) { o.triggers.visual_position = 1e-7; }), "R-API-4") << "finer than the grid";
  EXPECT_EQ(rule([](auto& o) { o.triggers.visual_rotation = 4; }), "R-API-4");
  EXPECT_EQ(rule([](auto& o) { o.triggers.weber_fraction = 0; }), "R-API-4");
  EXPECT_EQ(rule([&](auto& o) { o.triggers.weber_fraction = nan; }), "R-API-4");
  EXPECT_EQ(rule([&](auto& o) { o.triggers.visual_position = nan; }), "R-API-4");
  EXPECT_EQ(rule([](auto& o) { o.triggers.heartbeat = -1; }), "R-API-4");
  EXPECT_EQ(rule([](auto& o) { o.key_interval = -1; }), "R-API-4");
  EXPECT_EQ(rule([](auto&) {}), "");
}

TEST(Rigid, AKeyPacketAloneRestoresTheWholeScene) {
  const StreamHeader header = scene_of(4);
  RigidEncoderOptions options;
  options.key_interval = 0.5;
  auto encoder = RigidEncoder::create(header, options).value();
  std::vector<Motion> motions{Motion(1), Motion(2), Motion(3), Motion(4)};
  int keys = 0;
  for (std::int64_t tick = 0; tick < 3000; ++tick) {
    std::vector<RigidSample> samples;
    for (Motion& m : motions) samples.push_back(m.step(kTick));
    const auto packet = encoder.encode(tick, samples, {}).value();
    if (!packet.key) continue;
    ++keys;
    auto late = RigidDecoder::create(header).value();
    ASSERT_TRUE(late.decode(packet.bytes));
    EXPECT_EQ(late.state_hash(), encoder.state_hash());
  }
  EXPECT_GE(keys, 5);
}

TEST(Rigid, AKeyPacketHoldsTheBoundsAfterAHalfTurn) {
  const StreamHeader header = scene_of(1);
  for (int i = -20; i <= 20; ++i) {
    auto encoder = RigidEncoder::create(header).value();
    auto decoder = RigidDecoder::create(header).value();
    const double half = (std::numbers::pi + 1e-5 * i) / 2;
    RigidSample sample;
    sample.pose.rotation = {std::cos(half), 0.6 * std::sin(half), 0, 0.8 * std::sin(half)};
    const Contact contact = touch(0, sample.pose, 1e-4);
    const auto packet = encoder.encode(0, {&sample, 1}, {&contact, 1});
    ASSERT_TRUE(packet) << packet.error().rule;
    ASSERT_TRUE(decoder.decode(packet->bytes));
    const Pose shown = to_pose(predict(decoder.objects()[0], 0, header), header.grid);
    EXPECT_LE(haptic_ratio({}, contact_force(contact, sample.pose), contact_force(contact, shown)), 1);
  }
}

TEST(Rigid, JumpsAcrossTheWholeGridStayDecodable) {
  StreamHeader header = scene_of(1);
  header.grid = {30, 30, 28, 20};
  RigidEncoderOptions options;
  options.triggers.reduction = Reduction::none;
  auto encoder = RigidEncoder::create(header, options).value();
  auto decoder = RigidDecoder::create(header).value();
  for (std::int64_t tick = 0; tick < 20; ++tick) {
    RigidSample sample;
    sample.velocity.x = tick % 2 == 0 ? 1.0 : -1.2;  // a change of more than 2^31 grid steps
    const auto packet = encoder.encode(tick, {&sample, 1}, {});
    ASSERT_TRUE(packet) << packet.error().rule;
    const auto decoded = decoder.decode(packet->bytes);
    ASSERT_TRUE(decoded) << decoded.error().rule;
    EXPECT_EQ(decoder.state_hash(), encoder.state_hash());
  }
}

TEST(Rigid, AStiffContactBeyondTheReachOfTheFinestLevelIsSentOneLevelUp) {
  StreamHeader header = scene_of(1);
  header.objects[0].initial.position = {-2100000000, 0, 0};  // farther from the truth than 2^31 steps of level 0
  auto encoder = RigidEncoder::create(header, {.triggers = {.haptic = HapticRule::isotropic, .weber_fraction = 0.04}}).value();
  auto decoder = RigidDecoder::create(header).value();
  const double stiffness = 5e4;  // two grid steps are 0.6 of the permitted error
  RigidSample sample;
  sample.pose.position = {500, 0, 10 * 0x1p-22};  // ten grid steps: two off at level 1
  const Contact contact = touch(0, sample.pose, 1 / stiffness, stiffness);
  const auto packet = encoder.encode(1, {&sample, 1}, {&contact, 1});
  ASSERT_TRUE(packet) << packet.error().rule;
  ASSERT_TRUE(decoder.decode(packet->bytes));
  const Pose shown = to_pose(predict(decoder.objects()[0], 1, header), header.grid);
  EXPECT_LE(haptic_ratio({.weber_fraction = 0.04}, contact_force(contact, sample.pose), contact_force(contact, shown)), 1);
}

TEST(Rigid, LostAndStalePacketsChangeNothing) {
  const StreamHeader header = scene_of(1);
  RigidEncoderOptions options;
  options.triggers.reduction = Reduction::none;
  auto encoder = RigidEncoder::create(header, options).value();
  auto decoder = RigidDecoder::create(header).value();
  Motion motion(6);
  std::vector<std::vector<std::uint8_t>> packets;
  for (std::int64_t tick = 0; tick < 4; ++tick) {
    const RigidSample sample = motion.step(kTick);
    const auto packet = encoder.encode(tick, {&sample, 1}, {}).value();
    packets.emplace_back(packet.bytes.begin(), packet.bytes.end());
  }
  ASSERT_TRUE(decoder.decode(packets[0]));
  const auto hash = decoder.state_hash();
  EXPECT_STREQ(decoder.decode(packets[2]).error().rule, "R-PKT-4") << "its baseline never arrived";
  EXPECT_STREQ(decoder.decode(packets[0]).error().rule, "R-PKT-5") << "a duplicate";
  EXPECT_EQ(decoder.state_hash(), hash);
  EXPECT_TRUE(decoder.decode(packets[1])) << "what was lost may still come";
}

/// A packet is lost, and the receiver asks for a key packet as soon as it notices.
TEST(Rigid, ARequestedKeyPacketMendsALoss) {
  constexpr std::size_t kObjects = 3;
  for (const std::uint8_t span : {std::uint8_t{1}, std::uint8_t{8}}) {
    StreamHeader header = scene_of(kObjects);
    header.baseline_span = span;
    auto encoder = RigidEncoder::create(header, {.triggers = {}, .key_interval = 0}).value();
    auto decoder = RigidDecoder::create(header).value();
    std::vector<Motion> motions{Motion(1), Motion(2), Motion(3)};
    std::vector<RigidSample> samples(kObjects);
    std::size_t lost = 0, refused = 0, keys = 0;
    for (std::int64_t tick = 0; tick < 2000; ++tick) {
      for (std::size_t i = 0; i < kObjects; ++i) samples[i] = motions[i].step(kTick);
      const auto packet = encoder.encode(tick, samples, {}).value();
      if (packet.bytes.empty()) continue;
      keys += packet.key ? 1U : 0U;
      if (tick >= 200 && lost < 5 && lost == refused && !packet.key) {
        ++lost;
        continue;
      }
      if (const auto decoded = decoder.decode(packet.bytes); !decoded) {
        ASSERT_STREQ(decoded.error().rule, "R-PKT-4") << tick;
        ++refused;
        encoder.request_key();
        continue;
      }
      ASSERT_EQ(decoder.state_hash(), encoder.state_hash()) << tick;
    }
    EXPECT_EQ(lost, 5U);
    EXPECT_EQ(refused, lost) << "the packet after each loss, and no other";
    EXPECT_EQ(keys, 1 + lost);
  }
}

TEST(Rigid, ARequestedKeyPacketComesWithoutATrigger) {
  const StreamHeader header = scene_of(2);
  auto encoder = RigidEncoder::create(header, {.triggers = {.heartbeat = 0}, .key_interval = 0}).value();
  auto late = RigidDecoder::create(header).value();
  std::vector<RigidSample> samples(2);
  encoder.request_key();
  EXPECT_TRUE(encoder.encode(0, samples, {})->bytes.empty()) << "nothing has left the initial state";
  samples[1].pose.position = {1, 0, 0};
  ASSERT_TRUE(encoder.encode(1, samples, {})->key);
  EXPECT_TRUE(encoder.encode(2, samples, {})->bytes.empty());
  encoder.request_key();
  const auto packet = encoder.encode(3, samples, {});
  ASSERT_TRUE(packet && packet->key);
  EXPECT_EQ(packet->updates, 1U);
  ASSERT_TRUE(late.decode(packet->bytes));
  EXPECT_EQ(late.state_hash(), encoder.state_hash());
  EXPECT_TRUE(encoder.encode(4, samples, {})->bytes.empty()) << "once for each request";
}

}  // namespace
}  // namespace tactus
