// SPDX-License-Identifier: Apache-2.0
/// What the server does for one client, at the edges of its states: proofs, faults, rates, new epochs, layers.
#include <tactus/session/server_connection.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <tactus/base/bytes.h>
#include <tactus/scene/scene_builder.h>
#include <tactus/scene/scene_syntax.h>
#include "tests/unit/deformable_fixture.h"
#include "tests/unit/session_fixture.h"

namespace tactus {
namespace {

using testing::SessionWorld;
using Bytes = std::vector<std::uint8_t>;
constexpr std::uint64_t kEpoch = 0x1234567890, kPeer = 9, kNow = 5'000'000;

/// A connection, and datagrams for it written by hand.
struct Desk {
  std::size_t hashes = 4096;
  std::uint64_t pieces_at = 0;
  explicit Desk(SessionServerOptions options = {}, std::uint32_t squares = 0, Role role = Role::participant)
      : connection(3, options, pieces_at) {
    SceneBuilder builder(100);
    builder.rigid("body");
    if (squares > 0) builder.deformable("sheet", testing::sheet(squares, squares));
    served.scene = builder.baselines(64).build().value();
    served.device = device_scene(*served.scene).value();
    served.declaration = std::make_shared<const Bytes>(write_scene(*served.scene).value());
    Fnv1a hash;
    for (const std::uint8_t b : *served.declaration) hash.add_byte(b);
    served.hash = hash.value();
    served.sender.policy = {.key_interval = 0, .baseline = Baseline::acknowledged};
    connection.open(kPeer, {.role = role, .nonce = 5}, served, kEpoch, now);
  }
  Result<void> hear(std::initializer_list<Part> parts, std::uint64_t epoch = kEpoch) {
    DatagramWriter writer(Direction::up);
    writer.begin(++number);
    for (const Part& part : parts) EXPECT_TRUE(writer.add(part));
    const auto bytes = writer.finish(epoch);
    if (!connection.is_mine(bytes)) return tl::unexpected(Error{});
    return connection.handle_datagram(now, bytes);
  }
  std::vector<Bytes> drain() {
    std::vector<Bytes> out;
    while (const auto datagram = connection.poll(now)) out.emplace_back(datagram->begin(), datagram->end());
    return out;
  }
  /// Bring the declaration over, and the client live.
  void go_live() {
    ASSERT_TRUE(hear({StatePart{0}}));
    for (int i = 0; i < 10'000 && connection.state() == SessionState::receiving; ++i) {
      now += 1000;
      for (const Bytes& bytes : drain()) {
        const auto message = read_datagram(bytes, Direction::down).value();
        const std::uint16_t newest = std::get<Numbered>(message).number;
        ASSERT_TRUE(hear({Acknowledgement{newest, 0, 0}, StatePart{1}}));
      }
    }
    ASSERT_EQ(connection.state(), SessionState::live);
  }

