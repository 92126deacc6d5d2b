// SPDX-License-Identifier: Apache-2.0
/// Outages of every length: what a receiver accepts afterwards is the state that the packet was made for, and the next key packet is
/// accepted. spec/25-packet.md sections 4 and 5.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <tactus/receiver.h>
#include <tactus/sender.h>

namespace tactus {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t kKeyEvery = 1000;  // packets, one per tick
constexpr std::size_t kHeard = 1500;     // packets before the outage
constexpr std::size_t kMost = 133'000;   // packets of an outage

/// A packet of a scene that has one substream.
struct Sent {
  Bytes bytes;
  std::uint64_t number = 0;
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
  return {Bytes(packet.bytes.begin(), packet.bytes.end()), packet.number, packet.key, sender.state_hash(substream)};
}

/// A packet per tick of an object that sways.
std::vector<Sent> send(const SharedScene& scene, std::size_t count) {
  SenderOptions options;
  options.triggers.reduction = Reduction::none;
  options.triggers.haptic = HapticRule::off;
  options.policy.key_interval = kKeyEvery / 1000.0;
  auto sender = Sender::create(scene, options).value();
  std::vector<Sent> out;
  out.reserve(count);
  for (std::size_t tick = 0; tick < count; ++tick) {
    RigidSample sample;
    sample.pose.position.x = 0.3 * std::sin(0.003 * static_cast<double>(tick)) + 0.01 * std::sin(0.7 * static_cast<double>(tick));
    out.push_back(sent_by(sender, static_cast<std::int64_t>(tick), at(sample)));
  }
  return out;
}

/// The packets before the outage and those of two key intervals after it: nothing but the next key packet and what follows is accepted.
void hear(const SharedScene& scene, const std::vector<Sent>& sent, std::size_t outage, std::size_t substream = 0) {
  auto receiver = Receiver::create(scene).value();
  for (std::size_t i = 0; i < kHeard; ++i) ASSERT_TRUE(receiver.push(sent[i].number, sent[i].bytes)) << i;
  bool follows = outage == 0;
  std::size_t accepted = 0;
  for (std::size_t i = kHeard + outage; i < kHeard + outage + 2 * kKeyEvery; ++i) {
    follows = follows || sent[i].key;
    const std::uint64_t before = receiver.state_hash(substream);
    const auto decoded = receiver.push(sent[i].number, sent[i].bytes);
    ASSERT_EQ(decoded.has_value(), follows) << outage << ' ' << i;
    ASSERT_EQ(receiver.state_hash(substream), follows ? sent[i].hash : before) << outage << ' ' << i;
    if (!decoded) {
      ASSERT_STREQ(decoded.error().rule, "R-PKT-4");
    }
    accepted += follows ? 1 : 0;
  }
  EXPECT_GT(accepted, kKeyEvery) << outage;
}

/// Those around powers of 2 with all that differ by up to 70.
std::vector<std::size_t> lengths() {
  std::vector<std::size_t> out{0, 1, 2, 5, 127, 128, 500, 5000, 20000, 40000, 50000};
  for (const std::size_t edge : {1u << 12, 1u << 14, 1u << 15, 1u << 16, 1u << 17})
    for (std::size_t k = edge - 70; k < edge + 70; ++k) out.push_back(k);
  return out;
}

TEST(Outage, NothingWrongIsAcceptedAndTheNextKeyPacketIs) {
  for (const std::uint8_t span : {std::uint8_t{1}, std::uint8_t{64}}) {
    const SharedScene cube = scene(span);
    const auto sent = send(cube, kHeard + kMost + 2 * kKeyEvery);
    for (const std::size_t outage : lengths()) {
      hear(cube, sent, outage);
      if (HasFatalFailure()) return;
    }
  }
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
  for (std::size_t tick = 0; tick < kHeard + (1 << 16) + 3 * kKeyEvery; ++tick) {
    const double x = 1e-3 * static_cast<double>(1 + 3 * tick % 7) + 1e-5 * std::sin(0.01 * static_cast<double>(tick));
    const std::array<float, 3> u{static_cast<float>(x), 0, 0};
    const DeformableTruth truth{u, {}};
    sent.push_back(sent_by(sender, static_cast<std::int64_t>(tick), {.deformables = {&truth, 1}}, kSubstream));
  }
  for (const std::size_t outage : {0u, 1u, 10u, 4095u, 4096u, 32767u, 32768u, 65535u, 65536u, 65537u}) {
    hear(point, sent, outage, kSubstream);
    if (HasFatalFailure()) return;
  }
}

/// However long nothing was due, the next packet builds on the last one: no receiver forgets.
TEST(Outage, AfterALongSilenceASenderGoesOn) {
  SenderOptions options;
  options.policy.key_interval = 0;
  options.triggers.heartbeat = 0;
  auto sender = Sender::create(scene(), options).value();
  auto receiver = Receiver::create(scene()).value();
  const auto is_key = [&](std::int64_t tick, double x) {
    RigidSample sample;
    sample.pose.position.x = x;
    const Sent packet = sent_by(sender, tick, at(sample));
    EXPECT_TRUE(receiver.push(packet.number, packet.bytes)) << tick;
    EXPECT_EQ(receiver.state_hash(0), packet.hash);
    return packet.key;
  };
  EXPECT_TRUE(is_key(0, 0.1));
  EXPECT_FALSE(is_key(100, 0.2));
  EXPECT_FALSE(is_key(100'000, 0.3));
  EXPECT_FALSE(is_key(4'000'000'000, 0.4));
}

}  // namespace
}  // namespace tactus
