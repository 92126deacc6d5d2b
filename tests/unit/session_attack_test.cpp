// SPDX-License-Identifier: Apache-2.0
/// A client that has gone bad, strangers and whoever joins again and again: what honest clients hear is the same, byte for byte, as without.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <tactus/base/bytes.h>
#include <tactus/scene/scene_builder.h>
#include <tactus/session/datagram.h>
#include <tactus/session/session_client.h>
#include <tactus/session/session_server.h>

namespace tactus {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Random = std::mt19937_64;

constexpr std::size_t kObjects = 20, kSide = 8;  // bodies; vertices of a sheet
constexpr std::int64_t kFrame = 17;              // [ticks] from shape to shape
constexpr std::uint64_t kBad = 3;                // address of the client that goes bad; the honest ones are 1 and 2

SharedScene scene() {
  SceneBuilder builder(1000);
  for (std::size_t i = 0; i < kObjects; ++i) builder.rigid("body " + std::to_string(i));
  TriMesh sheet;
  for (std::size_t i = 0; i < kSide * kSide; ++i)
    sheet.vertices.push_back({0.01 * static_cast<double>(i % kSide), 0.01 * static_cast<double>(i / kSide), 0});
  for (std::uint32_t y = 0; y + 1 < kSide; ++y)
    for (std::uint32_t x = 0; x + 1 < kSide; ++x) {
      const std::uint32_t a = y * kSide + x, b = a + kSide;
      sheet.triangles.push_back({a, a + 1, b + 1});
      sheet.triangles.push_back({a, b + 1, b});
    }
  return builder.deformable("sheet", sheet, {.frame_period = kFrame}).baselines(64).build().value();
}

/// So that its check holds in this epoch.
void repair(Bytes& datagram, std::uint64_t epoch) {
  if (datagram.size() < 6) return;
  std::array<std::uint8_t, 9> front{};
  for (std::size_t i = 0; i < 8; ++i) front[i] = static_cast<std::uint8_t>(epoch >> 8 * i);
  front[8] = static_cast<std::uint8_t>(Direction::up);
  const auto body = std::span(datagram).first(datagram.size() - 4);
  const std::uint32_t check = crc32(body, crc32(front));
  for (std::size_t i = 0; i < 4; ++i) datagram[body.size() + i] = static_cast<std::uint8_t>(check >> 8 * i);
}

/// A server with two honest clients and a third one, in virtual time without delays.
struct Attacked {
  struct Client {
    SessionClient session;
    std::uint64_t epoch = 0, epochs = 0, sent = 0, closed = 0;
    Fnv1a heard;  // of all that the server sent to it
  };

