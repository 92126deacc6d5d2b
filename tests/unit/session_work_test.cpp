// SPDX-License-Identifier: Apache-2.0
/// What takes long at a server is made where the program likes, and no byte depends on it.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <tactus/scene/scene_builder.h>
#include <tactus/session/session_client.h>
#include <tactus/session/session_server.h>
#include "tests/property/allocated.h"

namespace tactus {
namespace {

using Bytes = std::vector<std::uint8_t>;
constexpr std::uint32_t kBodies = 40;

SharedScene scene() {
  SceneBuilder builder(1000);
  for (std::uint32_t i = 0; i < kBodies; ++i) builder.rigid("body " + std::to_string(i), {{0.1 * i, 0, 0}, {}});
  return builder.baselines(64).build().value();
}

SessionServer server_of(bool works_elsewhere, std::uint16_t clients = 4) {
  SessionServerOptions options{.clients = clients};
  options.works_elsewhere = works_elsewhere;
  options.sender.triggers.haptic = HapticRule::off;
  options.sender.triggers.visual_position = 1e-4;
  return SessionServer::create(scene(), options, 5, 0).value();
}

/// Clients 5 ms away each way, and all that the server sent.
class World {
 public:
  World(bool works_elsewhere, std::size_t clients) : server(server_of(works_elsewhere)) {
    for (std::size_t i = 0; i < clients; ++i) {
      users.push_back(SessionClient::create({.role = i % 2 == 0 ? Role::observer : Role::participant}).value());
      users.back().open(0, 100 + i);
    }
    for (std::uint32_t i = 0; i < kBodies; ++i) bodies[i].pose.position = {0.1 * i, 0, 0};
  }

  /// One tick; `work` is called after each datagram that came.
  template <class Work>
  void step(Work&& work) {
    const std::uint64_t now = 1000 * static_cast<std::uint64_t>(tick);
    for (; !up.empty() && up.front().at <= now; up.pop_front()) {
      static_cast<void>(server.handle_datagram(now, up.front().user + 1, up.front().bytes));
      work(now);
      drain(now);
    }
    server.handle_timeout(now);
    if (up.empty()) work(now);
    const double time = 1e-3 * static_cast<double>(tick);
    for (std::uint32_t i = 0; i < 5; ++i) {
      bodies[i].pose.position.y = 0.1 * std::sin(3 * time + i);
      bodies[i].velocity.y = 0.3 * std::cos(3 * time + i);
    }
    Truth truth{.objects = bodies};
    truth.moved = moved;
    ASSERT_TRUE(server.submit(now, tick++, truth));
    drain(now);
    for (; !down.empty() && down.front().at <= now; down.pop_front())
      static_cast<void>(users[down.front().user].handle_datagram(now, down.front().bytes));
    for (std::size_t i = 0; i < users.size(); ++i) {
      users[i].handle_timeout(now);
      while (const auto message = users[i].poll_datagram(now))
        up.push_back({now + 5000, i, Bytes(message->begin(), message->end())});
    }
  }
  void drain(std::uint64_t now) {
    while (const auto message = server.poll_datagram(now)) {
      down.push_back({now + 5000, message->peer - 1, Bytes(message->bytes.begin(), message->bytes.end())});
      all.push_back(down.back().bytes);
    }
    while (const auto event = server.poll_event()) lives += event->kind == ServerEvent::Kind::live ? 1 : 0;
  }

