// SPDX-License-Identifier: Apache-2.0
/// Packets that build on what the receiver has acknowledged: no loss stops a stream, and all that arrives keeps its bounds.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <deque>
#include <functional>
#include <optional>
#include <utility>

#include <tactus/rigid/rigid_predictor.h>
#include <tactus/tactus.h>
#include "tests/unit/deformable_fixture.h"

namespace tactus {
namespace {

using testing::SheetFrame;
using Bytes = std::vector<std::uint8_t>;

/// A channel that loses packets, delays those that arrive and their acknowledgements, and loses some of these. Order is kept one
/// way, not the other.
struct Channel {
  double loss = 0.3;
  std::uint32_t delay = 0;      // [ticks] of packets, at most
  std::uint32_t ack_delay = 0;  // [ticks] of acknowledgements, at most
  double ack_loss = 0.2;
};

struct Delivered {
  std::size_t sent = 0, keys = 0, lost = 0, decoded = 0, refused = 0;
};

/// Frames of a scene through the channel.
/// in   look(receiver, decoded, tick)  called after each packet that was decoded; `tick` is its own
Delivered deliver(const SharedScene& scene, const SenderOptions& options, const Channel& channel, std::int64_t ticks,
                  const std::function<Truth(std::int64_t)>& truth,
                  const std::function<void(Receiver&, const DecodedPacket&)>& look) {
  struct InFlight {
    std::int64_t arrives = 0;
    Bytes bytes;
    std::uint64_t number = 0;
    std::size_t substream = 0;
    std::uint64_t hash = 0;  // of the sender's state after it
  };
  struct Ack {
    std::int64_t arrives = 0;
    std::size_t substream = 0;
    std::uint64_t number = 0;
  };
  auto sender = Sender::create(scene, options).value();
  auto receiver = Receiver::create(scene).value();
  std::mt19937_64 random(11);
  const auto chance = [&](double fraction) { return static_cast<double>(random() >> 11) * 0x1p-53 < fraction; };
  std::deque<InFlight> packets;
  std::vector<Ack> acks;
  Delivered out;
  for (std::int64_t tick = 0; tick < ticks; ++tick) {
    for (const Packet& packet : testing::all(sender.encode(tick, truth(tick)))) {
      ++out.sent;
      out.keys += packet.key ? 1u : 0u;
      if (chance(channel.loss)) {
        ++out.lost;
        continue;
      }
      const std::int64_t earliest = packets.empty() ? tick : packets.back().arrives;
      packets.push_back({std::max(earliest, tick + static_cast<std::int64_t>(random() % (channel.delay + 1))),
                         Bytes(packet.bytes.begin(), packet.bytes.end()), packet.number, packet.substream,
                         sender.state_hash(packet.substream)});
    }
    while (!packets.empty() && packets.front().arrives <= tick) {
      const InFlight packet = std::move(packets.front());
      packets.pop_front();
      const auto decoded = receiver.push(packet.number, packet.bytes, tick);
      if (!decoded) {
        EXPECT_STREQ(decoded.error().rule, "R-PKT-4");
        ++out.refused;
        continue;
      }
      ++out.decoded;
      EXPECT_EQ(receiver.state_hash(packet.substream), packet.hash) << "as if nothing had been lost";
      look(receiver, *decoded);
      if (!chance(channel.ack_loss))
        acks.push_back(
            {tick + static_cast<std::int64_t>(random() % (channel.ack_delay + 1)), decoded->substream, decoded->number});
    }
    std::erase_if(acks, [&](const Ack& ack) {
      if (ack.arrives > tick) return false;
      sender.acknowledge(ack.substream, ack.number);
      return true;
    });
  }
  return out;
}

const RigidTriggers kBounds{.visual_position = 6e-3, .weber_fraction = 0.08};

SenderOptions acknowledged(const DeformableThresholds& thresholds = {}) {
  return {.triggers = kBounds,
          .deformable = {.thresholds = thresholds},
          .policy = {.key_interval = 0, .baseline = Baseline::acknowledged}};
}

/// The same channel stops a stream whose packets build on the one before.
SenderOptions previous() { return {.triggers = kBounds, .deformable = {}, .policy = {.key_interval = 0}}; }

const Channel kChannels[] = {{0, 0, 0, 0}, {0.3, 0, 0, 0}, {0.3, 2, 3, 0.2}, {0.5, 3, 6, 0.3}};

TEST(AcknowledgedBaselines, NoLossStopsRigidObjects) {
  constexpr std::size_t kObjects = 3;
  SceneSpec spec = testing::spec_of(kObjects);
  spec.baseline_span = 8;
  const SharedScene scene = testing::shared(std::move(spec));
  for (const Channel& channel : kChannels) {
    std::vector<testing::Motion> motions{testing::Motion(1), testing::Motion(2), testing::Motion(3)};
    std::vector<std::vector<RigidSample>> samples;  // by tick
    std::vector<Contact> contacts;
    const auto truth = [&](std::int64_t tick) {
      if (tick == 0) samples.clear();
      samples.emplace_back();
      for (testing::Motion& motion : motions) samples.back().push_back(motion.step(1e-3));
      contacts = {testing::touch(1, samples.back()[1].pose, 0.002)};
      return Truth{samples.back(), contacts};
    };
    const RigidPredictor predictor(*scene);
    std::size_t broken = 0, updates = 0;
    const auto look = [&](Receiver& receiver, const DecodedPacket& packet) {
      const auto& truly = samples[static_cast<std::size_t>(packet.tick)];
      updates += packet.updates.size();
      for (std::uint32_t i = 0; i < kObjects; ++i) {
        const bool named = std::ranges::any_of(packet.updates, [i](const RigidUpdate& update) { return update.object == i; });
        if (!named && channel.loss > 0) continue;  // a lost packet may have named it
        const RigidPose held = named ? predictor.pose(receiver.object(i), packet.tick) : receiver.replica().pose(i, packet.tick);
        const Pose shown = to_pose(held, scene->grid.position);
        const Pose& pose = truly[i].pose;
        const bool seen = norm(shown.position - pose.position) <= kBounds.visual_position &&
                          angle_between(shown.rotation, pose.rotation) <= kBounds.visual_rotation;
        const Contact contact = testing::touch(1, pose, 0.002);
        const bool keeps_force =
            i != 1 || haptic_ratio(kBounds, contact_force(contact, pose), contact_force(contact, shown)) <= 1;
        broken += seen && keeps_force ? 0u : 1u;
      }
    };
    const Delivered out = deliver(scene, acknowledged(), channel, 20000, truth, look);
    EXPECT_EQ(out.refused, 0u);
    EXPECT_EQ(broken, 0u);
    EXPECT_EQ(out.lost > 100, channel.loss > 0);
    EXPECT_GT(out.decoded, 200u);
    EXPECT_GT(updates, out.decoded);
    EXPECT_LT(out.keys, out.sent / 4) << "most build on what was acknowledged";
    if (channel.loss > 0) {
      EXPECT_GT(deliver(scene, previous(), channel, 4000, truth, [](auto&, auto&) {}).refused, 20u);
    }
  }
}

class AcknowledgedShapes : public ::testing::TestWithParam<std::tuple<DeformableProfile, std::size_t, bool>> {};

TEST_P(AcknowledgedShapes, NoLossStopsDeformableObjects) {
  const auto& [profile, modes, kept] = GetParam();
  constexpr std::uint32_t kWide = 12;
  const TriMesh mesh = testing::sheet(kWide, kWide);
  SceneSpec spec = testing::sheet_spec(mesh, profile, modes > 0 ? testing::wave_basis(mesh, kWide, modes) : ModeBasis{});
  spec.baseline_span = 8;
  spec.deformables[0].quant_bits = 12;
  spec.deformables[0].models_kept = kept;
  const SharedScene scene = testing::shared(std::move(spec), testing::kWithThesis);
  const DeformableThresholds thresholds{2.5e-4, 0.025};
  for (const Channel& channel : kChannels) {
    testing::DentedSheet sheet(mesh, kWide);
    std::vector<SheetFrame> frames;  // by tick
    DeformableTruth shape;
    const auto truth = [&](std::int64_t tick) {
      if (tick == 0) frames.clear();
      frames.push_back(sheet.frame(tick));
      shape = frames.back().truth();
      return Truth{.deformables = {&shape, 1}};
    };
    testing::BoundWatch watch(*scene, thresholds);
    const auto look = [&](Receiver& receiver, const DecodedPacket& packet) {
      watch.look(frames[static_cast<std::size_t>(packet.tick)], receiver.decoded_displacements(0));
    };
    const Delivered out = deliver(scene, acknowledged(thresholds), channel, 800, truth, look);
    EXPECT_EQ(out.refused, 0u);
    if (profile == DeformableProfile::main) {
      EXPECT_EQ(watch.broken(), 0u);
    } else {
      EXPECT_LT(watch.worst(), thresholds.visual + 3e-6) << "what is not sent, and the quantiser's step";
    }
    EXPECT_EQ(out.lost > 50, channel.loss > 0);
    EXPECT_GT(out.decoded, 100u);
    EXPECT_LT(out.keys, out.sent / 3);
    if (channel.loss > 0) {
      EXPECT_GT(deliver(scene, previous(), channel, 300, truth, [](auto&, auto&) {}).refused, 20u);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Profiles, AcknowledgedShapes,
                         ::testing::Values(std::tuple{DeformableProfile::main, 0, false},
                                           std::tuple{DeformableProfile::main, 6, false},
                                           std::tuple{DeformableProfile::thesis, 0, false},
                                           std::tuple{DeformableProfile::thesis, 0, true}));

/// One object that jumps by a centimetre now and then and otherwise rests; every tick in which a packet is sent, after the first.
class Jumping {
 public:
  explicit Jumping(const LinkState& link) {
    SceneSpec spec = testing::spec_of(1);
    spec.baseline_span = 8;
    SenderOptions options = acknowledged();
    options.triggers.heartbeat = 0;
    sender_.emplace(Sender::create(testing::shared(std::move(spec)), options).value());
    sender_->set_link(link);
  }
  void jump() { sample_.pose.position.x += 0.01; }
  /// Number of ticks until the next packet, at most `most`; nothing when there is none.
  std::optional<std::int64_t> until_next(std::int64_t most) {
    for (std::int64_t i = 1; i <= most; ++i) {
      const auto packets = testing::all(sender_->encode(tick_++, {{&sample_, 1}}));
      if (packets.empty()) continue;
      number_ = packets[0].number;
      return i;
    }
    return std::nullopt;
  }
  void acknowledge(std::uint64_t back = 0) { sender_->acknowledge(0, number_ - back); }
  Sender& sender() { return *sender_; }

 private:
  std::optional<Sender> sender_;
  RigidSample sample_;
  std::int64_t tick_ = 0;
  std::uint64_t number_ = 0;
};

TEST(AcknowledgedBaselines, WhatIsNotAcknowledgedIsSentAgain) {
  Jumping object({.ack_timeout = 55, .loss = 0.1});
  EXPECT_EQ(object.until_next(1000), std::nullopt) << "at its initial state";
  object.jump();
  EXPECT_EQ(object.until_next(1), 1);
  EXPECT_EQ(object.until_next(1000), 20);
  EXPECT_EQ(object.until_next(1000), 40);
  EXPECT_EQ(object.until_next(1000), 60);
  EXPECT_EQ(object.until_next(1000), 60);
  object.acknowledge(1);
  EXPECT_EQ(object.until_next(1000), 60) << "the newest is not known yet";
  object.acknowledge();
  EXPECT_EQ(object.until_next(5000), std::nullopt) << "what rests costs nothing";
  object.jump();
  EXPECT_EQ(object.until_next(1), 1);
  EXPECT_EQ(object.until_next(1000), 20) << "begins anew";
  object.sender().forget_last(0);
  EXPECT_EQ(object.until_next(1000), 1) << "the one before is due for longer";
}

/// Whether an object that is off by this fraction of its bound is named when another one is.   in   others  that move, too
bool joins(double fraction, Baseline baseline, bool waits, std::size_t others = 0) {
  SceneSpec spec = testing::spec_of(2 + others);
  spec.baseline_span = 8;
  SenderOptions options;
  options.policy.baseline = baseline;
  options.policy.key_interval = 0;
  options.triggers.heartbeat = 0;
  options.triggers.visual_position = 1e-3;
  Sender sender = Sender::create(testing::shared(std::move(spec)), options).value();
  std::vector<RigidSample> samples(2 + others);
  std::int64_t tick = 0;
  const auto encode = [&] { return testing::all(sender.encode(tick++, {samples})).size(); };
  encode();
  sender.set_link({.ack_timeout = 1000, .loss = 0, .waits = waits});
  samples[1].pose.position.x = 1e-3 * fraction;
  for (std::size_t i = 0; i < others; ++i) samples[2 + i].pose.position.x = 1e-3 * fraction;
  EXPECT_EQ(encode(), 0u) << "alone it causes none";
  samples[0].pose.position.x += 0.01;
  EXPECT_EQ(encode(), 1u);
  return sender.object(1).tick == tick - 1;
}

TEST(AcknowledgedBaselines, WhatIsNearItsBoundJoinsAPacketThatGoesAnyway) {
  for (const Baseline baseline : {Baseline::acknowledged, Baseline::repaired}) {
    EXPECT_TRUE(joins(0.6, baseline, false));
    EXPECT_FALSE(joins(0.4, baseline, false));
    EXPECT_TRUE(joins(0.2, baseline, true)) << "what waits takes along what moves";
    EXPECT_FALSE(joins(0.1, baseline, true));
    EXPECT_TRUE(joins(0.4, baseline, true, 11));
    EXPECT_FALSE(joins(0.2, baseline, true, 11)) << "many objects are bits, too";
    EXPECT_TRUE(joins(0.6, baseline, true, 23));
    EXPECT_FALSE(joins(0.4, baseline, true, 23));
  }
  EXPECT_FALSE(joins(0.9, Baseline::previous, false));
  EXPECT_FALSE(joins(0.9, Baseline::previous, true));
}

TEST(AcknowledgedBaselines, WithoutLossOnlyWhatShouldHaveBeenAnsweredIsSentAgain) {
  Jumping object({.ack_timeout = 55, .loss = 0.001});
  object.jump();
  EXPECT_EQ(object.until_next(1), 1);
  EXPECT_EQ(object.until_next(1000), 55);
  EXPECT_EQ(object.until_next(1000), 55);
  object.sender().set_link({});
  EXPECT_EQ(object.until_next(5000), std::nullopt) << "nothing is known of the delay back";
}

TEST(AcknowledgedBaselines, WhatIsCopiedIsSentAgainOnlyWhenTheAnswerIsDue) {
  Jumping object({.ack_timeout = 55, .loss = 0.1, .copies = true});
  object.jump();
  EXPECT_EQ(object.until_next(1), 1);
  EXPECT_EQ(object.until_next(1000), 55);
  EXPECT_EQ(object.until_next(1000), 55);
}

/// Two objects with the same motion, the second one a little slower: it never sends a packet of its own.
TEST(AcknowledgedBaselines, ObjectsNearTheirBoundsJoinAPacket) {
  SceneSpec spec = testing::spec_of(3);
  spec.baseline_span = 8;
  const SharedScene scene = testing::shared(std::move(spec));
  for (const auto& [options, least] : {std::pair{acknowledged(), 2u}, std::pair{previous(), 1u}}) {
    auto sender = Sender::create(scene, options).value();
    std::array<RigidSample, 3> samples;
    std::size_t packets = 0;
    for (std::int64_t tick = 0; tick < 2000; ++tick) {
      for (std::size_t i = 0; i < 3; ++i)
        samples[i].pose.position.x = 1e-4 * (i == 0 ? 1.0 : i == 1 ? 0.7 : 0.3) * static_cast<double>(tick);
      for (const Packet& packet : testing::all(sender.encode(tick, {samples}))) {
        ++packets;
        if (tick < 100) {
          EXPECT_EQ(packet.updates, least) << tick;
        }
        sender.acknowledge(0, packet.number);
      }
    }
    EXPECT_GT(packets, 10u);
  }
}

/// A receiver that asked for a key packet holds nothing from before, whatever is forgotten afterwards.
TEST(AcknowledgedBaselines, NothingBuildsOnWhatIsOlderThanARequest) {
  SceneSpec spec = testing::spec_of(1);
  spec.baseline_span = 8;
  SenderOptions options = acknowledged();
  options.triggers.reduction = Reduction::none;
  auto sender = Sender::create(testing::shared(std::move(spec)), options).value();
  testing::Motion motion(1);
  std::int64_t tick = 0;
  const auto key = [&] {
    const RigidSample sample = motion.step(1e-3);
    return testing::only(sender.encode(tick++, {{&sample, 1}})).key;
  };
  EXPECT_TRUE(key());
  sender.acknowledge(0, 1);
  EXPECT_FALSE(key());
  sender.request_key();
  sender.forget_last(0);
  EXPECT_TRUE(key()) << "requested";
  EXPECT_TRUE(key()) << "nothing newer is acknowledged";
  sender.acknowledge(0, 1);
  EXPECT_TRUE(key());
}

/// Without any acknowledgement there is only the initial state to build on; with one, that state until it is too old.
TEST(AcknowledgedBaselines, ReachAsFarBackAsTheScene) {
  SceneSpec spec = testing::spec_of(1);
  spec.baseline_span = 4;
  const SharedScene scene = testing::shared(std::move(spec));
  SenderOptions options = acknowledged();
  options.triggers.reduction = Reduction::none;
  auto sender = Sender::create(scene, options).value();
  testing::Motion motion(1);
  std::int64_t tick = 0;
  const auto key = [&] {
    const RigidSample sample = motion.step(1e-3);
    return testing::only(sender.encode(tick++, {{&sample, 1}})).key;
  };
  for (int i = 1; i <= 6; ++i) EXPECT_TRUE(key()) << i;
  sender.acknowledge(0, 5);
  for (int i = 7; i <= 9; ++i) EXPECT_FALSE(key()) << i;
  EXPECT_TRUE(key()) << "packet 10 is 5 after the one that is known";
  sender.acknowledge(0, 5);
  EXPECT_TRUE(key());
  sender.acknowledge(0, 11);
  EXPECT_FALSE(key());
  sender.acknowledge(0, 12);
  sender.forget_last(0);
  EXPECT_FALSE(key()) << "what was forgotten is no baseline, what was known before it still is";
  for (int i = 13; i <= 15; ++i) EXPECT_FALSE(key()) << i;
  EXPECT_TRUE(key()) << "packet 16 is 5 after 11: the forgotten 12 counts for nothing";
}

}  // namespace
}  // namespace tactus
