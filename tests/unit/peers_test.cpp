// SPDX-License-Identifier: Apache-2.0
#include "cli/live/wire.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <tactus/base/bytes.h>
#include <tactus/scene/scene_builder.h>
#include <tactus/session/session_client.h>
#include <tactus/session/session_server.h>

namespace tactus::cli {
namespace {

net::Address at(unsigned port) { return net::Address::parse("127.0.0.1:" + std::to_string(port)).value(); }

struct Sessions {
  std::set<std::uint64_t> peers;
  Peers::HasSession known() {
    return [this](std::uint64_t peer) { return peers.contains(peer); };
  }
};

TEST(Peers, ThoseWithASessionAreFound) {
  Sessions sessions;
  Peers peers(2, 1);
  const std::uint64_t name = peers.name(at(1));
  ASSERT_NE(peers.find(name), nullptr) << "of the newest datagram";
  EXPECT_EQ(*peers.find(name), at(1));
  sessions.peers.insert(name);
  peers.settle(sessions.known());
  static_cast<void>(peers.name(at(2)));
  peers.settle(sessions.known());
  ASSERT_NE(peers.find(name), nullptr);
  EXPECT_EQ(*peers.find(name), at(1));
  static_cast<void>(peers.name(at(3)));
  EXPECT_EQ(peers.find(at(2).key()), nullptr) << "it has none, and another has spoken since";
}

/// Strangers whose joins are answered, but with a refusal.
TEST(Peers, StrangersPushNobodyOut) {
  Sessions sessions;
  Peers peers(2, 1);
  for (const unsigned port : {1u, 2u}) {
    sessions.peers.insert(peers.name(at(port)));
    peers.settle(sessions.known());
  }
  for (unsigned port = 10; port < 1000; ++port) {
    static_cast<void>(peers.name(at(port)));
    peers.settle(sessions.known());
  }
  EXPECT_EQ(peers.size(), 2u);
  for (const unsigned port : {1u, 2u}) {
    ASSERT_NE(peers.find(at(port).key()), nullptr) << port;
    EXPECT_EQ(*peers.find(at(port).key()), at(port));
  }
}

TEST(Peers, WhoLeftMakesRoom) {
  Sessions sessions;
  Peers peers(2, 1);
  for (unsigned port = 1; port < 100; ++port) {
    sessions.peers.insert(peers.name(at(port)));
    peers.settle(sessions.known());
    peers.settle(sessions.known());
    EXPECT_LE(peers.size(), 2u);
    EXPECT_NE(peers.find(at(port).key()), nullptr);
    if (port > 1) sessions.peers.erase(at(port - 1).key());
  }
}

// ==== floods ====

using Bytes = std::vector<std::uint8_t>;

/// A plain server with three clients on addresses of their own: two are honest, the third has joined and floods, as do strangers.
struct FloodedServer {
  struct Client {
    net::Address at;
    SessionClient session;
    std::uint64_t sent = 0, dropped = 0;
    Fnv1a heard;  // of everything that the server sent to it
    Bytes newest;
  };

  FloodedServer() {
    for (unsigned i = 0; i < 3; ++i) {
      auto session = SessionClient::create({.role = i == 1 ? Role::observer : Role::participant}).value();
      session.open(now, 7 + i);
      clients.push_back(
          {net::Address::parse("127.0.0." + std::to_string(i + 1) + ":4000").value(), std::move(session), 0, 0, {}, {}});
    }
  }
  bool to_server(const net::Address& from, std::span<const std::uint8_t> bytes) {
    if (!peers.permits(now, from, bytes.size())) return false;
    ++handled;
    static_cast<void>(server.handle_datagram(now, peers.name(from), bytes));
    peers.settle([this](std::uint64_t peer) { return server.has_peer(peer); });
    drain();
    return true;
  }
  void drain() {
    while (const auto message = server.poll_datagram(now))
      for (Client& client : clients)
        if (client.at.key() == message->peer) {
          for (const std::uint8_t byte : message->bytes) client.heard.add_byte(byte);
          static_cast<void>(client.session.handle_datagram(now, message->bytes));
        }
    while (server.poll_event()) continue;
  }
  /// A tick: the device of each client goes on, and its datagrams are heard.
  void step(std::int64_t tick) {
    now += 1000;
    std::array<RigidSample, 2> objects{};
    objects[0].pose.position = {0.1 * std::sin(0.002 * static_cast<double>(tick)), 0, 0};
    ASSERT_TRUE(server.submit(now, tick, {.objects = objects}));
    drain();
    for (Client& client : clients) {
      DeviceSample device;
      device.position = {0.05 * std::sin(0.02 * static_cast<double>(tick)), 0.03 * std::cos(0.031 * static_cast<double>(tick)),
                         0};
      static_cast<void>(client.session.submit(now, device, {}));
      client.session.handle_timeout(now);
      while (const auto message = client.session.poll_datagram(now)) {
        client.newest.assign(message->begin(), message->end());
        ++client.sent;
        client.dropped += to_server(client.at, client.newest) ? 0u : 1u;
      }
      while (client.session.poll_event()) continue;
    }
    server.handle_timeout(now);
    drain();
    for (std::uint16_t i = 0; i < 3; ++i) static_cast<void>(server.device(i, now));
  }