  struct Sent {
    std::uint64_t at = 0;
    std::size_t user = 0;
    Bytes bytes;
  };
  SessionServer server;
  std::vector<SessionClient> users;
  std::array<RigidSample, kBodies> bodies{};
  std::deque<Sent> up, down;
  std::optional<std::span<const std::uint32_t>> moved{};  // all are compared
  std::vector<Bytes> all;
  std::int64_t tick = 0;
  int lives = 0;
};

/// Done at once, it is as if the server had done it.
TEST(SessionWork, ElsewhereMakesTheSameBytes) {
  World here(false, 4), elsewhere(true, 4);
  int done = 0;
  for (int i = 0; i < 400; ++i) {
    here.step([&](std::uint64_t) { EXPECT_FALSE(here.server.poll_work()); });
    elsewhere.step([&](std::uint64_t now) {
      while (auto work = elsewhere.server.poll_work()) {
        work->run();
        const auto rest = elsewhere.server.take(now, *std::move(work));
        ASSERT_TRUE(rest);
        EXPECT_FALSE(*rest);
        ++done;
      }
    });
  }
  EXPECT_EQ(done, 4);
  EXPECT_EQ(elsewhere.lives, 4);
  ASSERT_GT(here.all.size(), 100u);
  EXPECT_TRUE(here.all == elsewhere.all);
}

/// What moves while nobody looks is there for who comes then, though only what moves now is named.
TEST(SessionWork, WhatMovedBeforeAnybodyCameIsShown) {
  World world(false, 0);
  std::array<std::uint32_t, 5> moving{0, 1, 2, 3, 4};
  world.moved = moving;
  world.bodies[20].pose.position.x += 0.3;
  const std::array<std::uint32_t, 1> once{20};
  world.moved = once;
  for (int i = 0; i < 20; ++i) {
    world.step([](std::uint64_t) {});
    world.moved = moving;
  }
  for (int joins = 0; joins < 2; ++joins) {  // the second comes back after a time without anybody
    const auto now = [&] { return 1000 * static_cast<std::uint64_t>(world.tick); };
    world.users.clear();
    world.users.push_back(SessionClient::create({}).value());
    world.users[0].open(now(), 900 + static_cast<std::uint64_t>(joins));
    for (int i = 0; i < 200; ++i) world.step([](std::uint64_t) {});
    ASSERT_NE(world.users[0].receiver(), nullptr);
    const auto shown = world.users[0].receiver()->object(20);
    const int exponent = world.users[0].receiver()->scene()->grid.position;
    EXPECT_NEAR(std::ldexp(shown.position[0], -exponent), world.bodies[20].pose.position.x, 1e-3);
    world.users[0].close();
    for (int i = 0; i < 5; ++i) world.step([](std::uint64_t) {});
    world.bodies[20].pose.position.x += 0.3;
    world.moved = once;
    world.step([](std::uint64_t) {});
    world.moved = moving;
  }
}

/// On a thread, while ticks go on; clients that wait are live a little later.
TEST(SessionWork, RunsOnAThreadWhileTicksGoOn) {
  World world(true, 4);
  std::optional<SessionServer::Work> out;
  std::thread thread;
  for (int i = 0; i < 400; ++i)
    world.step([&](std::uint64_t now) {
      if (thread.joinable() && i % 7 == 0) {
        thread.join();
        ASSERT_TRUE(world.server.take(now, *std::exchange(out, std::nullopt)));
      }
      if (thread.joinable()) return;
      out = world.server.poll_work();
      if (out) thread = std::thread([&out] { out->run(); });
    });
  if (thread.joinable()) thread.join();
  EXPECT_EQ(world.lives, 4);
  for (SessionClient& user : world.users) EXPECT_GT(user.shown_tick(400'000), 300);
}

/// A client that begins anew meanwhile gets parts of its own; those that it needs no more come back to be freed.
TEST(SessionWork, WhoBeginsAnewGetsItsOwn) {
  World world(true, 1);
  std::optional<SessionServer::Work> old;
  while (!old && world.tick < 200)
    world.step([&](std::uint64_t) {
      if (!old) old = world.server.poll_work();
    });
  ASSERT_TRUE(old);
  old->run();
  world.users[0] = SessionClient::create({}).value();
  world.users[0].open(1000 * static_cast<std::uint64_t>(world.tick), 77);
  std::optional<SessionServer::Work> anew;
  while (!anew && world.tick < 400)
    world.step([&](std::uint64_t) {
      if (!anew) anew = world.server.poll_work();
    });
  ASSERT_TRUE(anew);
  anew->run();
  const auto now = 1000 * static_cast<std::uint64_t>(world.tick);
  auto rest = world.server.take(now, *std::move(old));
  ASSERT_TRUE(rest);
  EXPECT_TRUE(rest->has_value());
  EXPECT_EQ(world.server.status(0).state, SessionState::receiving);
  rest = world.server.take(now, *std::move(anew));
  ASSERT_TRUE(rest);
  EXPECT_FALSE(rest->has_value());
  EXPECT_EQ(world.server.status(0).state, SessionState::live);
}

/// What a live client had is freed elsewhere, too.
TEST(SessionWork, WhatALiveClientHadIsHandedOut) {
  World world(true, 1);
  const auto work = [&](std::uint64_t now) {
    while (auto next = world.server.poll_work()) {
      next->run();
      ASSERT_TRUE(world.server.take(now, *std::move(next)));
    }
  };
  while (world.lives == 0 && world.tick < 200) world.step(work);
  ASSERT_EQ(world.lives, 1);
  world.users[0] = SessionClient::create({}).value();
  world.users[0].open(1000 * static_cast<std::uint64_t>(world.tick), 77);
  int frees = 0;
  for (int i = 0; i < 8; ++i)
    world.step([&](std::uint64_t now) {
      while (auto next = world.server.poll_work()) {
        ++frees;
        next->run();
        ASSERT_TRUE(world.server.take(now, *std::move(next)));
      }
    });
  EXPECT_EQ(frees, 1);
  EXPECT_EQ(world.lives, 1) << "nothing else was to be done so far";
  while (world.lives == 1 && world.tick < 400) world.step(work);
  EXPECT_EQ(world.lives, 2);
}

/// Without memory the client stays where it is, and its next keep-alive asks again.
TEST(SessionWork, WithoutMemoryItIsAskedAgain) {
  World world(true, 1);
  std::optional<SessionServer::Work> first;
  while (!first && world.tick < 200)
    world.step([&](std::uint64_t) {
      if (!first) first = world.server.poll_work();
    });
  ASSERT_TRUE(first);
  testing::fail_allocation(3);
  first->run();
  testing::fail_allocation(0);
  const auto taken = world.server.take(1000 * static_cast<std::uint64_t>(world.tick), *std::move(first));
  ASSERT_FALSE(taken);
  EXPECT_STREQ(taken.error().rule, "R-API-11");
  std::optional<SessionServer::Work> second;
  while (!second && world.tick < 600)
    world.step([&](std::uint64_t) {
      if (!second) second = world.server.poll_work();
    });
  ASSERT_TRUE(second);
  second->run();
  ASSERT_TRUE(world.server.take(1000 * static_cast<std::uint64_t>(world.tick), *std::move(second)));
  EXPECT_EQ(world.server.status(0).state, SessionState::live);
}

// ==== groups of clients ====

constexpr std::size_t kClients = 8, kTicks = 700;

/// The bodies, tick by tick: all servers look at the same. They move once all clients are live: a server reads no truth before.
using Motion = std::vector<std::array<RigidSample, kBodies>>;

Motion motion() {
  Motion out(kTicks);
  for (std::size_t tick = 0; tick < kTicks; ++tick)
    for (std::uint32_t i = 0; i < kBodies; ++i) {
      const double time = 1e-3 * std::max(0.0, static_cast<double>(tick) - 200), rate = i < 8 && tick > 200 ? 2 + 0.7 * i : 0;
      out[tick][i].pose.position = {0.1 * i, 0.1 * std::sin(rate * time), 0};
      out[tick][i].velocity = {0, 0.1 * rate * std::cos(rate * time), 0};
    }
  return out;
}

/// What each of some clients is sent, without what differs from session to session: joins, and the check that depends on the epoch.
std::vector<std::vector<Bytes>> serve(std::size_t first, std::size_t count, const SharedScene& of, const Motion& motion) {
  SessionServerOptions options{.clients = static_cast<std::uint16_t>(count)};
  options.sender.triggers.haptic = HapticRule::off;
  options.sender.triggers.visual_position = 1e-4;
  SessionServer server = SessionServer::create(of, options, 1 + first, 0).value();
  std::vector<SessionClient> clients;
  std::vector<std::deque<Bytes>> up(count);
  std::vector<std::vector<Bytes>> out(count);
  for (std::size_t i = 0; i < count; ++i) {
    clients.push_back(SessionClient::create({.role = (first + i) % 3 == 0 ? Role::participant : Role::observer}).value());
    clients[i].open(0, 100 + first + i);
  }
  const auto drain = [&](std::uint64_t now) {
    while (const auto message = server.poll_datagram(now)) {
      const std::size_t i = message->peer - 1;
      static_cast<void>(clients[i].handle_datagram(now, message->bytes));
      const bool is_numbered = (message->bytes[0] & 3u) != 0;
      if (is_numbered) out[i].emplace_back(message->bytes.begin(), message->bytes.end() - 4);
    }
  };
  for (std::size_t tick = 0; tick < kTicks; ++tick) {
    const std::uint64_t now = 1000 * tick;
    for (std::size_t i = 0; i < count; ++i)
      for (; up[i].size() > 5 + (first + i) % 4; up[i].pop_front()) {
        if (up[i].front().empty()) continue;
        static_cast<void>(server.handle_datagram(now, i + 1, up[i].front()));
        drain(now);
      }
    server.handle_timeout(now);
    EXPECT_TRUE(server.submit(now, static_cast<std::int64_t>(tick), {.objects = motion[tick]}));
    drain(now);
    for (std::size_t i = 0; i < count; ++i) {
      clients[i].handle_timeout(now);
      while (const auto message = clients[i].poll_datagram(now)) up[i].emplace_back(message->begin(), message->end());
      up[i].emplace_back();  // a tick passes
    }
  }
  for (std::uint16_t i = 0; i < count; ++i) EXPECT_EQ(server.status(i).state, SessionState::live);
  return out;
}

/// Each client is sent the same by one server, and by one of several, each on a thread of its own with nothing but scene and truth in
/// common.
TEST(SessionGroups, OfClientsOnThreadsAreServedTheSameBytes) {
  const SharedScene of = scene();
  const Motion bodies = motion();
  const auto alone = serve(0, kClients, of, bodies);
  for (const auto& bytes : alone) ASSERT_GT(bytes.size(), 50u);
  for (const std::size_t groups : {2u, 4u}) {
    const std::size_t each = kClients / groups;
    std::vector<std::vector<std::vector<Bytes>>> sent(groups);
    std::vector<std::thread> threads;
    for (std::size_t group = 0; group < groups; ++group)
      threads.emplace_back([&, group] { sent[group] = serve(group * each, each, of, bodies); });
    for (std::thread& thread : threads) thread.join();
    for (std::size_t i = 0; i < kClients; ++i)
      EXPECT_TRUE(alone[i] == sent[i / each][i % each]) << groups << " groups, client " << i;
  }
}

}  // namespace
}  // namespace tactus
