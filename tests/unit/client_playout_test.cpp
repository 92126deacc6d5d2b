// SPDX-License-Identifier: Apache-2.0
/// A client that shows the past: its timelines, the gaps that it knows, and the curves over them.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include <tactus/client/bend.h>
#include <tactus/client/replica.h>
#include <tactus/client/timeline.h>
#include "tests/unit/rigid_fixture.h"

namespace tactus {
namespace {

using testing::scene_of;

Timeline::Update update(std::int64_t tick, std::uint64_t number) {
  Timeline::Update out{number, {}};
  out.state.tick = tick;
  return out;
}

TEST(Timeline, BeginsWithTheInitialState) {
  Timeline timeline;
  RigidState initial;
  initial.position = {1, 2, 3};
  timeline.reset(initial);
  for (const std::int64_t tick : {-5, 0, 1000}) {
    EXPECT_EQ(timeline.around(tick).before.state, initial);
    EXPECT_EQ(timeline.around(tick).before.number, 0u);
    EXPECT_EQ(timeline.around(tick).after, nullptr);
  }
}

TEST(Timeline, OrderOfArrivalDoesNotMatter) {
  std::vector<Timeline::Update> updates{update(0, 0)};
  for (std::uint64_t i = 1; i <= 200; ++i) updates.push_back(update(static_cast<std::int64_t>(i / 3 * 7), i));
  std::mt19937_64 random(1);
  for (int round = 0; round < 20; ++round) {
    Timeline timeline;
    timeline.reset({});
    std::vector<Timeline::Update> shuffled(updates.begin() + 1, updates.end());
    std::shuffle(shuffled.begin(), shuffled.end(), random);
    for (const Timeline::Update& u : shuffled) timeline.add(u);
    const std::span held = std::span(updates).last(Timeline::kMost);
    for (std::int64_t tick = -1; tick < 480; ++tick) {
      const auto after = std::ranges::find_if(held, [&](const auto& u) { return u.state.tick > tick; });
      const auto [before, next] = timeline.around(tick);
      EXPECT_EQ(before.number, after == held.begin() ? held.front().number : (after - 1)->number) << tick;
      const auto following = after == held.begin() ? after + 1 : after;  // before all: the first is shown, at its own tick
      EXPECT_EQ(next == nullptr ? 0 : next->number, following == held.end() ? 0 : following->number) << tick;
    }
  }
}

TEST(HeardPackets, KnowsTheNewestThousand) {
  HeardPackets heard;
  for (std::uint64_t number = 70000; number < 73000; ++number)
    if (number % 500 != 7) heard.add(number);
  EXPECT_TRUE(heard.all_between(72508, 72999));
  EXPECT_TRUE(heard.all_between(72507, 72999)) << "the ends do not count";
  EXPECT_FALSE(heard.all_between(72506, 72999));
  EXPECT_TRUE(heard.all_between(72500, 72501)) << "nothing is between";
  EXPECT_FALSE(heard.all_between(72500, 72508));
  heard.add(72507);
  EXPECT_TRUE(heard.all_between(72500, 72999)) << "an overtaken packet";
  heard.add(72007);
  EXPECT_TRUE(heard.all_between(71975, 72999)) << "the oldest heard is 1023 back";
  EXPECT_FALSE(heard.all_between(71974, 72999));
  heard.add(71000);
  EXPECT_FALSE(heard.all_between(70999, 71001)) << "too long ago";
  heard.add(100000);
  EXPECT_FALSE(heard.all_between(99990, 100000));
  heard.reset();
  EXPECT_FALSE(heard.all_between(99999, 100001));
}

/// Smooth motion of one object, exact to the grid.
RigidState along(std::int64_t tick, bool moves) {
  const double t = 1e-3 * static_cast<double>(tick), angle = 2 * std::sin(1.5 * t + 0.3);
  const Vec3 axis{0.6, 0, 0.8};
  RigidSample sample;
  sample.pose.position = {0.1 * std::sin(3 * t), 0.2 * std::cos(2 * t), 0.3 * t * t};
  sample.pose.rotation = {std::cos(angle / 2), axis.x * std::sin(angle / 2), axis.y * std::sin(angle / 2),
                          axis.z * std::sin(angle / 2)};
  if (moves) {
    sample.velocity = {0.3 * std::cos(3 * t), -0.4 * std::sin(2 * t), 0.6 * t};
    sample.angular_velocity = 3 * std::cos(1.5 * t + 0.3) * axis;
  }
  return to_grid(sample, tick, scene_of(1)->grid).value();
}

double distance(const RigidPose& a, const RigidPose& b) {
  const unsigned exponent = scene_of(1)->grid.position;
  return norm(to_pose(a, exponent).position - to_pose(b, exponent).position);
}
double angle(const RigidPose& a, const RigidPose& b) { return angle_between(to_pose(a, 22).rotation, to_pose(b, 22).rotation); }

TEST(Bend, MeetsBothUpdatesAndTheMotionBetween) {
  const SharedScene scene = scene_of(1);
  const RigidPredictor predictor(*scene);
  for (const std::int64_t length : {20, 60, 300}) {
    const RigidState a = along(400, true), b = along(400 + length, true);
    const RigidPose first = bend(*scene, a, b, 400), last = bend(*scene, a, b, 400 + length - 1);
    EXPECT_EQ(first, (RigidPose{a.position, a.rotation}));
    EXPECT_LT(distance(last, {b.position, b.rotation}), 2e-3);
    double worst = 0, turned = 0, reckoned = 0;
    for (std::int64_t tick = 400; tick < 400 + length; ++tick) {
      const RigidState truth = along(tick, true);
      const RigidPose shown = bend(*scene, a, b, tick), at{truth.position, truth.rotation};
      worst = std::max(worst, distance(shown, at));
      turned = std::max(turned, angle(shown, at));
      reckoned = std::max(reckoned, distance(predictor.pose(a, tick), at));
    }
    const double t = 1e-3 * static_cast<double>(length);
    EXPECT_LT(worst, 1e-5 + 8.1 * t * t * t * t / 384) << "of fourth order: the largest fourth derivative is 0.1 * 3^4 m/s^4";
    EXPECT_LT(turned, 1e-4 + 12 * t * t * t * t / 384) << length;
    EXPECT_GT(reckoned, 5 * worst) << "dead reckoning is of second order";
  }
}

TEST(Bend, WithoutVelocitiesTheWayIsStraight) {
  const SharedScene scene = scene_of(1);
  const RigidState a = along(400, false), b = along(500, false);
  const RigidPose from{a.position, a.rotation}, to{b.position, b.rotation};
  for (std::int64_t tick = 400; tick < 500; ++tick) {
    const double share = static_cast<double>(tick - 400) / 100;
    const RigidPose shown = bend(*scene, a, b, tick);
    EXPECT_NEAR(distance(from, shown), share * distance(from, to), 1e-6);
    EXPECT_NEAR(angle(from, shown), share * angle(from, to), 1e-6);
  }
}

/// Updates of one object; their packets arrive in any order, or not at all.
struct Arrival {
  std::uint64_t number;
  std::int64_t tick;
  bool restarts = false;
};

class PlayoutReplica {
 public:
  explicit PlayoutReplica(Interpolation way = Interpolation::playout) : replica_(*scene_, {.interpolation = way}, {}) {}
  void take(const Arrival& arrival, std::int64_t now = 0) {
    const RigidState state = along(arrival.tick, true);
    const RigidUpdate named{0, Reason::visual, 0};
    DecodedPacket packet;
    packet.number = arrival.number;
    packet.tick = arrival.tick;
    packet.restarts = arrival.restarts;
    packet.updates = {&named, 1};
    replica_.apply(packet, {&state, 1}, now);
  }
  RigidPose shown(std::int64_t tick) const { return replica_.pose(0, tick); }
  RigidPose reckoned(std::int64_t from, std::int64_t tick) const { return RigidPredictor(*scene_).pose(along(from, true), tick); }
  RigidPose bent(std::int64_t from, std::int64_t to, std::int64_t tick) const {
    return bend(*scene_, along(from, true), along(to, true), tick);
  }

