// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/session_server.h>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include <tactus/scene/scene_builder.h>
#include <tactus/session/datagram.h>
#include "tests/property/allocated.h"
#include "tests/unit/deformable_fixture.h"
#include "tests/unit/session_fixture.h"

namespace tactus {
namespace {

using testing::SessionWorld;

constexpr std::uint32_t kSquares = 20;
constexpr std::size_t kObjects = 5;

/// Moving bodies, and a mesh whose declaration and packets need many datagrams.
struct Show {
  explicit Show(std::uint64_t seed = 1, bool with_mesh = true) {
    SceneBuilder builder(100);
    for (std::size_t i = 0; i < kObjects; ++i) {
      builder.rigid("body" + std::to_string(i));
      motions.emplace_back(seed + i);
    }
    if (with_mesh) builder.deformable("sheet", mesh);
    scene = builder.baselines(64).build().value();
    samples.resize(kObjects);
  }
  Truth at(std::int64_t tick) {
    for (std::size_t i = 0; i < kObjects; ++i) samples[i] = motions[i].step(1e-2);
    if (scene->deformables.empty()) return {.objects = samples, .contacts = {}, .deformables = {}};
    frame = sheet.frame(tick);
    shape = frame.truth();
    return {.objects = samples, .contacts = {}, .deformables = {&shape, 1}};
  }

