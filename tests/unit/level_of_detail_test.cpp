// SPDX-License-Identifier: Apache-2.0
/// Objects are sent to a client by their distance: levels, their bounds, and what is left out.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include <tactus/receiver.h>
#include <tactus/rigid/level_of_detail.h>
#include <tactus/scene/scene_builder.h>
#include <tactus/sender.h>
#include "tests/unit/rigid_fixture.h"
#include "tests/unit/session_fixture.h"

namespace tactus {
namespace {

constexpr double kFull = 0.5, kReach = 6;           // [m]
constexpr double kBound = 1e-3, kTurnBound = 0.02;  // [m, rad]

SharedScene world(std::size_t objects, bool is_smoothed = true) {
  SceneBuilder builder(1000);
  for (std::size_t i = 0; i < objects; ++i)
    builder.rigid("body " + std::to_string(i), {{static_cast<double>(i % 20), static_cast<double>(i / 20), 0}, {}});
  return builder.rigid_profile(is_smoothed ? RigidProfile::main : RigidProfile::thesis)
      .interest(kFull, kReach)
      .baselines(64)
      .build()
      .value();
}

SenderOptions options_of(Baseline baseline) {
  SenderOptions out;
  out.triggers.heartbeat = 0;
  out.triggers.visual_position = kBound;
  out.triggers.visual_rotation = kTurnBound;
  out.policy = {.key_interval = 0, .baseline = baseline};
  return out;
}

/// Objects around their homes that move and rest by turns, and one who walks among them.
class World {
 public:
  World(std::size_t objects, std::uint64_t seed) : random_(seed) {
    for (std::size_t i = 0; i < objects; ++i) motions_.emplace_back(seed * 1000 + i);
    samples.resize(objects);
    for (std::size_t i = 0; i < objects; ++i) samples[i].pose.position = home(i);
    moves_.resize(objects);
  }
  static Vec3 home(std::size_t i) { return {static_cast<double>(i % 20), static_cast<double>(i / 20), 0}; }
  void step() {
    moved.clear();
    for (std::uint32_t i = 0; i < samples.size(); ++i) {
      const bool before = moves_[i];
      if (random_() % 500 == 0) moves_[i] = !moves_[i];
      if (!before && !moves_[i]) continue;
      const Vec3 at = samples[i].pose.position;
      samples[i] = motions_[i].step(1e-3);
      samples[i].pose.position = samples[i].pose.position + home(i);
      if (!moves_[i]) samples[i].pose.position = at, samples[i].velocity = samples[i].angular_velocity = {};
      moved.push_back(i);
    }
    time_ += 1e-3;
  }
  Vec3 eyes() const { return {10 + 9 * std::sin(0.2 * time_), 3 + 3 * std::cos(0.3 * time_), 0.2}; }
  Truth truth() const { return {.objects = samples, .moved = moved}; }

  std::vector<RigidSample> samples;
  std::vector<std::uint32_t> moved;

