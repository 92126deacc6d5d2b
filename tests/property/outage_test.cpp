// SPDX-License-Identifier: Apache-2.0
/// Outages of every length around the places where 16-bit sequence numbers come round, senders that begin anew, and senders that are
/// others: what a receiver accepts is the state that the packet was made for. spec/40-rigid.md section 2.1.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <tactus/deformable/decoder.h>
#include <tactus/deformable/encoder.h>
#include <tactus/rigid/rigid_decoder.h>
#include <tactus/rigid/rigid_encoder.h>

namespace tactus {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t kKeyEvery = 1000;  // packets, one per tick
constexpr std::size_t kRound = 65536;
constexpr std::size_t kLate = 128;

struct Packet {
  Bytes bytes;
  bool key = false;
  std::uint64_t hash = 0;  // of the state after it
};

StreamHeader scene() {
  StreamHeader header;
  header.objects.resize(1);
  header.objects[0].name = "cube";
  header.objects[0].dof = Dof::x;
  return header;
}

/// A packet per tick of an object on a path that `seed` tells.
std::vector<Packet> send(std::size_t count, double seed, std::uint16_t first_sequence = 1) {
  RigidEncoderOptions options;
  options.triggers.reduction = Reduction::none;
  options.triggers.haptic = HapticRule::off;
  options.key_interval = kKeyEvery / 1000.0;
  options.first_sequence = first_sequence;
  auto encoder = RigidEncoder::create(scene(), options).value();
  std::vector<Packet> out;
  out.reserve(count);
  for (std::size_t tick = 0; tick < count; ++tick) {
    RigidSample sample;
    sample.pose.position.x =
        0.3 * std::sin(seed + 0.003 * static_cast<double>(tick)) + 0.01 * std::sin(seed * 0.7 * static_cast<double>(tick));
    const auto packet = encoder.encode(static_cast<std::int64_t>(tick), std::span(&sample, 1), {}).value();
    out.push_back({Bytes(packet.bytes.begin(), packet.bytes.end()), packet.key, encoder.state_hash()});
  }
  return out;
}

struct Outcome {
  int accepted = 0, wrong = 0;
  std::optional<std::size_t> first_key;  // keys refused before the first that was accepted
};

/// Packets [from, from + count) arrive, at ticks of a clock that stands at `now` with the first, if there is one.
Outcome hear(RigidDecoder& decoder, const std::vector<Packet>& sent, std::size_t from, std::size_t count,
             std::optional<std::int64_t> now) {
  Outcome out;
  std::size_t refused_keys = 0;
  for (std::size_t i = from; i < std::min(from + count, sent.size()); ++i) {
    const std::uint64_t before = decoder.state_hash();
    const auto decoded = decoder.decode(sent[i].bytes, now);
    if (now) ++*now;
    if (!decoded) {
      EXPECT_EQ(decoder.state_hash(), before);
      refused_keys += sent[i].key ? 1u : 0u;
      continue;
    }
    ++out.accepted;
    out.wrong += decoder.state_hash() == sent[i].hash ? 0 : 1;
    if (sent[i].key && !out.first_key) out.first_key = refused_keys;
  }
  return out;
}

constexpr std::size_t kHeard = 1500;  // packets before the outage

/// What comes within `listened` packets after an outage.
Outcome after(const std::vector<Packet>& sent, std::size_t outage, std::size_t listened, bool clock) {
  auto decoder = RigidDecoder::create(scene()).value();
  const auto tick = [&](std::size_t i) { return clock ? std::optional(static_cast<std::int64_t>(i)) : std::nullopt; };
  EXPECT_EQ(hear(decoder, sent, 0, kHeard, tick(0)).accepted, static_cast<int>(kHeard));
  return hear(decoder, sent, kHeard + outage, listened, tick(kHeard + outage));
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
Outcome then(const std::vector<Packet>& old, std::size_t heard, const std::vector<Packet>& other, std::size_t lost) {
  auto decoder = RigidDecoder::create(scene()).value();
  EXPECT_EQ(hear(decoder, old, 0, heard, 0).accepted, static_cast<int>(heard));
  return hear(decoder, other, lost, other.size(), static_cast<std::int64_t>(heard));
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
  StreamHeader header = scene();
  header.baseline_span = 64;
  RigidEncoderOptions options;
  options.triggers.reduction = Reduction::none;
  options.key_interval = 0;
  const auto sender = [&](int first) {
    options.first_sequence = static_cast<std::uint16_t>(first);
    return RigidEncoder::create(header, options).value();
  };
  auto decoder = RigidDecoder::create(header).value();
  std::int64_t tick = 0;
  const auto next = [&](RigidEncoder& encoder) {
    RigidSample sample;
    sample.pose.position.x = 0.001 * static_cast<double>(++tick);
    const auto packet = encoder.encode(tick, std::span(&sample, 1), {}).value();
    return Bytes(packet.bytes.begin(), packet.bytes.end());
  };
  for (const int first : {100, 100 + 32767, 100 + 65534}) {
    auto encoder = sender(first);
    ASSERT_TRUE(decoder.decode(next(encoder)));
  }
  auto lost = sender(100);
  (void)next(lost);
  EXPECT_STREQ(decoder.decode(next(lost)).error().rule, "R-PKT-4") << "sequence 101 builds on another 100";
}

TEST(Outage, MeshesTheSame) {
  StreamHeader header;
  DeformableObject& mesh = header.meshes.emplace_back();
  mesh.name = "point";
  mesh.rest = {{0, 0, 0}};
  auto encoder = DeformableEncoder::create(header, 0, {.thresholds = {.visual = 0}, .key_interval = kKeyEvery / 1000.0}).value();
  std::vector<Packet> sent;
  for (std::size_t tick = 0; tick < kHeard + kRound + 2500; ++tick) {
    const Vec3 u{1e-3 * static_cast<double>(1 + 3 * tick % 7) + 1e-5 * std::sin(0.01 * static_cast<double>(tick)), 0, 0};
    const auto packet = encoder.encode(static_cast<std::int64_t>(tick), std::span(&u, 1)).value();
    ASSERT_FALSE(packet.bytes.empty()) << tick;
    sent.push_back({Bytes(packet.bytes.begin(), packet.bytes.end()), packet.key, encoder.state_hash()});
  }
  for (const std::size_t outage : {std::size_t{10}, kRound / 2 - 1, kRound / 2, kRound - 200, kRound - 1, kRound, kRound + 1}) {
    auto decoder = DeformableDecoder::create(header, 0).value();
    int accepted = 0;
    const auto listen = [&](std::size_t from, std::size_t to) {
      for (std::size_t i = from; i < to; ++i) {
        if (!decoder.decode(sent[i].bytes, static_cast<std::int64_t>(i))) continue;
        ++accepted;
        EXPECT_EQ(decoder.state_hash(), sent[i].hash) << outage << ' ' << i;
      }
    };
    listen(0, kHeard);
    listen(kHeard + outage, kHeard + outage + 2 * kKeyEvery);
    EXPECT_GT(accepted, static_cast<int>(kHeard + kKeyEvery)) << outage;
  }
}

/// A sender that says nothing for long sends a key packet, for receivers that have forgotten.
TEST(Outage, AfterALongSilenceASenderSendsAKeyPacket) {
  RigidEncoderOptions options;
  options.key_interval = 0;
  options.triggers.heartbeat = 0;
  auto encoder = RigidEncoder::create(scene(), options).value();
  auto decoder = RigidDecoder::create(scene()).value();
  const auto at = [&](std::int64_t tick, double x) {
    RigidSample sample;
    sample.pose.position.x = x;
    const auto packet = encoder.encode(tick, std::span(&sample, 1), {}).value();
    EXPECT_TRUE(packet.bytes.empty() || decoder.decode(packet.bytes, tick)) << tick;
    return packet;
  };
  EXPECT_TRUE(at(0, 0.1).key);
  EXPECT_FALSE(at(100, 0.2).key);
  EXPECT_FALSE(at(100 + 8192, 0.3).key);
  EXPECT_TRUE(at(100 + 2 * 8192 + 1, 0.4).key);
  EXPECT_TRUE(at(200'000, 0.5).key) << "the decoder has forgotten";
}

}  // namespace
}  // namespace tactus
