// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/session_client.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <tactus/rigid/rigid_state.h>
#include <tactus/scene/scene_builder.h>
#include "tests/unit/deformable_fixture.h"
#include "tests/unit/session_fixture.h"

namespace tactus {
namespace {

using testing::SessionWorld;

SharedScene pendulum_scene() { return SceneBuilder(1000).rigid("pendulum").baselines(64).build().value(); }

RigidSample pendulum(std::int64_t tick) {
  const double w = 2 * std::numbers::pi, t = 1e-3 * static_cast<double>(tick);
  return {.pose = {{0.1 * std::sin(w * t), 0, 0}, {}}, .velocity = {0.1 * w * std::cos(w * t), 0, 0}, .angular_velocity = {}};
}

/// Drives a world with a pendulum, and judges what a client shows.
struct Swing {
  explicit Swing(const sim::LinkOptions& up, const sim::LinkOptions& down, SessionClientOptions options = {})
      : scene(pendulum_scene()), world(scene, server_options()) {
    world.add(options, up, down);
  }
  static SessionServerOptions server_options() {
    SessionServerOptions options;
    options.sender.triggers.visual_position = 0.001;
    return options;
  }
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      world.step([this](std::int64_t tick) {
        sample = pendulum(tick);
        return Truth{.objects = {&sample, 1}, .contacts = {}, .deformables = {}};
      });
      judge();
    }
  }
  void judge() {
    SessionClient& client = *world.ends[0].client;
    Receiver* receiver = client.receiver();
    const std::int64_t shown = client.shown_tick(world.now);
    if (receiver == nullptr || shown < 0) return;
    EXPECT_GE(shown, last_shown);
    EXPECT_LE(shown, world.tick);
    last_shown = shown;
    const Pose pose = client.pose(0, shown);
    ++judged;
    if (norm(pose.position - pendulum(shown).pose.position) > 0.001) ++over;
  }

  SharedScene scene;
  SessionWorld world;
  RigidSample sample;
  std::int64_t last_shown = -1;
  int judged = 0, over = 0;
};

