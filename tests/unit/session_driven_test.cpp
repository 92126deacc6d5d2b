// SPDX-License-Identifier: Apache-2.0
// Driven objects in sessions: what both ends know of the device, and what the client shows.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <random>
#include <tuple>
#include <vector>

#include <tactus/session/timing.h>
#include <tactus/sim/link/session_network.h>
#include <tactus/sim/server.h>
#include <tactus/sim/simulation.h>
#include "tests/unit/driven_fixture.h"
#include "tests/unit/session_exchange_fixture.h"

namespace tactus {
namespace {

using testing::Bytes;
using testing::kEpoch;
using testing::kMillisecond;

/// Both ends of a device's packets, over a network that loses and delays.
struct DeviceEnds {
  explicit DeviceEnds(double loss_fraction) : loss(loss_fraction) {
    const SharedScene device = device_scene(*testing::driven_scene()).value();
    client.send_with(Sender::create(device, device_sender_options({})).value());
    server.receive_with(Receiver::create(device).value());
    for (Exchange* end : {&client, &server}) end->path = std::make_shared<DevicePath>(device);
  }

  /// A millisecond at both ends.
  void tick(std::int64_t tick) {
    now += kMillisecond;
    const double t = 1e-3 * static_cast<double>(tick);
    const DeviceSample sample{.position = {0.05 * std::sin(6 * t), 0.02 * std::sin(11 * t), 0}, .orientation = {}};
    EXPECT_TRUE(client.submit(now, tick, truth.of(tick, sample, {})));
    send(client, up, 20 * kMillisecond);
    hear(server, up, Direction::up);
    if (const auto change = mapping.step(tick, tick - 20)) {  // known to both at once
      server.path->shift(change->from, change->offset);
      client.path->shift(change->from, change->offset);
    }
    server.path->pass(tick);
    send(server, down, 20 * kMillisecond);
    hear(client, down, Direction::down);
  }

  void send(Exchange& from, std::multimap<std::uint64_t, Bytes>& to, std::uint64_t delay) {
    while (const auto datagram = from.poll(now, false, [](DatagramWriter&, std::uint64_t) { return false; })) {
      if (static_cast<double>(random() % 1000) < 1000 * loss) continue;
      to.emplace(now + delay + random() % (4 * kMillisecond), Bytes(datagram->begin(), datagram->end()));
    }
  }
  void hear(Exchange& to, std::multimap<std::uint64_t, Bytes>& from, Direction direction) {
    for (; !from.empty() && from.begin()->first <= now; from.erase(from.begin())) {
      const auto read = read_datagram(from.begin()->second, direction).value();
      const auto heard = to.handle(now, std::get<Numbered>(read), [](const Part&, const auto&) { return Result<void>(); });
      if (heard && heard->tick && direction == Direction::up) mapping.heard(*heard->tick);
    }
  }