 private:
  SharedScene scene_ = scene_of(1);
  Replica replica_;
};

TEST(ClientPlayout, BendsOverKnownGapsOnly) {
  PlayoutReplica client;
  for (const Arrival& a : {Arrival{1, 400}, {2, 440}, {4, 500}, {6, 900}}) client.take(a);
  EXPECT_EQ(client.shown(420), client.reckoned(400, 420)) << "nothing is missing";
  EXPECT_EQ(client.shown(440), client.reckoned(440, 440));
  EXPECT_EQ(client.shown(470), client.bent(440, 500, 470)) << "packet 3 is missing";
  EXPECT_EQ(client.shown(600), client.reckoned(500, 600)) << "packet 5 is missing, for longer than 300 ms";
  EXPECT_EQ(client.shown(950), client.reckoned(900, 950)) << "the future is not known";
  client.take({3, 441});
  EXPECT_EQ(client.shown(470), client.reckoned(441, 470)) << "it was only overtaken";
}

TEST(ClientPlayout, BeforeTheFirstUpdateTheInitialStateIsShown) {
  PlayoutReplica client;
  EXPECT_EQ(client.shown(-100), RigidPose{});
  client.take({70000, 40});
  for (const std::int64_t tick : {-1, 0, 39}) EXPECT_EQ(client.shown(tick), RigidPose{}) << "no curve comes from there";
  EXPECT_EQ(client.shown(40), client.reckoned(40, 40));
}

TEST(ClientPlayout, OrderOfArrivalDoesNotMatter) {
  std::vector<Arrival> arrivals;
  for (std::uint64_t n = 1; n < 50; ++n)
    if (n % 7 != 0) arrivals.push_back({n, static_cast<std::int64_t>(20 * n)});
  PlayoutReplica in_order;
  for (const Arrival& a : arrivals) in_order.take(a);
  std::mt19937_64 random(2);
  std::shuffle(arrivals.begin(), arrivals.end(), random);
  PlayoutReplica shuffled;
  for (const Arrival& a : arrivals) shuffled.take(a);
  for (std::int64_t tick = 0; tick < 1000; ++tick) EXPECT_EQ(in_order.shown(tick), shuffled.shown(tick)) << tick;
}

TEST(ClientPlayout, ARestartForgetsWhatWasKnown) {
  PlayoutReplica client;
  client.take({1, 400});
  client.take({2, 450});
  client.take({40000, 30, true});
  EXPECT_EQ(client.shown(20), RigidPose{});
  EXPECT_EQ(client.shown(460), client.reckoned(30, 460));
}

TEST(ClientReplicaOrder, AnOvertakenUpdateIsNotShown) {
  for (const Interpolation way : {Interpolation::none, Interpolation::linear}) {
    PlayoutReplica client(way), spared(way);
    for (PlayoutReplica* both : {&client, &spared}) {
      both->take({1, 400}, 400);
      both->take({3, 440}, 440);
    }
    client.take({2, 420}, 445);
    for (std::int64_t tick = 445; tick < 500; ++tick) EXPECT_EQ(client.shown(tick), spared.shown(tick));
  }
}

}  // namespace
}  // namespace tactus
