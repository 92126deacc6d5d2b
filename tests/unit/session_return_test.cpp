// SPDX-License-Identifier: Apache-2.0
/// Who comes back, and where: another address, a program that crashed, a server that began anew, seats. spec/70-session.md section 3
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <variant>

#include <tactus/scene/scene_builder.h>
#include <tactus/session/datagram.h>
#include "session_fixture.h"

namespace tactus {
namespace {

constexpr sim::Microseconds kDelay = 20'000;  // [us]

SharedScene scene() { return SceneBuilder(1000).rigid("pendulum").baselines(64).build().value(); }

/// A participant and an observer over 20 ms each way, in a scene that moves.
struct Visit {
  explicit Visit(double loss = 0, std::uint16_t clients = 3) : world(scene(), options(clients)) {
    add({.role = Role::participant, .seat = 2}, loss);
    add({.role = Role::observer}, loss);
  }
  static SessionServerOptions options(std::uint16_t clients) {
    SessionServerOptions out{.clients = clients, .world = 4711};
    out.sender.triggers.visual_position = 0.001;
    return out;
  }
  testing::SessionWorld::End& add(const SessionClientOptions& of, double loss = 0, std::uint64_t token = 0) {
    const std::uint64_t seed = 10 * world.ends.size();
    return world.add(of, {.seed = seed + 1, .delay = kDelay, .loss = loss}, {.seed = seed + 2, .delay = kDelay, .loss = loss}, 0,
                     token);
  }
  void run(int ms) {
    for (int i = 0; i < ms; ++i) {
      world.step([this](std::int64_t tick) {
        const double t = 1e-3 * static_cast<double>(tick);
        samples[0].pose.position = {0.05 * std::sin(6 * t), 0, 0};
        samples[0].velocity = {0.3 * std::cos(6 * t), 0, 0};
        return Truth{.objects = samples};
      });
      for (std::size_t client = 0; client < world.ends.size(); ++client) {
        const DeviceSample hand{.position = {0.01 * std::sin(1e-5 * static_cast<double>(world.now)), 0, 0}};
        ASSERT_TRUE(world.ends[client].client->submit(world.now, hand, {}));
      }
    }
  }
  SessionClient& client(std::size_t i = 0) { return *world.ends[i].client; }
  SessionState state(std::size_t i = 0) { return client(i).status().state; }
  std::size_t count(ServerEvent::Kind kind, std::uint16_t client) const {
    return static_cast<std::size_t>(std::ranges::count_if(
        world.events, [&](const ServerEvent& event) { return event.kind == kind && event.client == client; }));
  }