  Attacked() : displacements(3 * kSide * kSide) {
    for (unsigned i = 0; i < 3; ++i) {
      clients.push_back({SessionClient::create({.role = i == 1 ? Role::observer : Role::participant}).value(), 0, 0, 0, 0, {}});
      clients.back().session.open(now, 7 + i);
    }
  }
  void send(std::uint64_t from, const Bytes& datagram) {
    ++sent;
    taken += server.handle_datagram(now, from, datagram) ? 1u : 0u;
    drain();
  }
  void drain() {
    while (const auto message = server.poll_datagram(now)) {
      if (message->peer == 0 || message->peer > clients.size()) {
        to_strangers += message->bytes.size();
        continue;
      }
      Client& client = clients[message->peer - 1];
      const auto read = read_datagram(message->bytes, Direction::down);
      ASSERT_TRUE(read) << "what the server sends can be read";
      if (const auto* welcome = std::get_if<Welcome>(&*read))
        client.epochs += std::exchange(client.epoch, welcome->epoch) != welcome->epoch ? 1u : 0u;
      for (const std::uint8_t byte : message->bytes) client.heard.add_byte(byte);
      ++client.sent;
      static_cast<void>(client.session.handle_datagram(now, message->bytes));
    }
    while (server.poll_event()) continue;
  }
  void move(std::int64_t tick) {
    for (std::size_t i = 0; i < kObjects; ++i) {
      const double k = static_cast<double>(i), w = 1.5 + 0.7 * std::sin(13 * k), x = 1e-3 * static_cast<double>(tick);
      objects[i].pose.position = {0.1 * std::sin(w * x + k), 0.1 * std::cos(1.1 * w * x + k), 0};
      objects[i].velocity = {0.1 * w * std::cos(w * x + k), -0.11 * w * std::sin(1.1 * w * x + k), 0};
    }
    for (std::size_t i = 0; i < kSide * kSide; ++i)
      displacements[3 * i + 2] =
          static_cast<float>(0.003 * std::sin(0.01 * static_cast<double>(tick) + 0.3 * static_cast<double>(i % kSide)));
  }
  void step(std::int64_t tick) {
    now += 1000;
    move(tick);
    const DeformableTruth shape{.displacements = displacements, .touch = {}};
    const bool is_new = tick % kFrame == 0;
    ASSERT_TRUE(server.submit(now, tick, {.objects = objects, .deformables = std::span(&shape, is_new ? 1 : 0)}));
    drain();
    for (std::size_t i = 0; i < clients.size(); ++i) {
      Client& client = clients[i];
      DeviceSample device;
      device.position = {0.05 * std::sin(0.004 * static_cast<double>(tick) + static_cast<double>(i)), 0, 0};
      static_cast<void>(client.session.submit(now, device, {}));
      client.session.handle_timeout(now);
      while (const auto message = client.session.poll_datagram(now)) {
        Bytes datagram(message->begin(), message->end());
        if (i + 1 == kBad) overheard[next++ % overheard.size()] = datagram;
        send(i + 1, datagram);
      }
      while (const auto event = client.session.poll_event()) client.closed += event->kind == ClientEvent::Kind::closed ? 1u : 0u;
    }
    server.handle_timeout(now);
    drain();
    for (std::uint16_t i = 0; i < clients.size(); ++i) static_cast<void>(server.device(i, now));
  }
  Client& bad() { return clients[kBad - 1]; }