  double loss;
  Exchange client{Direction::up, kEpoch, 0}, server{Direction::down, kEpoch, 0};
  DeviceTruth truth{1000, false};
  DeviceTickMapping mapping{1000};
  std::multimap<std::uint64_t, Bytes> up, down;
  std::mt19937_64 random{3};
  std::uint64_t now = kMillisecond;
};

/// Whatever is lost, late or reordered: a round trip later the client knows where the device was for the server, to the bit.
TEST(Driven, BothEndsKnowTheSamePath) {
  for (const double loss : {0.0, 0.05, 0.3}) {
    DeviceEnds ends(loss);
    for (std::int64_t tick = 0; tick < 4000; ++tick) {
      ends.tick(tick);
      if (tick % 500 != 499) continue;
      ends.loss = 0;  // so that what is not known yet gets known
      for (int i = 0; i < 150; ++i) ends.tick(++tick);
      std::size_t known = 0;
      for (std::int64_t past = tick - 600; past < tick - 100; ++past) {
        const auto at = ends.server.path->at(past);
        ASSERT_EQ(ends.client.path->at(past), at) << "tick " << past << ", loss " << loss;
        known += at ? 1u : 0u;
      }
      EXPECT_GT(known, tick > 1000 ? 400u : 0u);
      ends.loss = loss;
    }
    const std::uint64_t late = ends.server.traffic().packets_refused;
    EXPECT_GT(late, 0u) << "a jitter of 4 ms is more than the mapping begins with";
    EXPECT_LT(late, 20u) << "it has got slower";
  }
}

TEST(Driven, APositionIsLookedUpAgainOnceThePastHasChanged) {
  const SharedScene scene = testing::driven_scene();
  DevicePath path(device_scene(*scene).value());
  path.shift(0, 0);
  path.add(1, testing::device_state(*scene, 0, {}));
  path.add(2, testing::device_state(*scene, 10, {0.1, 0, 0}));
  path.pass(20);
  const auto before = path.at(15);
  EXPECT_EQ(path.at(15), before);
  path.settle(3, [](std::uint64_t) { return false; });
  EXPECT_NE(path.at(15), before) << "the second packet was lost";
}

struct Trial {
  std::size_t shown = 0, outside = 0, driven = 0;
  std::uint64_t packets = 0;
};

/// A shipped scene over a network.   in  model_scale  times the true mass: what is declared to clients; 0: nothing is driven
Trial trial(const char* name, double model_scale, const sim::LinkOptions& link, std::int64_t ticks) {
  const sim::Scene scene = sim::load_scene(*sim::find_scene(name)).value();
  sim::SessionNetwork* network = nullptr;
  sim::ChannelOptions channel;
  channel.sender.triggers.visual_position = 3e-4;
  channel.client_model_scale = model_scale;
  channel.network = [&](SharedScene declared, std::size_t users,
                        const SenderOptions& sender) -> Result<std::unique_ptr<sim::Network>> {
    EXPECT_EQ(declared->driven.has_value(), model_scale != 0);
    TACTUS_TRY(auto made, sim::SessionNetwork::create(std::move(declared), users, sender, {.uplink = link, .downlink = link}));
    network = made.get();
    return made;
  };
  auto simulation = sim::Simulation::create(scene, {.seed = 1, .grip = {}, .channel = channel});
  EXPECT_TRUE(simulation) << simulation.error().rule;
  std::vector<Vec3> truth;
  Trial out;
  for (std::int64_t tick = 0; tick < ticks; ++tick) {
    EXPECT_TRUE(simulation->step());
    truth.push_back(simulation->frame().objects[0].pose.position);
    const std::int64_t shown = simulation->shown_tick(0);
    if (shown < 0) continue;
    ++out.shown;
    const double error = norm(simulation->received_poses(0)[0].position - truth[static_cast<std::size_t>(shown)]);
    out.outside += error > 3e-4 ? 1u : 0u;
    out.driven += network->client(0).receiver()->object(0).predictor == Predictor::driven ? 1u : 0u;
  }
  out.packets = network->sent_to(0).packets_sent;
  return out;
}

TEST(Driven, TheClientShowsWhereItsDeviceHasMovedAnObject) {
  for (const char* scene : {"push-1dof", "rotate-6dof"}) {
    const Trial driven = trial(scene, 1, {.delay = 10'000}, 3000);
    EXPECT_GT(driven.shown, 1900u) << "from the first packet on";
    EXPECT_EQ(driven.outside, 0u) << scene;
    EXPECT_GT(driven.driven, 300u);
    const Trial coded = trial(scene, 0, {.delay = 10'000}, 3000);
    EXPECT_EQ(coded.driven, 0u);
    EXPECT_LT(driven.packets, coded.packets) << scene;
  }
}

TEST(Driven, AWrongMassKeepsTheBounds) {
  const Trial right = trial("push-1dof", 1, {.delay = 10'000}, 3000);
  const Trial wrong = trial("push-1dof", 1.2, {.delay = 10'000}, 3000);
  EXPECT_EQ(wrong.outside, 0u);
  EXPECT_GT(wrong.packets, right.packets);
}

/// What is lost leads both ends apart for a round trip, so that nothing is driven once the server sees that packets are lost.
TEST(Driven, WherePacketsAreLostNothingIsDriven) {
  const Trial lost = trial("rotate-6dof", 1, {.delay = 10'000, .jitter = 3'000, .loss = 0.05}, 5000);
  const Trial clean = trial("rotate-6dof", 1, {.delay = 10'000, .jitter = 3'000}, 5000);
  EXPECT_LT(lost.driven, clean.driven / 2);
  EXPECT_LT(lost.outside, lost.shown / 100);
  EXPECT_LT(clean.outside, clean.shown / 1000);
}

/// Who joins a server that has been running for a minute is at its tick from the first packet on.
TEST(Driven, ATickMappingBeginsAtTheTickOfTheServer) {
  auto server = SessionServer::create(testing::driven_scene(), {.clients = 1}, 7, kMillisecond).value();
  auto client = SessionClient::create({.role = Role::participant}).value();
  std::uint64_t now = kMillisecond;
  client.open(now, 3);
  const RigidSample cube;
  std::size_t known = 0;
  for (std::int64_t tick = 60'000; tick < 61'000; ++tick, now += kMillisecond) {
    EXPECT_TRUE(client.submit(now, {.position = {1e-4 * static_cast<double>(tick % 500), 0, 0.1}, .orientation = {}}, {}));
    while (const auto datagram = client.poll_datagram(now)) EXPECT_TRUE(server.handle_datagram(now, 1, *datagram));
    if (server.device(0, now)) ++known;  // a program asks before it has a tick for this client
    EXPECT_TRUE(server.submit(now, tick, {.objects = {&cube, 1}, .contacts = {}, .deformables = {}}));
    while (const auto datagram = server.poll_datagram(now)) EXPECT_TRUE(client.handle_datagram(now, datagram->bytes));
    client.handle_timeout(now);
    server.handle_timeout(now);
  }
  EXPECT_GT(known, 800u);
  EXPECT_LT(server.status(0).traffic.packets_refused, 3u);
}

struct Cost {
  double packets = 0, bytes = 0;  // per second, per packet
  std::size_t outside = 0;        // ticks
};

/// What the truth of a shipped scene costs for one receiver of every packet, whose device is known without delay or not at all.
Cost cost(const char* name, std::uint64_t seed, bool known) {
  const sim::Scene scene = sim::load_scene(*sim::find_scene(name)).value();
  SenderOptions options;
  options.triggers.visual_position = 3e-4;
  options.triggers.visual_rotation = 2 * 3.14159265358979 / 180;
  options.triggers.weber_fraction = 0.04;
  const auto declares = sim::Server::create(scene, {.codec = sim::ServerCodec{options, {}, true}}).value();
  const SharedScene declared = declares->stream_scene();
  const auto path = std::make_shared<DevicePath>(device_scene(*declared).value());
  path->shift(0, 0);
  auto sender = Sender::create(declared, options, nullptr, known ? path : nullptr).value();
  auto receiver = Receiver::create(declared, {}, known ? path : nullptr).value();
  auto simulation = sim::Simulation::create(scene, {.seed = seed, .grip = {}, .channel = {}}).value();
  FrameTruth truth(simulation.info());
  Cost out;
  const std::int64_t ticks = simulation.ticks();
  for (std::int64_t tick = 0; tick < ticks; ++tick) {
    EXPECT_TRUE(simulation.step());
    const TraceFrame& frame = simulation.frame();
    path->add(static_cast<std::uint64_t>(tick) + 1, testing::device_state(*declared, tick, frame.users[0].device.position));
    const auto packets = sender.encode(tick, truth.of(frame));
    EXPECT_TRUE(packets) << packets.error().rule;
    for (const Packet& packet : *packets) {
      EXPECT_TRUE(receiver.push(packet.number, packet.bytes));
      out.packets += 1;
      out.bytes += static_cast<double>(packet.bytes.size());
    }
    const Pose shown = to_pose(receiver.replica().pose(0, tick), declared->grid.position);
    const double error = norm(shown.position - frame.objects[0].pose.position);
    const Contact& contact = frame.users[0].contact;
    const bool keeps_force =
        contact.kind == ContactKind::none ||
        haptic_ratio(options.triggers, contact_force(contact, frame.objects[0].pose), contact_force(contact, shown)) <= 1;
    out.outside += error > 3e-4 || !keeps_force ? 1u : 0u;
  }
  out.bytes /= out.packets;
  out.packets *= 1000 / static_cast<double>(ticks);
  return out;
}

/// Figures of the chapter on driven objects: p = 4 %, 0.3 mm, 2 degrees, seeds 1 to 3.
TEST(Driven, ADeviceThatIsKnownSavesPackets) {
  for (const auto& [scene, most, fraction] :
       {std::tuple{"push-1dof", 2.0, 0.1}, {"rotate-6dof", 11.0, 0.7}, {"rotate-push-lift", 8.0, 0.6}}) {
    Cost with, without;
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
      const Cost one = cost(scene, seed, true), other = cost(scene, seed, false);
      EXPECT_EQ(one.outside, 0u) << scene << ", seed " << seed;
      EXPECT_EQ(other.outside, 0u) << scene << ", seed " << seed;
      with.packets += one.packets / 3, with.bytes += one.bytes / 3;
      without.packets += other.packets / 3, without.bytes += other.bytes / 3;
    }
    std::printf("[ measured ] %s: %.2f packets/s of %.1f bytes, %.2f of %.1f where the device is not known\n", scene,
                with.packets, with.bytes, without.packets, without.bytes);
    EXPECT_LT(with.packets, most);
    EXPECT_LT(with.packets, fraction * without.packets);
  }
}

}  // namespace
}  // namespace tactus