  std::array<RigidSample, 1> samples{};
  testing::SessionWorld world;
};

/// A network gives a client another address: what goes to the old one is lost.
TEST(SessionReturn, AnAddressThatChangesKeepsTheSession) {
  for (const double loss : {0.0, 0.1}) {
    Visit visit(loss);
    visit.run(2000);
    ASSERT_EQ(visit.state(), SessionState::live);
    visit.world.server->seat(0, 2);
    visit.run(500);
    EXPECT_EQ(visit.client().status().seat, 2u);
    const auto before = visit.client().status();
    const std::uint64_t heard = before.traffic.datagrams_heard;
    visit.world.ends[0].peer = 77;
    int silent = 0;
    while (visit.client().status().traffic.datagrams_heard <= heard + 5 && ++silent < 5000) visit.run(1);
    EXPECT_LE(silent, loss == 0 ? 600 : 1500) << "400 ms without an answer, and a round trip";
    visit.run(1000);
    EXPECT_EQ(visit.client().status().token, before.token);
    EXPECT_EQ(visit.client().status().seat, 2u);
    EXPECT_EQ(visit.client().unanswered(visit.world.now) / 400'000, 0u);
    EXPECT_EQ(visit.world.server->status(0).peer, 77u);
    EXPECT_GE(visit.count(ServerEvent::Kind::moved, 0), 1u);
    EXPECT_EQ(visit.count(ServerEvent::Kind::left, 0), 0u);
    EXPECT_EQ(visit.world.server->status(0).traffic.wrong_states, 0u);
    EXPECT_EQ(visit.state(1), SessionState::live);
  }
}

TEST(SessionReturn, AProgramThatCrashedComesBackToItsSlot) {
  Visit visit;
  visit.run(1000);
  const std::uint64_t token = visit.client().status().token;
  const std::uint16_t number = visit.client().status().client;
  visit.world.ends[0].silent = true;
  visit.run(300);
  visit.add({.role = Role::participant}, 0, token);
  visit.run(200);
  EXPECT_EQ(visit.state(2), SessionState::live) << "within a few round trips";
  EXPECT_EQ(visit.client(2).status().client, number);
  EXPECT_NE(visit.client(2).status().token, token);
  EXPECT_EQ(visit.count(ServerEvent::Kind::left, number), 1u);
  EXPECT_EQ(visit.count(ServerEvent::Kind::joined, number), 2u);
  EXPECT_EQ(visit.count(ServerEvent::Kind::moved, number), 0u);
}

/// Until its leaves are sent, both are at this address.
TEST(SessionReturn, ASessionThatComesToTheAddressOfOneThatIsGoneIsHeardAtOnce) {
  auto server = SessionServer::create(scene(), {.clients = 2}, 1, 0).value();
  DatagramWriter writer(Direction::up);
  const auto join = [&](std::uint64_t peer, std::uint64_t nonce, std::uint64_t token) {
    return server.handle_datagram(0, peer, writer.write(Join{Role::participant, nonce, 1 << 28, 1 << 20, token, 0}));
  };
  const auto state = [&](std::uint64_t peer, std::uint64_t epoch, std::uint64_t number) {
    writer.begin(number);
    EXPECT_TRUE(writer.add(StatePart{0}));
    return server.handle_datagram(0, peer, writer.finish(epoch));
  };
  std::array<std::uint64_t, 2> epochs{};
  for (std::size_t i = 0; i < 2; ++i) {
    ASSERT_TRUE(join(10 + i, 5 + i, 0));
    epochs[i] = std::get<Welcome>(read_datagram(server.poll_datagram(0)->bytes, Direction::down).value()).epoch;
    ASSERT_TRUE(state(10 + i, epochs[i], 1));
  }
  server.close(0, LeaveReason::bye);
  ASSERT_TRUE(join(10, 6, epochs[1]));
  EXPECT_TRUE(state(10, epochs[1], 2));
}

TEST(SessionReturn, ATokenThatTheServerDoesNotKnowIsNone) {
  Visit visit;
  visit.run(1000);
  visit.add({.role = Role::participant}, 0, 1234567);
  visit.run(300);
  EXPECT_EQ(visit.state(2), SessionState::live);
  EXPECT_EQ(visit.client(2).status().client, 2u);
  EXPECT_EQ(visit.state(0), SessionState::live);
  EXPECT_EQ(visit.state(1), SessionState::live);
  EXPECT_TRUE(std::ranges::none_of(visit.world.events, [](const auto& e) { return e.kind == ServerEvent::Kind::left; }));
}

/// Clients join the new one by themselves.
TEST(SessionReturn, AServerThatBeginsAnewGetsItsClientsBack) {
  Visit visit;
  visit.run(2000);
  const std::uint64_t token = visit.client().status().token;
  visit.world.server =
      std::make_unique<SessionServer>(SessionServer::create(scene(), Visit::options(3), 99, visit.world.now).value());
  visit.world.tick = 0;
  visit.run(2500);
  for (const std::size_t i : {0u, 1u}) {
    EXPECT_EQ(visit.state(i), SessionState::live) << i;
    EXPECT_EQ(visit.client(i).status().traffic.packets_refused, 0u);
    EXPECT_GT(visit.client(i).status().traffic.packets_heard, 5u);
    EXPECT_NEAR(static_cast<double>(visit.client(i).shown_tick(visit.world.now)), static_cast<double>(visit.world.tick), 100);
  }
  EXPECT_NE(visit.client().status().token, token);
  EXPECT_EQ(visit.client().status().seat, 0u);
  EXPECT_EQ(visit.client().status().world, 4711u);
}

/// A program that pauses goes on with the next number: clients show that time again, and no tick that is not known.
TEST(SessionReturn, AWorldThatPausesIsShownAsItGoesOn) {
  for (const int pause : {50, 400, 3000}) {
    Visit visit;
    visit.run(2000);
    for (int i = 0; i < pause; ++i) {
      visit.world.step();
      --visit.world.tick;
      ASSERT_TRUE(visit.client().submit(visit.world.now, {}, {}));
      ASSERT_LE(visit.client(1).shown_tick(visit.world.now), visit.world.tick + 123) << "while it pauses: the clock stands, too";
    }
    EXPECT_EQ(visit.client().force_fraction(visit.world.now), pause >= 400 ? 0 : 1) << pause;
    visit.run(2500);
    const std::int64_t behind = visit.world.tick - visit.client(1).shown_tick(visit.world.now);
    EXPECT_GT(behind, 20) << pause << " ms: nothing of the future is shown";
    EXPECT_LT(behind, 150) << pause;
    EXPECT_EQ(visit.client().force_fraction(visit.world.now), 1) << pause;
  }
}

TEST(SessionReturn, ASeatIsSentUntilItArrives) {
  Visit visit(0.3);
  visit.run(2000);
  ASSERT_EQ(visit.state(), SessionState::live);
  EXPECT_EQ(visit.world.server->status(0).wanted_seat, 2u);
  EXPECT_EQ(visit.client().status().seat, 0u);
  for (const std::uint8_t seat : {std::uint8_t{2}, std::uint8_t{1}, std::uint8_t{0}, std::uint8_t{255}}) {
    visit.world.server->seat(0, seat);
    visit.run(1500);
    EXPECT_EQ(visit.client().status().seat, seat);
    EXPECT_EQ(visit.client(1).status().seat, 0u);
  }
}

/// Whoever needs long to read a declaration gets its pieces again, and acknowledges what nobody waits for any more.
TEST(SessionReturn, WhoIsSlowToReadADeclarationGoesLive) {
  SceneBuilder builder(1000);
  for (int i = 0; i < 400; ++i) builder.rigid("object " + std::to_string(i));
  const SharedScene large = builder.baselines(64).build().value();
  for (const int stall : {0, 10, 30, 60, 100, 200, 300, 600}) {
    testing::SessionWorld world(large, {.clients = 1});
    world.add({.role = Role::participant}, {.seed = 1, .delay = 500}, {.seed = 2, .delay = 500});
    const std::vector<RigidSample> samples(400);
    std::uint64_t refused = 0;
    bool has_stalled = false;
    int busy = 0;
    for (int ms = 0; ms < 3000; ++ms) {
      const SessionStatus status = world.ends[0].client->status();
      if (!has_stalled && status.declaration > 0 && status.received >= status.declaration) has_stalled = true, busy = stall;
      world.ends[0].silent = busy-- > 0;
      world.step([&](std::int64_t) { return Truth{.objects = samples}; });
      if (world.ends[0].silent) continue;
      const DeviceSample hand{.position = {0.05 * std::sin(1e-5 * static_cast<double>(world.now)), 0, 0}};
      ASSERT_TRUE(world.ends[0].client->submit(world.now, hand, {}));
      refused = world.server->status(0).traffic.packets_refused;
    }
    EXPECT_EQ(world.server->status(0).state, SessionState::live) << stall;
    EXPECT_EQ(refused, 0u) << stall;
    EXPECT_TRUE(world.server->device(0, world.now)) << stall;
  }
}

}  // namespace
}  // namespace tactus
