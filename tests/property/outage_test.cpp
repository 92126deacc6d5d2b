// SPDX-License-Identifier: Apache-2.0
/// Outages of every length around the places where 16-bit sequence numbers come round, senders that begin anew, and senders that are
/// others: what a receiver accepts is the state that the packet was made for. spec/25-packet.md sections 4 and 5.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <tactus/receiver.h>
#include <tactus/sender.h>

namespace tactus {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t kKeyEvery = 1000;  // packets, one per tick
constexpr std::size_t kRound = 65536;
constexpr std::size_t kLate = 128;

/// A packet of a scene that has one substream.
struct Sent {
  Bytes bytes;
  bool key = false;
  std::uint64_t hash = 0;  // of the state after it
};

SharedScene scene(std::uint8_t baseline_span = 1) {
  SceneSpec spec;
  spec.baseline_span = baseline_span;
  spec.objects.push_back({"cube", Dof::x, {}});
  return Scene::create(std::move(spec)).value();
}

Truth at(const RigidSample& sample) { return {.objects = {&sample, 1}}; }

/// pre  the sender makes one packet
Sent sent_by(Sender& sender, std::int64_t tick, const Truth& truth, std::size_t substream = 0) {
  const auto packets = sender.encode(tick, truth).value();
  EXPECT_EQ(packets.size(), 1u) << tick;
  const Packet& packet = packets.front();
  return {Bytes(packet.bytes.begin(), packet.bytes.end()), packet.key, sender.state_hash(substream)};
}

/// A packet per tick of an object on a path by `seed`.
std::vector<Sent> send(std::size_t count, double seed, std::uint16_t first_sequence = 1) {
  SenderOptions options;
  options.triggers.reduction = Reduction::none;
  options.triggers.haptic = HapticRule::off;
  options.policy.key_interval = kKeyEvery / 1000.0;
  options.policy.first_sequence = first_sequence;
  auto sender = Sender::create(scene(), options).value();
  std::vector<Sent> out;
  out.reserve(count);
  for (std::size_t tick = 0; tick < count; ++tick) {
    RigidSample sample;
    sample.pose.position.x =
        0.3 * std::sin(seed + 0.003 * static_cast<double>(tick)) + 0.01 * std::sin(seed * 0.7 * static_cast<double>(tick));
    out.push_back(sent_by(sender, static_cast<std::int64_t>(tick), at(sample)));
  }
  return out;
}

struct Outcome {
  int accepted = 0, wrong = 0;
  std::optional<std::size_t> first_key;  // keys refused before the first that was accepted
};

/// Packets [from, from + count) arrive, at ticks of a clock that stands at `now` with the first, if there is one.
Outcome hear(Receiver& receiver, const std::vector<Sent>& sent, std::size_t from, std::size_t count,
             std::optional<std::int64_t> now) {
  Outcome out;
  std::size_t refused_keys = 0;
  for (std::size_t i = from; i < std::min(from + count, sent.size()); ++i) {
    const std::uint64_t before = receiver.state_hash(0);
    const auto decoded = receiver.push(sent[i].bytes, now);
    if (now) ++*now;
    if (!decoded) {
      EXPECT_EQ(receiver.state_hash(0), before);
      refused_keys += sent[i].key ? 1u : 0u;
      continue;
    }
    ++out.accepted;
    out.wrong += receiver.state_hash(0) == sent[i].hash ? 0 : 1;
    if (sent[i].key && !out.first_key) out.first_key = refused_keys;
  }
  return out;
}

constexpr std::size_t kHeard = 1500;  // packets before the outage

/// What comes within `listened` packets after an outage.
Outcome after(const std::vector<Sent>& sent, std::size_t outage, std::size_t listened, bool clock) {
  auto receiver = Receiver::create(scene()).value();
  const auto tick = [&](std::size_t i) { return clock ? std::optional(static_cast<std::int64_t>(i)) : std::nullopt; };
  EXPECT_EQ(hear(receiver, sent, 0, kHeard, tick(0)).accepted, static_cast<int>(kHeard));
  return hear(receiver, sent, kHeard + outage, listened, tick(kHeard + outage));
}

/// Lengths around which something changes: each with its neighbours, and a few on the way.
std::vector<std::size_t> lengths() {
  std::vector<std::size_t> out{1, 2, 5, 127, 128, 500, 5000, 20000, 40000, 50000};
  for (const std::size_t edge : {kRound / 4, kRound / 2, kRound - kLate, kRound, 2 * kRound})
    for (std::size_t k = edge - 70; k < edge + 70; ++k) out.push_back(k);
  return out;
}

TEST(Outage, WithAClockNothingWrongIsAcceptedAndTheNextKeyPacketIs) {
  const auto sent = send(kHeard + 2 * kRound + 4000, 1);
  for (const std::size_t outage : lengths()) {
    const Outcome heard = after(sent, outage, 2 * kKeyEvery + kLate, true);
    EXPECT_EQ(heard.wrong, 0) << outage;
    EXPECT_GT(heard.accepted, static_cast<int>(kKeyEvery)) << outage;
    ASSERT_TRUE(heard.first_key) << outage;
    EXPECT_EQ(*heard.first_key, 0u) << outage;
  }
}

TEST(Outage, WithoutAClockOnlyLengthsThatGoRoundTheNumbersAreNotNoticed) {
  const auto sent = send(kHeard + 2 * kRound + 4000, 1);
  for (const std::size_t outage : lengths()) {
    const Outcome heard = after(sent, outage, 2 * kKeyEvery + kLate, false);
    const std::size_t rest = outage % kRound;
    EXPECT_EQ(heard.wrong > 0, rest == 0 || rest >= kRound - kLate) << outage;
    EXPECT_TRUE(heard.first_key) << outage;
  }
}

/// Old packets of one sender, then new ones of another with the same header.
Outcome then(const std::vector<Sent>& old, std::size_t heard, const std::vector<Sent>& other, std::size_t lost) {
  auto receiver = Receiver::create(scene()).value();
  EXPECT_EQ(hear(receiver, old, 0, heard, 0).accepted, static_cast<int>(heard));
  return hear(receiver, other, lost, other.size(), static_cast<std::int64_t>(heard));
}

/// The first packet of another sender that comes is `ahead` numbers after the newest, and no key packet.
bool goes_unnoticed(int ahead) { return ahead <= 1 && ahead > -static_cast<int>(kLate); }

TEST(Outage, ASenderThatBeginsAnewIsFollowedFromItsFirstKeyPacket) {
  const auto old = send(6000, 1);
  const auto anew = send(9000, 2);
  for (std::size_t heard = 1; heard < old.size(); heard += heard < 1500 ? 7 : 97) {
    for (const std::size_t lost : {std::size_t{0}, std::size_t{1}, std::size_t{700}}) {
      const int ahead = static_cast<int>(lost + 1) - static_cast<int>(heard);
      if (lost == 0 && ahead > -static_cast<int>(kLate) && ahead <= 0)
        continue;  // the key packet is late, and so are those after it
      const Outcome outcome = then(old, heard, anew, lost);
      EXPECT_EQ(outcome.wrong > 0, lost > 0 && goes_unnoticed(ahead)) << heard << ' ' << lost;
      if (goes_unnoticed(ahead)) continue;
      EXPECT_EQ(outcome.first_key, std::optional<std::size_t>(0)) << heard << ' ' << lost;
    }
  }
}

TEST(Outage, AnotherSenderIsFollowedFromItsFirstKeyPacketUnlessItsNumbersFitJustSo) {
  const auto old = send(2000, 1);
  for (int ahead = -300; ahead <= 300; ++ahead) {
    const std::size_t heard = 1700, lost = 100;
    const auto other = send(1200, 2, static_cast<std::uint16_t>(static_cast<int>(heard - lost) + ahead));
    const Outcome outcome = then(old, heard, other, lost);
    EXPECT_EQ(outcome.wrong > 0, goes_unnoticed(ahead)) << ahead;
    if (goes_unnoticed(ahead)) continue;
    EXPECT_EQ(outcome.first_key, std::optional<std::size_t>(0)) << ahead;
  }
}

/// A state that is still kept, but whose number has come round, is no baseline.
TEST(Outage, OldStatesAreNoBaselines) {
  const SharedScene wide = scene(64);
  SenderOptions options;
  options.triggers.reduction = Reduction::none;
  options.policy.key_interval = 0;
  const auto sender = [&](int first) {
    options.policy.first_sequence = static_cast<std::uint16_t>(first);
    return Sender::create(wide, options).value();
  };
  auto receiver = Receiver::create(wide).value();
  std::int64_t tick = 0;
  const auto next = [&](Sender& by) {
    RigidSample sample;
    sample.pose.position.x = 0.001 * static_cast<double>(++tick);
    return sent_by(by, tick, at(sample)).bytes;
  };
  for (const int first : {100, 100 + 32767, 100 + 65534}) {
    auto by = sender(first);
    ASSERT_TRUE(receiver.push(next(by)));
  }
  auto lost = sender(100);
  (void)next(lost);
  EXPECT_STREQ(receiver.push(next(lost)).error().rule, "R-PKT-4") << "sequence 101 builds on another 100";
}

TEST(Outage, MeshesTheSame) {
  constexpr std::size_t kSubstream = 1;
  SceneSpec spec;
  DeformableObject& object = spec.deformables.emplace_back();
  object.name = "point";
  object.rest = {{0, 0, 0}};
  const SharedScene point = Scene::create(std::move(spec)).value();
  SenderOptions options;
  options.deformable.thresholds.visual = 0;
  options.policy.key_interval = kKeyEvery / 1000.0;
  auto sender = Sender::create(point, options).value();
  std::vector<Sent> sent;
  for (std::size_t tick = 0; tick < kHeard + kRound + 2500; ++tick) {
    const double x = 1e-3 * static_cast<double>(1 + 3 * tick % 7) + 1e-5 * std::sin(0.01 * static_cast<double>(tick));
    const std::array<float, 3> u{static_cast<float>(x), 0, 0};
    const DeformableTruth truth{u, {}};
    sent.push_back(sent_by(sender, static_cast<std::int64_t>(tick), {.deformables = {&truth, 1}}, kSubstream));
  }
  for (const std::size_t outage : {std::size_t{10}, kRound / 2 - 1, kRound / 2, kRound - 200, kRound - 1, kRound, kRound + 1}) {
    auto receiver = Receiver::create(point).value();
    int accepted = 0;
    const auto listen = [&](std::size_t from, std::size_t to) {
      for (std::size_t i = from; i < to; ++i) {
        if (!receiver.push(sent[i].bytes, static_cast<std::int64_t>(i))) continue;
        ++accepted;
        EXPECT_EQ(receiver.state_hash(kSubstream), sent[i].hash) << outage << ' ' << i;
      }
    };
    listen(0, kHeard);
    listen(kHeard + outage, kHeard + outage + 2 * kKeyEvery);
    EXPECT_GT(accepted, static_cast<int>(kHeard + kKeyEvery)) << outage;
  }
}

/// A sender that says nothing for long sends a key packet, for receivers that have forgotten.
TEST(Outage, AfterALongSilenceASenderSendsAKeyPacket) {
  SenderOptions options;
  options.policy.key_interval = 0;
  options.triggers.heartbeat = 0;
  auto sender = Sender::create(scene(), options).value();
  auto receiver = Receiver::create(scene()).value();
  const auto is_key = [&](std::int64_t tick, double x) {
    RigidSample sample;
    sample.pose.position.x = x;
    const Sent packet = sent_by(sender, tick, at(sample));
    EXPECT_TRUE(receiver.push(packet.bytes, tick)) << tick;
    return packet.key;
  };
  EXPECT_TRUE(is_key(0, 0.1));
  EXPECT_FALSE(is_key(100, 0.2));
  EXPECT_FALSE(is_key(100 + 8192, 0.3));
  EXPECT_TRUE(is_key(100 + 2 * 8192 + 1, 0.4));
  EXPECT_TRUE(is_key(200'000, 0.5)) << "the receiver has forgotten";
}

}  // namespace
}  // namespace tactus