  std::uint64_t now = 1'000'000, sent = 0, taken = 0, to_strangers = 0;  // datagrams to the server; [bytes]
  std::vector<RigidSample> objects{kObjects};
  std::vector<float> displacements;
  SessionServer server = SessionServer::create(scene(), {.clients = 6}, 42, now).value();
  std::vector<Client> clients;
  std::array<Bytes, 256> overheard;  // of the client that goes bad
  std::size_t next = 0;
};

/// A datagram with one part that is well formed and holds anything.
Bytes any_part(Random& random, std::uint64_t epoch) {
  DatagramWriter writer(Direction::up);
  writer.begin(random() % 20'000);
  const auto any = [&](std::size_t size) {
    Bytes out(size);
    for (std::uint8_t& byte : out) byte = static_cast<std::uint8_t>(random());
    return out;
  };
  const auto any_number = [&] { return random() >> random() % 64; };
  const Bytes bytes = any(random() % (random() % 2 == 0 ? 1150 : 60) + 1);
  switch (random() % 7) {
    case 0:
      writer.add(Acknowledgement{static_cast<std::uint16_t>(random()), static_cast<std::uint16_t>(random()), any_number()});
      break;
    case 1:
      writer.add(FragmentPart{any_number(), random() % 4, random() % 1030, random() % 1030, bytes});
      break;
    case 2:
      writer.add(HashPart{static_cast<std::uint8_t>(random() % 3), static_cast<std::uint16_t>(64 * random()), 5});
      break;
    case 3:
      writer.add(ButtonsPart{static_cast<std::uint32_t>(random()), static_cast<std::uint32_t>(random())});
      break;
    case 4:
      writer.add(ReportPart{any_number(), static_cast<std::uint8_t>(random() % 2)});
      break;
    case 5:
      writer.add(PacketPart{random() % 5, bytes});
      break;
    default:
      break;
  }
  if (writer.empty()) writer.add(StatePart{static_cast<std::uint8_t>(random() % 2)});
  const auto datagram = writer.finish(epoch);
  return {datagram.begin(), datagram.end()};
}

Bytes join_of(Random& random) {
  DatagramWriter writer(Direction::up);
  const auto message = writer.write(Join{.role = random() % 2 == 0 ? Role::participant : Role::observer,
                                         .nonce = random(),
                                         .state_limit = random() >> random() % 64,
                                         .header_limit = random() >> random() % 64,
                                         .token = random() % 2,
                                         .seat = static_cast<std::uint8_t>(random() % 4)});
  return {message.begin(), message.end()};
}

/// What the bad client sent before, damaged, cut, prolonged or as it was, with a check that holds; or noise.
Bytes damaged(Random& random, const Attacked& world, std::uint64_t epoch) {
  Bytes out = world.overheard[random() % world.overheard.size()];
  if (out.size() < 6) return {};
  const std::uint64_t how = random() % 5;
  if (how == 0) out.resize(6 + random() % 1195);
  if (how == 1) out[0] = static_cast<std::uint8_t>(random()), out[1] = static_cast<std::uint8_t>(random());
  if (how < 4)
    for (std::uint64_t k = random() % 4; k > 0; --k) out[random() % out.size()] ^= static_cast<std::uint8_t>(1u << random() % 8);
  if (how != 4) repair(out, random() % 16 == 0 ? 0 : epoch);
  return out;
}

using Attack = std::function<void(Attacked&, Random&)>;

/// 24 datagrams in a tick from the address of a client that was honest, and takes part.
void go_bad(Attacked& world, Random& random) {
  if (world.bad().session.status().state == SessionState::closed)
    world.bad().session.open(world.now, random());  // it was thrown out
  for (int i = 0; i < 24; ++i) {
    const std::uint64_t epoch = world.bad().epoch, what = random() % 8;
    if (what < 4) world.send(kBad, damaged(random, world, epoch));
    else if (what < 7) world.send(kBad, any_part(random, epoch));
    else if (random() % 50 == 0) world.send(kBad, join_of(random));
  }
}

void send_as_strangers(Attacked& world, Random& random) {
  for (int i = 0; i < 24; ++i) {
    const std::uint64_t from = 100 + random() % 50, what = random() % 4;
    world.send(from, what == 0   ? join_of(random)
                     : what == 1 ? any_part(random, random())
                                 : damaged(random, world, world.bad().epoch));
  }
}

/// A program that joins, is let come alive and joins anew: each time a session ends and another begins.
void join_again(Attacked& world, Random& random) {
  if (world.now % 20'000 != 0) return;
  world.bad().session = SessionClient::create({.role = Role::participant}).value();
  world.bad().session.open(world.now, random());
}

class SessionAttack : public ::testing::TestWithParam<std::pair<const char*, Attack>> {};

TEST_P(SessionAttack, WhatHonestClientsHearIsTheSame) {
  constexpr std::int64_t kTicks = 3000, kQuiet = 1000;
  const Attack& attack = GetParam().second;
  std::uint64_t sent = 0, taken = 0, lives = 0;
  Attacked quiet;
  for (std::int64_t tick = 0; tick < kTicks; ++tick) quiet.step(tick);
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    Attacked attacked;
    Random random(seed);
    for (std::int64_t tick = 0; tick < kTicks; ++tick) {
      attacked.step(tick);
      if (tick >= kQuiet) attack(attacked, random);
    }
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(attacked.clients[i].heard.value(), quiet.clients[i].heard.value()) << "client " << i << ", seed " << seed;
      EXPECT_GT(attacked.clients[i].sent, 200u);
      EXPECT_EQ(attacked.clients[i].sent, quiet.clients[i].sent);
      EXPECT_EQ(attacked.clients[i].closed, 0u);
      EXPECT_EQ(attacked.server.status(static_cast<std::uint16_t>(i)).traffic.wrong_states, 0u);
    }
    sent += attacked.sent;
    lives += attacked.bad().epochs;
    taken += attacked.taken;
    EXPECT_LE(attacked.to_strangers, attacked.sent * 76) << "no more than they sent";
  }
  RecordProperty("datagrams", std::to_string(sent));
  RecordProperty("taken", std::to_string(taken));
  RecordProperty("sessions", std::to_string(lives));
  if (GetParam().first != std::string("strangers")) {
    EXPECT_GT(lives, 100u) << "sessions of the bad client";
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, SessionAttack,
                         ::testing::Values(std::pair{"bad_client", Attack(go_bad)},
                                           std::pair{"strangers", Attack(send_as_strangers)},
                                           std::pair{"join_loop", Attack(join_again)}),
                         [](const auto& kind) { return kind.param.first; });

}  // namespace
}  // namespace tactus