  TriMesh mesh = testing::sheet(kSquares, kSquares);
  testing::DentedSheet sheet{mesh, kSquares, 3e-4};
  SharedScene scene;
  std::vector<testing::Motion> motions;
  std::vector<RigidSample> samples;
  testing::SheetFrame frame;
  DeformableTruth shape;
};

sim::LinkOptions lossy(std::uint64_t seed, double loss) {
  return {.seed = seed, .delay = 5'000, .jitter = 10'000, .loss = loss, .duplicates = 0.05};
}

/// After the last packet of each substream has arrived, both ends have the same states.
void expect_same_states(SessionWorld& world, std::size_t substreams) {
  for (auto& end : world.ends) {
    const std::uint16_t client = end.client->status().client;
    ASSERT_EQ(world.server->status(client).state, SessionState::live) << client;
    for (std::size_t s = 0; s < substreams; ++s)
      EXPECT_EQ(world.server->state_hash(client, s), end.client->receiver()->state_hash(s)) << "client " << client << ", " << s;
    EXPECT_EQ(world.server->status(client).traffic.wrong_states, 0u);
  }
}

TEST(SessionServer, ClientsBehindDifferentNetworksHaveTheSameStates) {
  Show show;
  SessionWorld world(show.scene, {.clients = 4});
  for (std::uint64_t i = 0; i < 4; ++i)
    world.add({}, lossy(10 * i + 1, 0.1 * static_cast<double>(i)), lossy(10 * i + 2, 0.1 * static_cast<double>(i)));
  for (int i = 0; i < 1500; ++i) world.step([&](std::int64_t tick) { return show.at(tick); });
  for (auto& end : world.ends) {  // the networks heal
    end.down = std::make_unique<sim::Link>(sim::Link::create({}).value());
    end.up = std::make_unique<sim::Link>(sim::Link::create({}).value());
  }
  for (int i = 0; i < 20; ++i) world.step([&](std::int64_t tick) { return show.at(tick); });
  expect_same_states(world, 2);
  EXPECT_GT(world.server->status(0).traffic.packets_sent, 500u);
  EXPECT_GT(world.server->status(world.ends[3].client->status().client).traffic.lost, 100u);
  EXPECT_EQ(world.ends[0].client->status().traffic.packets_refused, 0u);
}

TEST(SessionServer, AfterAnyOutageOnePacketRestoresTheState) {
  for (const std::uint64_t outage : {100'000u, 1'000'000u, 10'000'000u, 60'000'000u}) {
    Show show(3, false);
    SessionWorld world(show.scene, {});
    const sim::Microseconds begin = 7'000'000, end = begin + static_cast<sim::Microseconds>(outage);
    world.add({}, {.seed = 1, .delay = 10'000, .outages = {{begin, end}}},
              {.seed = 2, .delay = 10'000, .outages = {{begin, end}}});
    const auto run = [&](std::uint64_t until) {
      while (world.now < until) world.step([&](std::int64_t tick) { return show.at(tick); });
    };
    run(static_cast<std::uint64_t>(end));
    const std::uint64_t packets = world.server->status(0).traffic.packets_sent;
    while (world.server->state_hash(0, 0) != world.ends[0].client->receiver()->state_hash(0) &&
           world.now < static_cast<std::uint64_t>(end) + 1'000'000)
      world.step([&](std::int64_t tick) { return show.at(tick); });
    EXPECT_LE(world.now, static_cast<std::uint64_t>(end) + 20'000 + 60'000) << outage << ": a round trip and a packet";
    EXPECT_GT(packets, 10u);
    EXPECT_EQ(world.server->status(0).traffic.wrong_states, 0u);
  }
}

TEST(SessionServer, ANewSceneReplacesTheOldOne) {
  Show show(1, false), other(2, true);
  SessionWorld world(show.scene, {});
  world.add({}, lossy(1, 0.2), lossy(2, 0.2));
  for (int i = 0; i < 300; ++i) world.step([&](std::int64_t tick) { return show.at(tick); });
  SessionClient& client = *world.ends[0].client;
  ASSERT_EQ(client.status().state, SessionState::live);
  Receiver* before = client.receiver();
  EXPECT_EQ(before->scene()->deformables.size(), 0u);
  ASSERT_TRUE(world.server->replace_scene(other.scene, world.now));
  world.tick = 0;
  bool shown_always = true;
  for (int i = 0; i < 400; ++i) {
    world.step([&](std::int64_t tick) { return other.at(tick); });
    shown_always = shown_always && client.receiver() != nullptr;
  }
  EXPECT_TRUE(shown_always) << "the old scene stays until the new one is there";
  EXPECT_EQ(client.receiver()->scene()->deformables.size(), 1u);
  EXPECT_EQ(client.status().state, SessionState::live);
  EXPECT_GT(client.receiver()->tick(1), 100);
}

TEST(SessionServer, WithoutRoomOrBeyondLimitsItRefuses) {
  Show show;
  SessionWorld world(show.scene, {.clients = 1});
  world.add({}, {}, {});
  world.step();
  world.add({}, {}, {});
  SessionClientOptions small;
  small.limits.state_bytes = 100;
  world.add(small, {}, {});
  for (int i = 0; i < 50; ++i) world.step();
  EXPECT_EQ(world.ends[0].client->status().state, SessionState::live);
  ASSERT_EQ(world.ends[1].events.size(), 1u);
  EXPECT_EQ(world.ends[1].events[0].reason, LeaveReason::full);
  EXPECT_EQ(world.ends[2].events[0].reason, LeaveReason::limits);
}

TEST(SessionServer, AClientThatDiesIsForgotten) {
  Show show;
  SessionWorld world(show.scene, {.clients = 1, .silence = 2'000'000});
  world.add({}, {}, {});
  for (int i = 0; i < 100; ++i) world.step([&](std::int64_t tick) { return show.at(tick); });
  world.ends[0].silent = true;
  for (int i = 0; i < 250; ++i) world.step([&](std::int64_t tick) { return show.at(tick); });
  EXPECT_EQ(world.server->status(0).state, SessionState::closed);
  EXPECT_EQ(world.events.back().reason, LeaveReason::silence);
  EXPECT_LT(world.server->status(0).traffic.datagrams_sent, 300u) << "without acknowledgements little is sent";
  world.add({}, {}, {});
  for (int i = 0; i < 100; ++i) world.step();
  EXPECT_EQ(world.ends[1].client->status().state, SessionState::live) << "its place is free";
}

TEST(SessionServer, TheRateIsKept) {
  Show show(1, false);
  SessionWorld world(show.scene, {.rate = 6'000});
  world.add({}, {}, {});
  for (int i = 0; i < 3000; ++i) world.step([&](std::int64_t tick) { return show.at(tick); });
  const Traffic traffic = world.server->status(0).traffic;
  const double bits = 8.0 * static_cast<double>(traffic.bytes_sent + 28 * traffic.datagrams_sent);
  EXPECT_LT(bits / 30, 6'300);
  EXPECT_GT(bits / 30, 5'000) << "it is used";
  EXPECT_GT(traffic.ticks_held, 100u);
}

TEST(SessionServer, KnowsWhereADeviceIs) {
  Show show(1, false);
  SessionWorld world(show.scene, {});
  world.add({.role = Role::participant, .device = {.position = 1e-3}}, {.seed = 1, .delay = 20'000},
            {.seed = 2, .delay = 20'000});
  double worst = 0;
  std::uint64_t samples = 0;
  const auto place = [](std::uint64_t now) {
    const double t = 1e-6 * static_cast<double>(now);
    return Vec3{0.1 * std::sin(3 * t), 0.05 * std::cos(2 * t), 0};
  };
  for (int i = 0; i < 1000; ++i) {
    const DeviceSample sample{.position = place(world.now), .buttons = i / 100 % 2 == 0 ? 0u : 1u};
    ASSERT_TRUE(world.ends[0].client->submit(world.now, sample, {}));
    world.step([&](std::int64_t tick) { return show.at(tick); });
    const auto device = world.server->device(0, world.now);
    if (!device || i < 50) continue;
    ++samples;
    worst = std::max(worst, norm(device->position - place(world.now - 30'000)));
    if (i % 100 > 10) {
      EXPECT_EQ(device->buttons, i / 100 % 2 == 0 ? 0u : 1u) << i;
    }
  }
  EXPECT_GT(samples, 900u);
  EXPECT_LT(worst, 1e-3 + 0.01 * 0.33) << "its bound, and up to a tick of 10 ms";
  EXPECT_FALSE(world.server->device(1, world.now));
}

/// Strangers, old datagrams, damaged ones: nothing changes, nothing is allocated, and nothing longer is answered.
TEST(SessionServer, HostileDatagramsChangeNothing) {
  Show show(1, false);
  SessionWorld world(show.scene, {.clients = 2});
  world.add({.role = Role::participant}, {.seed = 1}, {.seed = 2});
  std::vector<std::vector<std::uint8_t>> heard;
  for (int i = 0; i < 200; ++i) {
    ASSERT_TRUE(world.ends[0].client->submit(world.now, {.position = {1e-3 * i, 0, 0}}, {}));
    world.drain();
    world.step([&](std::int64_t tick) { return show.at(tick); });
  }
  std::mt19937_64 random(5);
  DatagramWriter writer(Direction::up);
  const auto join = writer.write(Join{});
  const std::vector<std::uint8_t> joined(join.begin(), join.end());
  const Traffic before = world.server->status(0).traffic;
  std::vector<std::uint8_t> bytes;
  std::uint64_t answered = 0, taken = 0;
  bytes.reserve(1300);
  const std::uint64_t allocated = testing::allocated_bytes();
  for (int run = 0; run < 100'000; ++run) {
    bytes.assign(joined.begin(), joined.end());
    if (run % 3 == 0) {
      bytes.resize(random() % 1300);
      for (auto& b : bytes) b = static_cast<std::uint8_t>(random());
    } else {
      for (std::uint64_t flips = 1 + random() % 4; flips > 0; --flips)
        bytes[random() % bytes.size()] ^= static_cast<std::uint8_t>(1u << random() % 8);
    }
    if (bytes == joined) continue;
    const std::uint64_t peer = 1 + random() % 3;
    if (world.server->handle_datagram(world.now, peer, bytes)) ++taken;
    while (const auto datagram = world.server->poll_datagram(world.now)) answered += datagram->peer == peer ? 1u : 0u;
  }
  EXPECT_EQ(testing::allocated_bytes(), allocated);
  EXPECT_EQ(taken, 0u) << "no check of 32 bits held by chance in so few";
  EXPECT_EQ(answered, 0u);
  EXPECT_EQ(world.server->status(0).traffic.datagrams_heard, before.datagrams_heard);
  EXPECT_EQ(world.server->status(1).state, SessionState::closed);
}

TEST(SessionServer, SubmitAndDatagramsAllocateNothing) {
  Show show;
  SessionWorld world(show.scene, {.clients = 2});
  world.add({.role = Role::participant}, {}, {});
  world.add({}, {}, {});
  for (int i = 0; i < 100; ++i) world.step([&](std::int64_t tick) { return show.at(tick); });
  std::vector<std::vector<std::uint8_t>> down, up;
  std::uint64_t allocated = 0;
  const auto counting = [&](auto&& action) {
    const std::uint64_t before = testing::allocated_bytes();
    action();
    allocated += testing::allocated_bytes() - before;
  };
  for (int i = 0; i < 300; ++i) {
    const Truth truth = show.at(world.tick);
    counting([&] {
      ASSERT_TRUE(world.server->submit(world.now, world.tick, truth));
      while (const auto datagram = world.server->poll_datagram(world.now))
        static_cast<void>(world.ends[datagram->peer - 1].client->handle_datagram(world.now, datagram->bytes));
      static_cast<void>(world.ends[0].client->submit(world.now, {.position = {1e-3 * i, 0, 0}}, {}));
      for (std::size_t e = 0; e < 2; ++e)
        while (const auto datagram = world.ends[e].client->poll_datagram(world.now))
          static_cast<void>(world.server->handle_datagram(world.now, e + 1, *datagram));
    });
    world.now += 10'000;
    ++world.tick;
  }
  EXPECT_EQ(allocated, 0u);
  expect_same_states(world, 2);
}

}  // namespace
}  // namespace tactus