  ServedScene served;
  ServerConnection connection;
  std::uint64_t now = kNow, number = 0;
};

TEST(ServerConnection, SendsNothingToAnAddressThatIsNotValidated) {
  Desk desk({}, 10);
  for (int i = 0; i < 9'999; ++i) {
    desk.now += 1000;
    ASSERT_TRUE(desk.drain().empty());
    ASSERT_FALSE(desk.connection.is_silent(desk.now));
  }
  desk.now += 1000;
  EXPECT_TRUE(desk.connection.is_silent(desk.now)) << "and forgets it after 10 s";
  EXPECT_TRUE(desk.connection.leave(SessionEvent::silent, LeaveReason::silence));
  EXPECT_TRUE(desk.drain().empty()) << "without a word";
  EXPECT_TRUE(desk.connection.is_free());
  EXPECT_EQ(desk.connection.peer(), 0u);
}

TEST(ServerConnection, WhoeverKnowsTheEpochGetsThePieces) {
  Desk desk({}, 20);
  EXPECT_FALSE(desk.hear({StatePart{0}}, kEpoch + 1));
  EXPECT_TRUE(desk.drain().empty());
  EXPECT_TRUE(desk.hear({StatePart{0}}));
  EXPECT_EQ(desk.drain().size(), 1u) << "one each 0.5 ms";
  desk.now += 500;
  EXPECT_EQ(desk.drain().size(), 1u);
  EXPECT_EQ(desk.connection.next_timeout(), desk.now + 500);
}

/// By role; and an observer that has fixed a delay too short for copies is signalled that nothing waits for them.
TEST(ServerConnection, ChoosesWhatPacketsBuildOn) {
  struct Case {
    LossPolicy policy;
    Role role;
    std::uint64_t delay;  // [ms] of the first report
    bool acknowledged;
  };
  for (const Case& of :
       {Case{LossPolicy::by_role, Role::observer, 0, false}, Case{LossPolicy::by_role, Role::observer, 59, true},
        Case{LossPolicy::by_role, Role::observer, 60, false}, Case{LossPolicy::by_role, Role::participant, 0, true},
        Case{LossPolicy::prompt, Role::observer, 0, true}, Case{LossPolicy::repair, Role::participant, 1, false}}) {
    Desk desk({.loss = of.policy}, 0, of.role);
    ASSERT_TRUE(desk.hear({ReportPart{of.delay, 0}, StatePart{1}}));
    ASSERT_EQ(desk.connection.state(), SessionState::live);
    bool signalled = false;
    desk.now += 100'000;  // an acknowledgement is due
    for (const Bytes& bytes : desk.drain()) {
      const Datagram message = read_datagram(bytes, Direction::down).value();
      PartReader parts = std::get<Numbered>(message).parts(Direction::down);
      for (auto part = parts.next(); part && *part; part = parts.next())
        signalled = signalled || std::holds_alternative<BaselinesPart>(**part);
    }
    EXPECT_EQ(signalled, of.acknowledged) << static_cast<int>(of.policy) << " " << static_cast<int>(of.role) << " " << of.delay;
  }
}

TEST(ServerConnection, IsLiveOnceTheClientSaysSo) {
  Desk desk({}, 10);
  ASSERT_TRUE(desk.hear({StatePart{0}}));
  EXPECT_EQ(desk.connection.state(), SessionState::receiving);
  ASSERT_TRUE(desk.hear({StatePart{1}}));
  EXPECT_EQ(desk.connection.state(), SessionState::live) << "it has checked the hash of all pieces, whatever was acknowledged";
  EXPECT_FALSE(desk.connection.device(desk.now)) << "nothing was heard of the device";
}

TEST(ServerConnection, AClientThatBreaksRulesAgainAndAgainIsAtFault) {
  Desk desk;
  ASSERT_TRUE(desk.hear({StatePart{0}}));
  for (int i = 0; i < 100; ++i) {
    ASSERT_FALSE(desk.connection.is_at_fault());
    EXPECT_FALSE(desk.hear({FragmentPart{0, 0, 0, 1, {}}}));
  }
  EXPECT_TRUE(desk.connection.is_at_fault());
  EXPECT_TRUE(desk.connection.leave(SessionEvent::close, LeaveReason::protocol));
  const auto leaves = desk.drain();
  ASSERT_EQ(leaves.size(), 3u);
  EXPECT_EQ(std::get<Leave>(read_datagram(leaves[0], Direction::down).value()).reason, LeaveReason::protocol);
  EXPECT_TRUE(desk.connection.is_free());
}

TEST(ServerConnection, OldDatagramsAreNoFault) {
  Desk desk;
  ASSERT_TRUE(desk.hear({StatePart{0}}));
  for (int i = 0; i < 300; ++i) EXPECT_FALSE(desk.hear({Acknowledgement{30'000, 0, 0}}));
  for (int i = 0; i < 300; ++i) {
    desk.number = 0;
    EXPECT_FALSE(desk.hear({StatePart{0}}));
  }
  EXPECT_FALSE(desk.connection.is_at_fault());
}

TEST(ServerConnection, ANewEpochIsSentUntilTheClientSpeaksInIt) {
  Desk desk;
  desk.go_live();
  desk.drain();
  desk.connection.begin_epoch(desk.served, kEpoch + 1, desk.now);
  EXPECT_EQ(desk.connection.state(), SessionState::receiving);
  std::size_t welcomes = 0;
  for (int i = 0; i < 1000; ++i) {
    for (const Bytes& bytes : desk.drain()) {
      const auto message = read_datagram(bytes, Direction::down).value();
      if (const auto* welcome = std::get_if<Welcome>(&message)) {
        ++welcomes;
        EXPECT_EQ(welcome->serial, 1u);
        EXPECT_EQ(welcome->epoch, kEpoch + 1);
        EXPECT_EQ(welcome->nonce, 5u);
      }
    }
    desk.now += 1000;
  }
  EXPECT_EQ(welcomes, 4u);
  desk.number = 0;
  EXPECT_FALSE(desk.hear({StatePart{1}})) << "the old epoch is over";
  desk.number = 0;
  EXPECT_TRUE(desk.hear({StatePart{0}}, kEpoch + 1));
  desk.now += 1'000'000;
  for (const Bytes& bytes : desk.drain())
    EXPECT_TRUE(std::holds_alternative<Numbered>(read_datagram(bytes, Direction::down).value()));
}

TEST(ServerConnection, OnlyTheNewestButtonsCount) {
  Desk desk;
  desk.go_live();
  SenderOptions options = device_sender_options({});
  Sender device = Sender::create(desk.served.device, options).value();
  DeviceTruth truth(100, false);
  const auto packets = device.encode(50, truth.of(50, {.position = {0.1, 0.2, 0.3}}, {}), desk.number + 1);
  ASSERT_TRUE(packets);
  ASSERT_EQ(packets->size(), 1u);
  ASSERT_TRUE(desk.hear({ButtonsPart{50, 0b10}, PacketPart{0, (*packets)[0].bytes}}));
  ASSERT_TRUE(desk.connection.device(desk.now));
  EXPECT_EQ(desk.connection.device(desk.now)->buttons, 0b10u);
  EXPECT_NEAR(desk.connection.device(desk.now)->position.y, 0.2, 1e-4);
  ASSERT_TRUE(desk.hear({ButtonsPart{40, 0b01}}));
  EXPECT_EQ(desk.connection.device(desk.now)->buttons, 0b10u) << "those were before";
  ASSERT_TRUE(desk.hear({ButtonsPart{60, 0b11}}));
  EXPECT_EQ(desk.connection.device(desk.now)->buttons, 0b11u);
}

TEST(ServerConnection, AWrongHashAsksForAKeyPacket) {
  Desk desk;
  desk.go_live();
  std::uint64_t wrong = 0;
  for (std::int64_t tick = 0; tick < 200; ++tick) {
    const RigidSample sample{
        .pose = {{0.02 * static_cast<double>(tick * tick % 97), 0, 0}, {}}, .velocity = {}, .angular_velocity = {}};
    desk.now += 10'000;
    ASSERT_TRUE(
        desk.connection.submit(desk.now, tick, {.objects = {&sample, 1}, .contacts = {}, .deformables = {}}, desk.hashes));
    for (const Bytes& bytes : desk.drain()) {
      const std::uint16_t newest = std::get<Numbered>(read_datagram(bytes, Direction::down).value()).number;
      const auto hash = static_cast<std::uint32_t>(desk.connection.state_hash(0));
      const bool lie = newest == 128;
      if (newest % 64 != 0) ASSERT_TRUE(desk.hear({Acknowledgement{newest, 0, 0}}));
      else ASSERT_TRUE(desk.hear({Acknowledgement{newest, 0, 0}, HashPart{0, newest, lie ? hash + 1 : hash}}));
      wrong += lie ? 1u : 0u;
      EXPECT_EQ(desk.connection.status().traffic.wrong_states, wrong);
    }
  }
  EXPECT_EQ(wrong, 1u);
}

// Whole sessions

sim::LinkOptions delayed(std::uint64_t seed, double loss = 0) { return {.seed = seed, .delay = 20'000, .loss = loss}; }

/// What a declaration costs must not keep the client without packets once it is live.
TEST(ServerConnection, AtALowRateTheDeclarationAndThePacketsShareTheLine) {
  const TriMesh mesh = testing::sheet(60, 60);
  const SharedScene scene = SceneBuilder(100).rigid("body").deformable("sheet", mesh).baselines(4).build().value();
  SessionWorld world(scene, {.rate = 200'000});
  world.add({}, delayed(1), delayed(2));
  const auto truth = [sample = RigidSample{}](std::int64_t tick) mutable {
    sample.pose.position.x = 0.1 * std::sin(0.05 * static_cast<double>(tick));
    return Truth{.objects = {&sample, 1}, .contacts = {}, .deformables = {}};
  };
  while (world.server->status(0).state != SessionState::live && world.now < 60'000'000) world.step(truth);
  ASSERT_EQ(world.server->status(0).state, SessionState::live);
  const std::uint64_t live = world.now;
  const double bits = 8.0 * static_cast<double>(world.server->status(0).traffic.bytes_sent);
  EXPECT_LT(bits, 1.1 * 200'000 * static_cast<double>(live - 5'000'000) * 1e-6 + 200'000 * 0.05)
      << "pieces keep to the rate, too";
  while (world.server->status(0).traffic.packets_sent == 0 && world.now < live + 10'000'000) world.step(truth);
  EXPECT_LT(world.now, live + 250'000) << "the first packet comes soon";
}

/// A lost packet of a layered mesh is found out even if every datagram after it is refused.
TEST(ServerConnection, ALostLayerOfAMeshIsMadeUpForSoon) {
  constexpr std::uint32_t kSquares = 12;
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  const SharedScene scene = SceneBuilder(100).deformable("sheet", mesh, {.layered = true}).baselines(8).build().value();
  SessionWorld world(scene, {});
  world.add({}, delayed(1), {.seed = 2, .delay = 20'000, .outages = {{8'000'000, 8'015'000}}});
  testing::DentedSheet sheet(mesh, kSquares, 5e-4);
  testing::SheetFrame frame;
  DeformableTruth shape;
  std::uint64_t worst = 0, bad_since = 0;
  for (int i = 0; i < 1000; ++i) {
    world.step([&](std::int64_t tick) {
      frame = sheet.frame(tick);
      shape = frame.truth();
      return Truth{.objects = {}, .contacts = {}, .deformables = {&shape, 1}};
    });
    if (world.now < 7'900'000) continue;
    Receiver* receiver = world.ends[0].client->receiver();
    const std::int64_t behind = world.tick - receiver->tick(1);
    bad_since = behind > 5 ? (bad_since == 0 ? world.now : bad_since) : 0;
    worst = std::max(worst, bad_since == 0 ? 0 : world.now - bad_since);
  }
  EXPECT_LT(worst, 300'000u) << "us without a new shape after two lost packets, with a round trip of 40 ms";
}

/// A new scene in the moment between a welcome and the client's first word.
TEST(ServerConnection, AClientThatJoinsWhileTheSceneIsReplacedArrives) {
  const SharedScene scene = SceneBuilder(100).rigid("body").baselines(4).build().value();
  for (int ticks = 1; ticks < 12; ++ticks) {
    SessionWorld world(scene, {});
    world.add({}, delayed(1), delayed(2));
    for (int i = 0; i < ticks; ++i) world.step();
    ASSERT_TRUE(world.server->replace_scene(scene, world.now));
    for (int i = 0; i < 1500; ++i) world.step();
    EXPECT_EQ(world.ends[0].client->status().state, SessionState::live) << ticks << " ticks after it began to join";
    EXPECT_EQ(world.server->status(0).state, SessionState::live) << ticks;
  }
}

/// However long an outage is, if neither end has given up.
TEST(ServerConnection, AParticipantThatMovesSurvivesALongOutage) {
  const SharedScene scene = SceneBuilder(20).rigid("body").baselines(64).build().value();
  for (const sim::Microseconds outage : {90'000'000, 115'000'000, 300'000'000}) {
    SessionWorld world(scene, {.silence = 600'000'000});
    const sim::Microseconds begin = 8'000'000, end = begin + outage;
    world.add({.role = Role::participant, .silence = 600'000'000}, {.seed = 1, .delay = 10'000, .outages = {{begin, end}}},
              {.seed = 2, .delay = 10'000, .outages = {{begin, end}}});
    RigidSample sample;
    std::uint64_t up = 0;
    for (int i = 0; world.now < static_cast<std::uint64_t>(end) + 3'000'000; ++i) {
      const Vec3 at{0.1 * std::sin(0.3 * i), 0, 0};
      ASSERT_TRUE(world.ends[0].client->submit(world.now, {.position = at}, DeviceContact{at + Vec3{0, 0, 1e-3}, 500}));
      sample.pose.position = at;
      if (world.now < 10'000'000) up = world.datagrams_up;
      world.step([&](std::int64_t) { return Truth{.objects = {&sample, 1}, .contacts = {}, .deformables = {}}; });
      if (world.now > 20'000'000 && world.now < 20'050'001) {
        EXPECT_LE(world.datagrams_up - up, 10u * 21u) << "at most 20 in a second while nobody answers";
      }
    }
    ASSERT_EQ(world.server->status(0).state, SessionState::live) << outage;
    EXPECT_EQ(world.server->state_hash(0, 0), world.ends[0].client->receiver()->state_hash(0)) << outage;
    const auto device = world.server->device(0, world.now);
    ASSERT_TRUE(device);
    EXPECT_LT(norm(device->position - sample.pose.position), 0.06) << outage;
  }
}

/// A client that dies while the declaration is on its way: nothing is due until something can go.
TEST(ServerConnection, ATimeoutThatIsDueHasSomethingToSay) {
  Desk desk({.silence = 3'000'000'000}, 40);
  ASSERT_TRUE(desk.hear({StatePart{0}}));
  const std::uint64_t end = desk.now + 2'500'000'000;
  std::size_t wakes = 0;
  for (; desk.now < end; ++wakes) {
    desk.drain();
    const auto due = desk.connection.next_timeout();
    ASSERT_TRUE(due);
    ASSERT_GT(*due, desk.now);
    desk.now = *due;
  }
  EXPECT_LT(wakes, 20'000u);
}

TEST(ServerConnection, TheNextClientInItsSlotBeginsWithCleanCounters) {
  Desk desk;
  desk.go_live();
  RigidSample body;
  for (int i = 0; i < 200; ++i) {
    desk.now += 10'000;
    body.pose.position.x = 0.01 * (i % 7);
    ASSERT_TRUE(desk.connection.submit(desk.now, i, {.objects = {&body, 1}, .contacts = {}, .deformables = {}}, desk.hashes));
    for (const Bytes& bytes : desk.drain()) {
      const std::uint16_t newest = std::get<Numbered>(read_datagram(bytes, Direction::down).value()).number;
      ASSERT_TRUE(desk.hear({Acknowledgement{newest, 0, 0}, HashPart{0, newest, 1}}));
    }
  }
  ASSERT_GT(desk.connection.status().traffic.wrong_states, 0u);
  ASSERT_TRUE(desk.connection.leave(SessionEvent::left, LeaveReason::bye));
  desk.connection.open(kPeer + 1, {.nonce = 6}, desk.served, kEpoch + 1, desk.now);
  EXPECT_EQ(desk.connection.status().traffic.wrong_states, 0u);
}

}  // namespace
}  // namespace tactus
