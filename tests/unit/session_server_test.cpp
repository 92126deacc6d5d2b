// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/session_server.h>

#include <gtest/gtest.h>

#include <algorithm>
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
    const std::uint64_t repair = outage < 1'000'000 ? 40'000 : 0;  // what is lost is asked for, and comes again
    EXPECT_LE(world.now, static_cast<std::uint64_t>(end) + 20'000 + 60'000 + repair) << outage << ": a round trip and a packet";
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
  for (const LeaveReason reason : {LeaveReason::full, LeaveReason::limits})
    EXPECT_TRUE(std::ranges::any_of(world.events, [reason](const ServerEvent& event) {
      return event.kind == ServerEvent::Kind::refused && event.reason == reason;
    }));
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
  EXPECT_EQ(world.ends[1].client->status().state, SessionState::live) << "its slot is free";
}

/// Against the truth of the links, whatever the client's clock says; 5 ms of jitter each way, uniform: 2.5 ms on average.
TEST(SessionServer, RoundTripAndClockAreMeasured) {
  for (const std::uint64_t clock : {std::uint64_t{0}, std::uint64_t{7'654'321'012}}) {
    for (const double loss : {0.0, 0.05}) {
      Show show(1, false);
      SessionWorld world(show.scene, {.sender = {.triggers = {.visual_position = 6e-3}}});
      const auto link = [loss](std::uint64_t seed) {
        return sim::LinkOptions{.seed = seed, .delay = 20'000, .jitter = 5'000, .loss = loss};
      };
      world.add({}, link(1), link(2), clock);
      double server = 0, client = 0, worst_offset = 0;
      constexpr int kTicks = 3000, kWarm = 300;
      for (int i = 0; i < kTicks; ++i) {
        world.step([&](std::int64_t tick) { return show.at(tick); });
        if (i < kWarm) continue;
        const SessionStatus status = world.ends[0].client->status();
        server += static_cast<double>(world.server->status(0).round_trip->smoothed);
        client += static_cast<double>(status.round_trip->smoothed);
        worst_offset =
            std::max(worst_offset, std::abs(static_cast<double>(*status.clock_offset + static_cast<std::int64_t>(clock))));
      }
      EXPECT_NEAR(server / (kTicks - kWarm), 45'000, 500) << loss;
      EXPECT_NEAR(client / (kTicks - kWarm), 45'000, 500) << loss;
      EXPECT_LT(worst_offset, 500) << loss;
    }
  }
}

/// With the headers of UDP and IPv4, and with those and the seal.
TEST(SessionServer, TheRateIsKept) {
  for (const std::uint32_t headers : {28u, 57u}) {
    Show show(1, false);
    SessionWorld world(show.scene, {.rate = 6'000, .headers = headers, .max_bound_scale = 1});
    world.add({}, {}, {});
    for (int i = 0; i < 3000; ++i) world.step([&](std::int64_t tick) { return show.at(tick); });
    const Traffic traffic = world.server->status(0).traffic;
    const double bits = 8.0 * static_cast<double>(traffic.bytes_sent + headers * traffic.datagrams_sent);
    EXPECT_LT(bits / 30, 6'300) << headers;
    EXPECT_GT(bits / 30, 5'000) << "it is used";
    EXPECT_GT(traffic.ticks_held, 100u);
  }
}

TEST(SessionServer, KnowsToWhomItHasSomethingToSay) {
  Show show;
  SessionWorld world(show.scene, {.clients = 1});
  world.add({}, {}, {});
  for (int i = 0; i < 50; ++i) world.step();
  world.add({}, {}, {});
  for (int i = 0; i < 50; ++i) world.step();
  EXPECT_TRUE(world.server->has_peer(1));
  EXPECT_FALSE(world.server->has_peer(2)) << "it was refused";
  EXPECT_FALSE(world.server->has_peer(0)) << "the name of nobody";
  world.server->close();
  EXPECT_TRUE(world.server->has_peer(1)) << "the leave has not been sent";
  world.step();
  EXPECT_FALSE(world.server->has_peer(1));
}

TEST(SessionServer, BoundsScaleWhileTheRateDoesNotCarryThem) {
  const auto run = [](const SessionServerOptions& options, const sim::LinkOptions& down) {
    Show show(1, true);
    SessionWorld world(show.scene, options);
    world.add({}, {.delay = 20'000}, down);
    for (int i = 0; i < 4000; ++i) world.step([&](std::int64_t tick) { return show.at(tick); });
    const ClientStatus status = world.server->status(0);
    std::vector<double> factors{1};
    for (const ServerEvent& event : world.events) {
      if (event.kind != ServerEvent::Kind::bounds_scaled) continue;
      EXPECT_NE(event.bound_scale, factors.back());
      factors.push_back(event.bound_scale);
    }
    EXPECT_EQ(factors.back(), status.bound_scale);
    EXPECT_EQ(std::ranges::max(factors), status.bound_scaling.largest);
    return status;
  };
  const ClientStatus free = run({}, {.delay = 20'000});
  EXPECT_EQ(free.bound_scaling.largest, 1);
  EXPECT_EQ(free.bound_scaling.time, 0u);
  const auto needed = 8 * (free.traffic.bytes_sent + 28 * free.traffic.datagrams_sent) / 40;
  const ClientStatus fixed = run({.rate = needed / 3, .max_bound_scale = 1}, {.delay = 20'000});
  const ClientStatus rated = run({.rate = needed / 3}, {.delay = 20'000});
  EXPECT_EQ(fixed.bound_scaling.largest, 1);
  EXPECT_GT(rated.bound_scaling.largest, 1.9);
  EXPECT_GT(rated.bound_scaling.time, 10'000'000u);
  EXPECT_LT(rated.traffic.ticks_held, fixed.traffic.ticks_held / 2);
  // A bottleneck in the link of which the server knows nothing: it finds its rate.
  const sim::LinkOptions narrow{.delay = 20'000, .rate = static_cast<double>(needed) / 3};
  for (const double most : {1.0, 8.0}) {
    const ClientStatus found = run({.max_bound_scale = most}, narrow);
    const auto sent = 8 * (found.traffic.bytes_sent + 28 * found.traffic.datagrams_sent) / 40;
    EXPECT_LT(found.round_trip->smoothed, 200'000) << "no queue stays";
    EXPECT_GT(sent, needed / 3 * 7 / 10) << "with the time until it is found";
    EXPECT_EQ(found.bound_scaling.largest > 1.9, most > 1);
  }
}

TEST(SessionServer, KnowsWhereADeviceIs) {
  Show show(1, false);
  SessionWorld world(show.scene, {});
  world.add({.role = Role::participant, .device = {.position = 1e-3}}, {.seed = 1, .delay = 20'000},
            {.seed = 2, .delay = 20'000});
  double worst = 0;
  std::uint64_t samples = 0;
  const auto position = [](std::uint64_t now) {
    const double t = 1e-6 * static_cast<double>(now);
    return Vec3{0.1 * std::sin(3 * t), 0.05 * std::cos(2 * t), 0};
  };
  for (int i = 0; i < 1000; ++i) {
    const DeviceSample sample{.position = position(world.now), .buttons = i / 100 % 2 == 0 ? 0u : 1u};
    ASSERT_TRUE(world.ends[0].client->submit(world.now, sample, {}));
    world.step([&](std::int64_t tick) { return show.at(tick); });
    const auto device = world.server->device(0, world.now);
    if (!device || i < 50) continue;
    ++samples;
    worst = std::max(worst, norm(device->position - position(world.now - 30'000)));
    if (i % 100 > 10) {
      EXPECT_EQ(device->buttons, i / 100 % 2 == 0 ? 0u : 1u) << i;
    }
  }
  EXPECT_GT(samples, 900u);
  EXPECT_LT(worst, 1e-3 + 0.01 * 0.33) << "its bound, and up to a tick of 10 ms";
  EXPECT_FALSE(world.server->device(1, world.now));
}

/// Strangers, old datagrams, damaged ones: nothing changes, nothing is allocated, and nothing longer is answered.
/// A stranger's datagram: noise, a join that is damaged or whole, or what a client once sent, damaged or whole, from another address.
class Stranger {
 public:
  explicit Stranger(std::uint64_t seed) : random_(seed) { bytes_.reserve(1300); }

  /// in   whole  it may be without damage
  std::span<const std::uint8_t> next(const std::vector<std::vector<std::uint8_t>>& overheard, bool whole) {
    const std::uint64_t kind = random_() % 8;
    if (kind < 2) {
      bytes_.resize(random_() % 1300);
      for (auto& b : bytes_) b = static_cast<std::uint8_t>(random_());
    } else if (kind < 5 || overheard.empty()) {
      const auto join = writer_.write(Join{.role = Role::participant, .nonce = random_()});
      bytes_.assign(join.begin(), join.end());
    } else {
      const auto& heard = overheard[random_() % overheard.size()];
      bytes_.assign(heard.begin(), heard.end());
    }
    const bool damaged = !bytes_.empty() && (kind % 2 == 0 || !whole);
    const std::size_t count = damaged ? 1 + random_() % std::min<std::size_t>(4, bytes_.size()) : 0, first = random_() % 1300;
    for (std::size_t i = 0; i < count; ++i) bytes_[(first + i) % bytes_.size()] ^= static_cast<std::uint8_t>(1 + random_() % 255);
    return bytes_;
  }

 private:
  std::mt19937_64 random_;
  DatagramWriter writer_{Direction::up};
  std::vector<std::uint8_t> bytes_;
};

/// 10^6 in all: while a client joins, while it gets the declaration, and while it is live. It has the only slot.
TEST(SessionServer, HostileDatagramsChangeNothing) {
  constexpr std::uint64_t kRuns = 333'334, kStrangers = 1000;
  Show show;
  SessionWorld world(show.scene, {.clients = 1});
  world.add({.role = Role::participant}, {.seed = 1, .delay = 5'000}, {.seed = 2, .delay = 5'000});
  std::vector<std::vector<std::uint8_t>> overheard;
  Stranger stranger(5);
  std::uint64_t allocated = 0, largest = 0, attacks = 0;
  for (const auto during : {SessionState::closed, SessionState::receiving, SessionState::live}) {
    while (world.server->status(0).state != during) {
      world.now += 1000;
      world.deliver();
      while (const auto datagram = world.ends[0].client->poll_datagram(world.now)) {
        overheard.emplace_back(datagram->begin(), datagram->end());
        world.ends[0].up->send(static_cast<sim::Microseconds>(world.now), *datagram);
      }
      world.drain();
    }
    const bool has_slot = during != SessionState::closed;  // else the first whole join would take it
    const Traffic before = world.server->status(0).traffic;
    allocated = testing::allocated_bytes();
    for (std::uint64_t run = 0; run < kRuns; ++run, ++attacks) {
      const auto bytes = stranger.next(overheard, has_slot);
      const std::uint64_t peer = 100 + attacks % kStrangers;
      const bool taken = world.server->handle_datagram(world.now, peer, bytes).has_value();
      EXPECT_TRUE(!taken || has_slot);
      while (const auto datagram = world.server->poll_datagram(world.now)) {
        if (datagram->peer != peer) continue;
        largest = std::max<std::uint64_t>(largest, datagram->bytes.size());
        EXPECT_TRUE(taken);
        EXPECT_LE(datagram->bytes.size(), bytes.size()) << "a refusal is no larger than the join";
      }
    }
    EXPECT_EQ(testing::allocated_bytes(), allocated);
    EXPECT_EQ(world.server->status(0).state, during);
    EXPECT_EQ(world.server->status(0).traffic.datagrams_heard, before.datagrams_heard);
    EXPECT_EQ(world.server->status(0).traffic.packets_refused, before.packets_refused);
  }
  EXPECT_GE(attacks, 1'000'000u);
  EXPECT_GT(largest, 0u) << "those who ask get a refusal: there is no room";
  for (int i = 0; i < 300; ++i) world.step([&](std::int64_t tick) { return show.at(tick); });
  EXPECT_EQ(world.ends[0].client->status().state, SessionState::live);
  EXPECT_EQ(world.server->status(0).traffic.wrong_states, 0u);
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

/// While the rate holds the bodies back nothing else is sent either: what the client has would count as new.
TEST(SessionServer, NoForceFromStatesThatTheRateHeldBack) {
  Show show;
  SessionWorld world(show.scene, {.sender = {.triggers = {.visual_position = 1e-4}}, .rate = 20'000, .max_bound_scale = 1});
  SessionClient& client = *world.add({.role = Role::participant}, {.delay = 5'000}, {.delay = 5'000}).client;
  int old_states = 0, rendered = 0;
  for (int i = 0; i < 1500; ++i) {
    const Vec3 position{1e-3 * i, 0, 0};
    ASSERT_TRUE(client.submit(world.now, {.position = position}, DeviceContact{position + Vec3{0, 0, 1e-3}, 500}));
    world.step([&](std::int64_t tick) { return show.at(tick); });
    if (client.status().state != SessionState::live || i < 300) continue;
    const std::int64_t age = world.tick - client.receiver()->tick(0);  // [10 ms]
    old_states += age > 20 ? 1 : 0;
    if (client.force_fraction(world.now) == 0) continue;
    ++rendered;
    EXPECT_LE(age, 12) << i;
  }
  EXPECT_GT(old_states, 100) << "the rate is too high for this test";
  EXPECT_GT(rendered, 100);
}

/// Ten objects at 60 Hz with 20 ms of delay; after 5 s one becomes NaN, then falls out of the world, and comes back: who watches the other nine
/// sees them within their bounds in every frame, also who joins meanwhile.
TEST(SessionServer, OneBadObjectDoesNotStopTheOthers) {
  constexpr std::uint32_t kBodies = 10, kBad = 3;
  SceneBuilder builder(60);
  for (std::uint32_t i = 0; i < kBodies; ++i) builder.rigid("o" + std::to_string(i));
  const SharedScene scene = builder.baselines(64).build().value();
  SessionServerOptions options;
  options.sender.triggers.visual_position = 0.005;
  options.sender.triggers.visual_rotation = 0.03;
  SessionWorld world(scene, options);
  world.add({}, {.seed = 1, .delay = 20'000}, {.seed = 2, .delay = 20'000});
  std::vector<RigidSample> samples(kBodies);
  const auto position = [](std::uint32_t i, std::int64_t tick) {
    const double a = (1 + 0.001 * i) * static_cast<double>(tick) / 60;
    return Vec3{std::sin(a), std::cos(a) + 0.01 * i, 0.1 * i};
  };
  const auto is_bad = [](std::int64_t tick) { return tick >= 300 && tick < 900; };
  std::size_t frames = 0, over = 0, bad_over = 0, named = 0;
  for (std::int64_t tick = 0; tick < 1200; ++tick) {
    if (tick == 600) world.add({}, {.seed = 3, .delay = 20'000}, {.seed = 4, .delay = 20'000});
    world.step([&](std::int64_t now) {
      for (std::uint32_t i = 0; i < kBodies; ++i) {
        const double w = 1 + 0.001 * i, a = w * static_cast<double>(now) / 60;
        samples[i].pose.position = position(i, now);
        samples[i].velocity = {w * std::cos(a), -w * std::sin(a), 0};
      }
      if (is_bad(now)) samples[kBad].pose.position.z = now < 600 ? std::nan("") : -600;
      return Truth{.objects = samples};
    });
    const auto held = world.server->held();
    if (is_bad(tick) && held.size() == 1 && held[0].index == kBad && held[0].since == 300 && name_of(*scene, held[0]) == "o3")
      ++named;
    EXPECT_EQ(held.size(), is_bad(tick) ? 1u : 0u) << tick;
    for (auto& end : world.ends) {
      const std::int64_t shown = end.client->shown_tick(world.now);
      if (shown < 0 || end.client->receiver() == nullptr) continue;
      for (std::uint32_t i = 0; i < kBodies; ++i) {
        const Vec3 at = to_pose(end.client->receiver()->replica().pose(i, shown), scene->grid.position).position;
        const Vec3 wanted = i == kBad && is_bad(shown) ? position(i, 299) : position(i, shown);
        ++frames;
        if (norm(at - wanted) > 0.005) ++(i == kBad ? bad_over : over);
      }
    }
  }
  EXPECT_EQ(named, 600u);
  EXPECT_GT(frames, 15'000u);
  EXPECT_EQ(over, 0u);
  EXPECT_EQ(bad_over, 0u);
}

}  // namespace
}  // namespace tactus