  std::uint64_t now = 1'000'000, handled = 0;
  SessionServer server =
      SessionServer::create(SceneBuilder(1000).rigid("a").rigid("b").baselines(64).build().value(), {.clients = 6}, 42, now)
          .value();
  Peers peers{6, 99};
  std::vector<Client> clients;
};

/// A hand that shakes so that each of its 1000 samples per second is worth a packet, over a network that loses; then all that was sent in a
/// second arrives at once.
TEST(Peers, TheFastestClientIsNeverLimited) {
  FloodedServer world;
  std::mt19937 random(5);
  SessionClient& session = world.clients[0].session;
  std::uint64_t most = 0, sent = 0;
  std::vector<Bytes> held;
  for (std::int64_t tick = 0; tick < 8000; ++tick) {
    std::array<RigidSample, 2> objects{};
    for (RigidSample& object : objects) object.pose.position = {1e-4 * static_cast<double>(random() % 1000), 0, 0};
    world.now += 1000;
    ASSERT_TRUE(world.server.submit(world.now, tick, {.objects = objects}));
    world.drain();
    DeviceSample device;
    device.position = {1e-4 * static_cast<double>(random() % 1000), 1e-4 * static_cast<double>(random() % 1000), 0};
    device.buttons = static_cast<std::uint32_t>(random() % 2);
    static_cast<void>(session.submit(world.now, device, {}));
    session.handle_timeout(world.now);
    const bool stands_still = tick >= 4000 && tick < 5000;
    while (const auto message = session.poll_datagram(world.now)) {
      ++sent;
      held.emplace_back(message->begin(), message->end());
    }
    if (!stands_still) {
      for (const Bytes& datagram : held) {
        const bool is_lost = tick > 1000 && held.size() < 100 && random() % 10 < 3;
        EXPECT_TRUE(is_lost || world.to_server(world.clients[0].at, datagram)) << tick;
      }
      held.clear();
    }
    if (tick % 1000 == 999) most = std::max(most, std::exchange(sent, 0));
  }
  EXPECT_EQ(session.status().state, SessionState::live);
  EXPECT_GT(most, 900u);
  EXPECT_LE(most, 2000u) << "what spec/70-session.md section 11.6 says of a client";
  EXPECT_EQ(world.peers.limited(), 0u);
}

TEST(Peers, FloodsChangeNoDatagramOfOthers) {
  FloodedServer quiet, flooded;
  std::mt19937 random(3);
  const auto flood =
      [&](std::uint64_t count) {  // of the third client, what it sent last, and damaged; of strangers, joins and noise
        for (std::uint64_t i = 0; i < count; ++i) {
          Bytes message = flooded.clients[2].newest;
          if (message.empty()) continue;
          for (std::uint_fast32_t k = random() % 3; k > 0; --k)
            message[random() % message.size()] ^= static_cast<std::uint8_t>(1u << random() % 8);
          flooded.to_server(flooded.clients[2].at, message);
          message.resize(random() % 200 + 1);
          flooded.to_server(at(static_cast<unsigned>(random() % 60'000 + 1)), message);
        }
      };
  constexpr std::int64_t kTicks = 6000, kQuiet = 1000;
  for (std::int64_t tick = 0; tick < kTicks; ++tick) {
    quiet.step(tick);
    flooded.step(tick);
    if (tick >= kQuiet) flood(50);  // 50 000 per second each
  }
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(flooded.clients[i].heard.value(), quiet.clients[i].heard.value()) << i;
    EXPECT_EQ(flooded.clients[i].sent, quiet.clients[i].sent) << i;
    EXPECT_EQ(flooded.clients[i].dropped, 0u) << i;
    EXPECT_EQ(flooded.clients[i].session.status().state, SessionState::live) << i;
  }
  EXPECT_EQ(quiet.peers.limited(), 0u);
  constexpr std::uint64_t kSeconds = (kTicks - kQuiet) / 1000 + 1;  // and what was saved up
  EXPECT_LE(flooded.handled - quiet.handled, kSeconds * (net::kClientRate.datagrams + net::kHostRate.datagrams));
  EXPECT_GT(flooded.peers.limited(), 450'000u);
  EXPECT_GT(flooded.peers.limited_of(flooded.clients[2].at.key()), 220'000u) << "who it was is known";
  EXPECT_EQ(flooded.peers.limited_of(flooded.clients[0].at.key()), 0u);
}

}  // namespace
}  // namespace tactus::cli