TEST(SessionClient, JoinsGetsTheSceneAndFollowsIt) {
  Swing swing({.seed = 1, .delay = 20'000}, {.seed = 2, .delay = 20'000});
  swing.run(3000);
  const auto& end = swing.world.ends[0];
  ASSERT_EQ(end.events.size(), 2u);
  EXPECT_EQ(end.events[0].kind, ClientEvent::Kind::welcomed);
  EXPECT_EQ(end.events[1].kind, ClientEvent::Kind::live);
  ASSERT_EQ(swing.world.events.size(), 2u);
  EXPECT_EQ(swing.world.events[1].kind, ServerEvent::Kind::live);
  EXPECT_GT(swing.judged, 2500);
  EXPECT_EQ(swing.over, 0);
  const SessionStatus status = end.client->status();
  ASSERT_TRUE(status.round_trip);
  EXPECT_NEAR(static_cast<double>(status.round_trip->smoothed), 40000, 250);
  const auto shown = end.client->round_trip_shown(swing.world.now);
  ASSERT_TRUE(shown);
  EXPECT_NEAR(static_cast<double>(*shown), 40'000 + static_cast<double>(status.playout_delay), 1500)
      << "a tick is shown for 1 ms";
  ASSERT_TRUE(status.clock_offset);
  EXPECT_NEAR(static_cast<double>(*status.clock_offset), 0, 250);
  EXPECT_EQ(status.traffic.packets_refused, 0u);
  EXPECT_EQ(swing.world.refused, 0u);
}

TEST(SessionClient, FollowsOverALinkThatLosesAndReorders) {
  const sim::LinkOptions down{.seed = 2, .delay = 5'000, .jitter = 30'000, .loss = 0.1, .duplicates = 0.05};
  sim::LinkOptions up = down;
  up.seed = 3;
  Swing swing(up, down);
  swing.run(20000);
  EXPECT_GT(swing.judged, 19000);
  EXPECT_LT(swing.over, swing.judged / 50);
  const ClientStatus status = swing.world.server->status(0);
  EXPECT_EQ(status.traffic.wrong_states, 0u);
  EXPECT_NEAR(status.loss, 0.1, 0.05);
}

/// [us] until the server's welcome is here, over a network that loses three of ten datagrams each way.
std::uint64_t time_of_join(const SharedScene& scene, std::uint64_t seed) {
  SessionWorld world(scene, {});
  world.add({}, {.seed = 2 * seed, .delay = 20'000, .loss = 0.3}, {.seed = 2 * seed + 1, .delay = 20'000, .loss = 0.3});
  const std::uint64_t begun = world.now;
  while (world.ends[0].client->status().state == SessionState::joining) world.step();
  return world.now - begun;
}

TEST(SessionClient, ALostJoinGoesAgainSoon) {
  const SharedScene scene = pendulum_scene();
  int late = 0;
  std::uint64_t sum = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const std::uint64_t time = time_of_join(scene, seed);
    late += time > 1'000'000 ? 1 : 0;
    sum += time;
  }
  EXPECT_LE(late, 14) << "0.51^5";
  EXPECT_LT(sum / 200, 350'000u);
}

TEST(SessionClient, WhoHearsNothingIsSentNoMoreThanItSends) {
  SessionWorld world(pendulum_scene(), {});
  world.add({}, {}, {.loss = 1});
  for (int i = 0; i < 9000; ++i) world.step();
  EXPECT_EQ(world.ends[0].client->status().state, SessionState::joining);
  EXPECT_EQ(world.datagrams_down, world.datagrams_up) << "one answer to each join, which is the longer one";
  EXPECT_GE(world.datagrams_up, 9u);
  EXPECT_LE(world.datagrams_up, 12u);
}

TEST(SessionClient, LeavesAndMayJoinAgain) {
  Swing swing({.seed = 1, .delay = 1'000}, {.seed = 2, .delay = 1'000});
  swing.run(300);
  SessionClient& client = *swing.world.ends[0].client;
  client.close();
  swing.run(50);
  EXPECT_EQ(client.status().state, SessionState::closed);
  EXPECT_EQ(swing.world.server->status(0).state, SessionState::closed);
  client.open(swing.world.now, 99);
  swing.last_shown = -1;
  swing.run(300);
  EXPECT_EQ(client.status().state, SessionState::live);
  EXPECT_EQ(swing.world.server->status(0).state, SessionState::live);
}

TEST(SessionClient, GivesUpWhenNobodyAnswers) {
  Swing swing({.seed = 1, .loss = 1}, {});
  swing.run(11000);
  const auto& end = swing.world.ends[0];
  ASSERT_EQ(end.events.size(), 1u);
  EXPECT_EQ(end.events[0].kind, ClientEvent::Kind::closed);
  EXPECT_EQ(end.events[0].reason, LeaveReason::silence);
  EXPECT_LE(swing.world.datagrams_up, 12u);
}

TEST(SessionClient, ForceFadesWithin100MillisecondsWithoutNewsAndReturns) {
  Swing swing({.seed = 1, .delay = 5'000}, {.seed = 2, .delay = 5'000, .outages = {{7'000'000, 9'000'000}}},
              {.role = Role::participant});
  SessionClient& client = *swing.world.ends[0].client;
  double before = 0, largest_step = 0;
  std::uint64_t zero_at = 0;
  for (int i = 0; i < 6000; ++i) {
    ASSERT_TRUE(client.submit(swing.world.now, {.position = {1e-4 * i, 0, 0}}, DeviceContact{{1e-4 * i, 0, 1e-3}, 500}));
    swing.run(1);
    const double fraction = client.force_fraction(swing.world.now);
    if (i > 100) largest_step = std::max(largest_step, std::abs(fraction - before));  // once it is live
    if (fraction == 0 && before > 0) zero_at = swing.world.now;
    before = fraction;
    if (i == 1500) {
      EXPECT_EQ(fraction, 1);
    }
  }
  EXPECT_GT(zero_at, 7'000'000u);
  EXPECT_LE(zero_at, 7'000'000u + 5'000 + 100'000 + 1'000);
  EXPECT_LE(largest_step, 0.035);
  EXPECT_EQ(before, 1) << "long after the outage";
}

/// A scene of nothing but a mesh: its packets signal the time, too, and the shape of the tick shown is within its bounds.
TEST(SessionClient, ShowsASceneOfMeshesOnly) {
  constexpr std::uint32_t kSquares = 12;
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  const SharedScene scene = SceneBuilder(60).deformable("sheet", mesh).baselines(64).build().value();
  SessionWorld world(scene, {});
  world.add({}, {.seed = 1, .delay = 20'000}, {.seed = 2, .delay = 20'000});
  testing::DentedSheet sheet(mesh, kSquares);
  std::vector<testing::SheetFrame> frames;
  DeformableTruth shape;
  double worst = 0;
  int judged = 0;
  for (int i = 0; i < 300; ++i) {
    world.step([&](std::int64_t tick) {
      frames.push_back(sheet.frame(tick));
      shape = frames.back().truth();
      return Truth{.objects = {}, .contacts = {}, .deformables = {&shape, 1}};
    });
    SessionClient& client = *world.ends[0].client;
    const std::int64_t shown = client.shown_tick(world.now);
    if (shown < 10) continue;
    ++judged;
    const auto displacements = client.receiver()->replica().displacements(0, shown);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      const double unit = std::ldexp(1.0, -scene->grid.position);
      const Vec3 u{unit * displacements[v][0], unit * displacements[v][1], unit * displacements[v][2]};
      worst = std::max(worst, norm(u - testing::vertex_of(frames[static_cast<std::size_t>(shown)].displacements, v)));
    }
  }
  EXPECT_GT(judged, 250);
  EXPECT_LE(worst, DeformableThresholds{}.visual + 1e-6);
}

TEST(SessionClient, ReportsAtOnceBoundsThatNoDeviceCanKeep) {
  for (const double position : {0.0, -1.0, std::nan("")}) {
    const auto client = SessionClient::create({.role = Role::participant, .device = {.position = position}});
    ASSERT_FALSE(client) << position;
    EXPECT_STREQ(client.error().rule, "R-API-4");
    EXPECT_TRUE(SessionClient::create({.role = Role::observer, .device = {.position = position}})) << "it has no device";
  }
}

/// A button that is held while the scene changes is held in the new one.
TEST(SessionClient, ButtonsLiveThroughANewEpoch) {
  SessionWorld world(pendulum_scene(), {});
  world.add({.role = Role::participant}, {.seed = 1, .delay = 2'000}, {.seed = 2, .delay = 2'000});
  const auto run = [&](int ticks) {
    for (int i = 0; i < ticks; ++i) {
      ASSERT_TRUE(world.ends[0].client->submit(world.now, {.position = {1e-4 * i, 0, 0}, .buttons = 2}, {}));
      world.step();
    }
  };
  run(300);
  ASSERT_EQ(world.server->device(0, world.now)->buttons, 2u);
  ASSERT_TRUE(world.server->replace_scene(pendulum_scene(), world.now));
  run(600);
  ASSERT_EQ(world.ends[0].client->status().state, SessionState::live);
  const auto device = world.server->device(0, world.now);
  ASSERT_TRUE(device);
  EXPECT_EQ(device->buttons, 2u);
}

/// However a session stalls, what it says about its next timeout lets a program sleep.
TEST(SessionClient, ATimeoutThatIsDueHasSomethingToSay) {
  for (const bool participant : {false, true}) {
    SessionWorld world(pendulum_scene(), {.silence = 3'000'000'000});
    world.add({.role = participant ? Role::participant : Role::observer, .silence = 3'000'000'000}, {.seed = 1}, {.seed = 2});
    for (int i = 0; i < 500; ++i) world.step();
    SessionClient& client = *world.ends[0].client;
    std::uint64_t wakes = 0;
    const std::uint64_t end = world.now + 2'500'000'000;  // nobody answers for 40 minutes, numbers run out
    for (std::uint64_t now = world.now; now < end; ++wakes) {
      ASSERT_TRUE(
          client.submit(now, {.position = {1e-9 * static_cast<double>(now % 1000), 0, 0}}, DeviceContact{{0, 0, 1}, 500}));
      client.handle_timeout(now);
      while (client.poll_datagram(now)) continue;
      const auto due = client.next_timeout();
      ASSERT_TRUE(due);
      ASSERT_GT(*due, now) << "it would be asked again and again";
      now = *due;
    }
    EXPECT_LT(wakes, 20'000u);
  }
}

}  // namespace
}  // namespace tactus