 private:
  std::mt19937_64 random_;
  std::vector<testing::Motion> motions_;
  std::vector<bool> moves_;
  double time_ = 0;
};

TEST(LevelsOfDetail, RiseWithTheDistanceAndStayWhereSomebodyStandsAtABorder) {
  const SharedScene scene = world(1);
  LevelsOfDetail levels(*scene);
  HeldList held(*scene);
  RigidTruth truth(*scene, {}, held);
  RigidSample body;
  std::int64_t tick = 0;
  const auto at = [&](double x) {
    body.pose.position.x = x;
    EXPECT_TRUE(truth.read(tick++, {&body, 1}, {}));
    levels.look(0, truth);
    return int{levels.of(0)};
  };
  EXPECT_EQ(at(100), 0) << "nobody has said from where the client looks";
  levels.set_viewpoints({});
  EXPECT_EQ(at(0), kOutOfInterest) << "its viewpoints are not known";
  const Vec3 origin;
  levels.set_viewpoints({&origin, 1});
  EXPECT_EQ(at(0.5), 0);
  EXPECT_EQ(at(0.57), 0) << "0.5 m and 15 %";
  EXPECT_EQ(at(0.58), 1);
  EXPECT_EQ(at(0.51), 1);
  EXPECT_EQ(at(0.49), 0);
  EXPECT_EQ(at(2.5), 3) << "2 m and 15 % are below";
  EXPECT_EQ(at(5.9), 4);
  EXPECT_EQ(at(6.5), 4) << "beyond reach, by less than 15 %";
  EXPECT_EQ(at(6.91), kOutOfInterest);
  EXPECT_EQ(at(6.1), kOutOfInterest);
  EXPECT_EQ(at(5.99), 4);
  const std::array<Vec3, 2> viewpoints{origin, Vec3{6, 0, 0}};
  levels.set_viewpoints(viewpoints);
  EXPECT_EQ(at(5.99), 0) << "the nearest viewpoint counts";
  const std::array<Vec3, 2> broken{Vec3{std::nan(""), 0, 0}, Vec3{6, 0, 0}};
  levels.set_viewpoints(broken);
  EXPECT_EQ(at(0), 4) << "one that is not finite does not";
}

TEST(LevelsOfDetail, WhatIsTouchedIsSentInFullWithinReach) {
  const SharedScene scene = world(1);
  LevelsOfDetail levels(*scene);
  HeldList held(*scene);
  RigidTruth truth(*scene, {}, held);
  const Vec3 origin;
  levels.set_viewpoints({&origin, 1});
  RigidSample body;
  for (const auto& [x, level] : {std::pair{5.0, 0}, {7.0, int{kOutOfInterest}}}) {
    body.pose.position.x = x;
    const Contact contact = testing::touch(0, body.pose, 1e-3);
    ASSERT_TRUE(truth.read(static_cast<std::int64_t>(x), {&body, 1}, {&contact, 1}));
    levels.look(0, truth);
    EXPECT_EQ(levels.of(0), level) << x;
  }
}

/// What rests is looked at within 200 ms after the viewpoint has moved, and not at all while it stays.
TEST(LevelsOfDetail, WhatRestsIsLookedAtWhereTheViewpointMoves) {
  const SharedScene scene = world(140);
  LevelsOfDetail levels(*scene);
  HeldList held(*scene);
  RigidTruth truth(*scene, {}, held);
  World of(140, 1);
  for (const std::int64_t tick : {0, 1}) ASSERT_TRUE(truth.read(tick, of.samples, {}));  // now all rests
  std::size_t changed = 0, ticks = 0;
  const auto scan = [&] {
    for (ticks = 0; ticks < 200; ++ticks) levels.scan(truth, [&](std::uint32_t) { ++changed; });
  };
  scan();
  EXPECT_EQ(changed, 0u);
  Vec3 viewpoint{0, 0, 0};
  levels.set_viewpoints({&viewpoint, 1});
  scan();
  std::size_t inside = 0;
  for (std::size_t i = 0; i < 140; ++i) inside += norm(World::home(i)) <= kReach ? 1u : 0u;
  EXPECT_EQ(changed, inside) << "all were out of interest";
  viewpoint.x = 0.01;
  levels.set_viewpoints({&viewpoint, 1});
  changed = 0;
  scan();
  EXPECT_EQ(changed, 0u) << "less than a sixteenth of the distance of full detail";
  viewpoint.x = 19;
  levels.set_viewpoints({&viewpoint, 1});
  scan();
  EXPECT_GT(changed, 60u);
  for (std::uint32_t i = 0; i < 140; ++i)
    EXPECT_EQ(levels.of(i) == kOutOfInterest, norm(World::home(i) - viewpoint) > kReach) << i;
}

struct Judged {
  std::uint64_t packets = 0, bytes = 0, updates = 0;
  std::array<std::uint64_t, 8> sent{};  // objects and ticks by level
};

/// The bounds of the level that is signalled hold in every tick, and the level is that of the distance.
Judged judge(Baseline baseline, bool is_smoothed, bool looks, std::uint64_t seed) {
  constexpr std::size_t kObjects = 140;
  const SharedScene scene = world(kObjects, is_smoothed);
  Sender sender = Sender::create(scene, options_of(baseline)).value();
  Receiver receiver = Receiver::create(scene).value();
  World of(kObjects, seed);
  Judged out;
  for (std::int64_t tick = 0; tick < 4000; ++tick) {
    of.step();
    const Vec3 eyes = of.eyes();
    if (looks) sender.set_viewpoints({&eyes, 1});
    const auto packets = sender.encode(tick, of.truth());
    EXPECT_TRUE(packets);
    for (const Packet& packet : *packets) {
      const auto decoded = receiver.push(packet.number, packet.bytes);
      EXPECT_TRUE(decoded);
      if (tick % 40 == 0) sender.acknowledge(0, packet.number);
      ++out.packets, out.bytes += packet.bytes.size(), out.updates += packet.updates;
    }
    for (std::uint32_t i = 0; i < kObjects; ++i) {
      const std::uint8_t lod = receiver.replica().lod(i, tick);
      ++out.sent[lod];
      const double distance = norm(of.samples[i].pose.position - eyes);
      if (looks && tick > 200) {
        const double margin = 0.45;  // [m] that is walked while all is looked at, and a sixteenth of kFull
        const double most = lod == kOutOfInterest ? 1e9 : lod == 6 ? kReach : std::min(kReach, std::ldexp(kFull, lod));
        EXPECT_LE(distance, 1.15 * most + margin) << tick << ' ' << i;
        if (lod > 0) {
          EXPECT_GE(distance, std::min(kReach, std::ldexp(kFull, lod - 1)) - margin) << tick << ' ' << i;
        }
      }
      if (lod == kOutOfInterest) continue;
      const Pose shown = to_pose(receiver.replica().pose(i, tick), scene->grid.position);
      EXPECT_LE(norm(shown.position - of.samples[i].pose.position), std::ldexp(kBound, lod)) << tick << ' ' << i;
      EXPECT_LE(angle_between(shown.rotation, of.samples[i].pose.rotation), std::ldexp(kTurnBound, lod)) << tick << ' ' << i;
    }
    if (::testing::Test::HasFailure()) break;
  }
  EXPECT_EQ(sender.state_hash(0), receiver.state_hash(0));
  return out;
}

TEST(LevelsOfDetail, BoundsOfTheLevelHoldInEveryTick) {
  for (const Baseline baseline : {Baseline::previous, Baseline::acknowledged})
    for (const bool is_smoothed : {false, true}) {
      const Judged all = judge(baseline, is_smoothed, false, 5), near = judge(baseline, is_smoothed, true, 5);
      EXPECT_EQ(all.sent[0], 140u * 4000) << "who does not say from where it looks is sent all in full";
      for (const std::size_t lod : {0u, 1u, 2u, 3u, 4u, 7u}) EXPECT_GT(near.sent[lod], 1000u) << lod;
      EXPECT_LT(2 * near.bytes, all.bytes);
    }
}

TEST(LevelsOfDetail, AKeyPacketNamesWhatIsOfInterestAlone) {
  const SharedScene scene = world(140);
  Sender sender = Sender::create(scene, options_of(Baseline::previous)).value();
  World of(140, 3);
  for (std::int64_t tick = 0; tick < 3000; ++tick) {
    of.step();
    const Vec3 eyes = of.eyes();
    sender.set_viewpoints({&eyes, 1});
    ASSERT_TRUE(sender.encode(tick, of.truth()));
  }
  sender.request_key();
  const auto key = sender.encode(3000, of.truth());
  ASSERT_EQ(testing::all(key).size(), 1u);
  Receiver late = Receiver::create(scene).value();
  const auto decoded = late.push(key->front().number, key->front().bytes);
  ASSERT_TRUE(decoded);
  std::size_t shown = 0;
  for (std::uint32_t i = 0; i < 140; ++i) {
    EXPECT_EQ(late.replica().lod(i, 3000), sender.object(i).lod) << i;
    shown += late.replica().lod(i, 3000) != kOutOfInterest ? 1u : 0u;
  }
  EXPECT_EQ(decoded->updates.size(), shown);
  EXPECT_LT(shown, 100u);
}

/// Who begins with a key packet has not shown what was out of interest then: an update must not lead over from there.
TEST(LevelsOfDetail, WhatEntersIsNotSmoothedFromWhatNotEverybodyHasShown) {
  const SharedScene scene = world(2);
  Sender sender = Sender::create(scene, options_of(Baseline::previous)).value();
  Receiver late = Receiver::create(scene).value();
  std::vector<RigidSample> bodies(2);
  bodies[0].pose.position.x = 8;
  const Vec3 between{4, 0, 0}, away{-1, 0, 0};
  bool has_key = false, is_seen = false;
  for (std::int64_t tick = 0; tick < 1500; ++tick) {
    const Vec3& eyes = tick >= 500 && tick < 1000 ? away : between;
    sender.set_viewpoints({&eyes, 1});
    if (tick == 900) sender.request_key(), bodies[1].pose.position.x = 0.3;
    if (tick == 950) bodies[0].pose.position.x = 8.003;
    const auto packets = sender.encode(tick, {.objects = bodies});
    for (const Packet& packet : testing::all(packets)) {
      has_key = has_key || (tick == 900 && packet.key);
      if (!has_key) continue;
      ASSERT_TRUE(late.push(packet.number, packet.bytes)) << tick;
    }
    if (!has_key || late.replica().lod(0, tick) == kOutOfInterest) continue;
    is_seen = true;
    const Pose shown = to_pose(late.replica().pose(0, tick), scene->grid.position);
    ASSERT_LE(std::abs(shown.position.x - bodies[0].pose.position.x), std::ldexp(kBound, late.replica().lod(0, tick))) << tick;
  }
  EXPECT_TRUE(has_key && is_seen);
}

// ==== in a session ====

constexpr std::uint64_t kDelay = 20'000;  // [us]

sim::LinkOptions link_options(double loss, std::uint64_t seed) {
  sim::LinkOptions out;
  out.delay = kDelay;
  out.loss = loss;
  out.seed = seed;
  return out;
}

struct Seen {
  std::uint64_t over = 0, shown = 0, bytes = 0;
};

/// in   looks  it is signalled from where a client looks
Seen run(Role role, LossPolicy policy, double loss, bool looks, std::uint64_t seed) {
  const SharedScene scene = world(140);
  SessionServerOptions options{.sender = options_of(Baseline::previous), .loss = policy, .max_bound_scale = 1};
  testing::SessionWorld session(scene, options);
  SessionClientOptions client{.role = role};
  testing::SessionWorld::End& end = session.add(client, link_options(loss, seed), link_options(loss, seed + 50));
  World of(140, seed);
  std::vector<std::vector<RigidSample>> past;
  Seen out;
  for (std::int64_t tick = 0; tick < 5000; ++tick) {
    of.step();
    past.push_back(of.samples);
    if (looks) end.client->set_viewpoint(of.eyes());
    EXPECT_TRUE(end.client->submit(session.now, {.position = of.eyes()}, std::nullopt));  // nothing, of an observer
    session.step([&](std::int64_t) { return of.truth(); });
    const std::int64_t s = end.client->shown_tick(session.now);
    Receiver* const receiver = end.client->receiver();
    if (receiver == nullptr || s < 1000 || s >= static_cast<std::int64_t>(past.size())) continue;
    bool over = false;
    for (std::uint32_t i = 0; i < 140; ++i) {
      const std::uint8_t lod = receiver->replica().lod(i, s);
      if (lod == kOutOfInterest) continue;
      ++out.shown;
      const Pose pose = to_pose(receiver->replica().pose(i, s), scene->grid.position);
      const RigidSample& truth = past[static_cast<std::size_t>(s)][i];
      over = over || norm(pose.position - truth.pose.position) > std::ldexp(kBound, lod);
    }
    out.over += over ? 1u : 0u;
  }
  EXPECT_EQ(session.server->status(0).traffic.wrong_states, 0u);
  out.bytes = session.server->status(0).traffic.payload_sent;
  return out;
}

TEST(LevelsOfDetail, ASessionSendsWhatIsNearTheViewpointOfTheClient) {
  for (const LossPolicy policy : {LossPolicy::repair, LossPolicy::prompt}) {
    const Seen all = run(Role::observer, policy, 0, false, 1), near = run(Role::observer, policy, 0, true, 1);
    EXPECT_EQ(all.over, 0u);
    EXPECT_EQ(near.over, 0u);
    EXPECT_LT(2 * near.bytes, all.bytes);
    EXPECT_LT(10 * near.shown, 6 * all.shown);
    EXPECT_GT(8 * near.shown, all.shown);
  }
}

TEST(LevelsOfDetail, AParticipantLooksFromItsDevice) {
  const Seen near = run(Role::participant, LossPolicy::prompt, 0, false, 2);
  EXPECT_EQ(near.over, 0u);
  EXPECT_GT(near.shown, 140u * 4000 / 8);
  EXPECT_LT(near.shown, 140u * 4000 * 6 / 10);
}

TEST(LevelsOfDetail, AreRightWherePacketsGetLost) {
  for (const std::uint64_t seed : {3u, 4u}) {
    EXPECT_LE(run(Role::observer, LossPolicy::repair, 0.1, true, seed).over, 40u) << seed;  // 1 % of the ticks
    EXPECT_GT(run(Role::observer, LossPolicy::prompt, 0.1, true, seed).shown, 40'000u) << seed;
  }
}

}  // namespace
}  // namespace tactus
