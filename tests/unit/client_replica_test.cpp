// SPDX-License-Identifier: Apache-2.0
/// What a client shows.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <span>
#include <string_view>
#include <vector>

#include "tests/unit/replica_fixture.h"

namespace tactus {
namespace {

using testing::along;
using testing::Arrival;
using testing::Feeder;
using testing::NumberedFeeder;
using testing::scene_of;

// ==== client replica ====

TEST(ClientReplica, WithoutInterpolationUpdatesJump) {
  Feeder f(Interpolation::none);
  f.update(0, {0, 0, 0}, {0.1, 0, 0});
  EXPECT_NEAR(f.shown(100).position.x, 0.01, 1e-6);
  f.update(100, {0.05, 0, 0}, {});
  EXPECT_NEAR(f.shown(100).position.x, 0.05, 1e-6);
}

TEST(ClientReplica, TimesBeforeTheNewestUpdateCountAsThatUpdate) {
  Feeder f(Interpolation::none);
  f.update(960, {}, {0.1, 0, 0}, {}, {0, 1, 0});
  f.update(1000, {0.03, 0, 0}, {0.5, 0, 0}, {}, {0, 1, 0});
  const Pose first = f.shown(1000);
  for (const std::int64_t tick : {std::int64_t{999}, std::int64_t{-1}, std::numeric_limits<std::int64_t>::min()}) {
    EXPECT_EQ(f.shown(tick).position.x, first.position.x) << tick;
    EXPECT_EQ(f.shown(tick).rotation.y, first.rotation.y) << tick;
  }
  EXPECT_EQ(Feeder(Interpolation::none).shown(std::numeric_limits<std::int64_t>::min()).position.x, 0);
}

TEST(ClientReplica, AnUpdateIsNotAppliedBeforeItsTickNorBeforeTheLastOne) {
  Feeder f(Interpolation::none);
  f.update_at(-7, 40, {}, {0.5, 0, 0});
  EXPECT_NEAR(f.shown(0).position.x, 0, 1e-6) << "as if it had come at its own tick";
  EXPECT_NEAR(f.shown(60).position.x, 0.01, 1e-6);
  f.update_at(100, 80, {0.03, 0, 0}, {0.5, 0, 0});
  f.update_at(99, 90, {0.1, 0, 0}, {0.5, 0, 0});
  EXPECT_NEAR(f.shown(95).position.x, 0.105, 1e-6) << "from 100, when the last one came";
}

TEST(ClientReplica, AnObjectIsNotHeldUpByAnotherOfTheSamePacket) {
  const SharedScene scene = scene_of(2);
  Replica replica(*scene, {}, {});
  const RigidPredictor predictor(*scene);
  const auto state = [&](std::int64_t tick) { return to_grid({{{0.1, 0, 0}, {}}, {1, 0, 0}, {}}, tick, scene->grid).value(); };
  const RigidUpdate named[] = {{0, Reason::visual, 0}, {1, Reason::visual, 0}};
  DecodedPacket packet;
  packet.tick = 80;
  packet.updates = std::span(named).first(1);
  std::vector<RigidState> states{state(80), state(0)};
  replica.apply(packet, {80, PagedArray<RigidState>(2, 1, [&](std::size_t i) { return states[i]; })}, 100);
  packet.updates = named;
  states[1] = state(80);
  replica.apply(packet, {80, PagedArray<RigidState>(2, 1, [&](std::size_t i) { return states[i]; })}, 90);
  EXPECT_EQ(replica.pose(1, 95), predictor.pose(states[1], 95));
  EXPECT_EQ(replica.pose(0, 95), predictor.pose(states[0], 100)) << "this one was there at 100 already";
}

TEST(ClientReplica, OptionsOutsideTheirRangeAreRefused) {
  const auto rule = [](const ReplicaOptions& options) {
    const auto receiver = Receiver::create(scene_of(1), {.replica = options, .limits = {}});
    EXPECT_EQ(receiver.has_value(), Replica::check(options, *scene_of(1)).has_value());
    return receiver ? std::string_view() : std::string_view(receiver.error().rule);
  };
  EXPECT_EQ(rule({Interpolation::none, 0, 0.005, 0.1}), "R-API-4");
  EXPECT_EQ(rule({Interpolation::playout, 0.75, 0.2, 0.1}), "R-API-4");
  EXPECT_EQ(rule({}), "");
  EXPECT_EQ(rule({Interpolation::playout, 0.75, 0.005, 0.1}), "");
}

TEST(ClientPlayout, InterpolatesOverKnownGapsOnly) {
  NumberedFeeder client;
  for (const Arrival& a : {Arrival{1, 400}, {2, 440}, {4, 500}, {6, 900}}) client.take(a);
  EXPECT_EQ(client.shown(420), client.reckoned(400, 420)) << "nothing is missing";
  EXPECT_EQ(client.shown(440), client.reckoned(440, 440));
  EXPECT_EQ(client.shown(470), client.interpolated(440, 500, 470)) << "packet 3 is missing";
  EXPECT_EQ(client.shown(600), client.reckoned(500, 600)) << "packet 5 is missing, for longer than 300 ms";
  EXPECT_EQ(client.shown(950), client.reckoned(900, 950)) << "the future is not known";
  client.take({3, 441});
  EXPECT_EQ(client.shown(470), client.reckoned(441, 470)) << "it was only reordered";
}

TEST(ClientPlayout, BeforeTheFirstUpdateTheInitialStateIsShown) {
  NumberedFeeder client;
  EXPECT_EQ(client.shown(-100), RigidPose{});
  client.take({70000, 40});
  for (const std::int64_t tick : {-1, 0, 39}) EXPECT_EQ(client.shown(tick), RigidPose{}) << "no curve comes from there";
  EXPECT_EQ(client.shown(40), client.reckoned(40, 40));
}

TEST(ClientPlayout, OrderOfArrivalDoesNotMatter) {
  std::vector<Arrival> arrivals;
  for (std::uint64_t n = 1; n < 50; ++n)
    if (n % 7 != 0) arrivals.push_back({n, static_cast<std::int64_t>(20 * n)});
  NumberedFeeder in_order;
  for (const Arrival& a : arrivals) in_order.take(a);
  std::mt19937_64 random(2);
  std::shuffle(arrivals.begin(), arrivals.end(), random);
  NumberedFeeder shuffled;
  for (const Arrival& a : arrivals) shuffled.take(a);
  for (std::int64_t tick = 0; tick < 1000; ++tick) EXPECT_EQ(in_order.shown(tick), shuffled.shown(tick)) << tick;
}

TEST(ClientReplicaOrder, AReorderedUpdateIsNotShown) {
  NumberedFeeder client(Interpolation::none), spared(Interpolation::none);
  for (NumberedFeeder* both : {&client, &spared}) {
    both->take({1, 400}, 400);
    both->take({3, 440}, 440);
  }
  client.take({2, 420}, 445);
  for (std::int64_t tick = 445; tick < 500; ++tick) EXPECT_EQ(client.shown(tick), spared.shown(tick));
}

// ==== client gap interpolation ====

double distance(const RigidPose& a, const RigidPose& b) {
  const unsigned exponent = scene_of(1)->grid.position;
  return norm(to_pose(a, exponent).position - to_pose(b, exponent).position);
}
double angle(const RigidPose& a, const RigidPose& b) { return angle_between(to_pose(a, 22).rotation, to_pose(b, 22).rotation); }

TEST(GapInterpolation, MeetsBothUpdatesAndTheMotionBetween) {
  const SharedScene scene = scene_of(1);
  const RigidPredictor predictor(*scene);
  for (const std::int64_t length : {20, 60, 300}) {
    const RigidState a = along(400, true), b = along(400 + length, true);
    const RigidPose first = interpolate_gap(*scene, a, b, 400), last = interpolate_gap(*scene, a, b, 400 + length - 1);
    EXPECT_EQ(first, (RigidPose{a.position, a.rotation}));
    EXPECT_LT(distance(last, {b.position, b.rotation}), 2e-3);
    double worst = 0, turned = 0, reckoned = 0;
    for (std::int64_t tick = 400; tick < 400 + length; ++tick) {
      const RigidState truth = along(tick, true);
      const RigidPose shown = interpolate_gap(*scene, a, b, tick), at{truth.position, truth.rotation};
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

TEST(GapInterpolation, WithoutVelocitiesThePathIsStraight) {
  const SharedScene scene = scene_of(1);
  const RigidState a = along(400, false), b = along(500, false);
  const RigidPose from{a.position, a.rotation}, to{b.position, b.rotation};
  for (std::int64_t tick = 400; tick < 500; ++tick) {
    const double fraction = static_cast<double>(tick - 400) / 100;
    const RigidPose shown = interpolate_gap(*scene, a, b, tick);
    EXPECT_NEAR(distance(from, shown), fraction * distance(from, to), 1e-6);
    EXPECT_NEAR(angle(from, shown), fraction * angle(from, to), 1e-6);
  }
}

// ==== client timelines ====

struct NumberedState {
  std::uint64_t number = 0;
  RigidState state;
};

NumberedState update(std::int64_t tick, std::uint64_t number) {
  NumberedState out{number, {}};
  out.state.tick = tick;
  return out;
}

TEST(Timelines, BeginWithTheInitialStates) {
  SceneSpec spec = testing::spec_of(2);
  spec.objects[1].initial.position = {1, 2, 3};
  Timelines timelines(2);
  timelines.reset(*testing::shared(spec));
  for (const std::int64_t tick : {-5, 0, 1000}) {
    const auto [before, after] = timelines.around(1, tick);
    EXPECT_EQ(timelines[before].state.position, (std::array<std::int32_t, 3>{1, 2, 3}));
    EXPECT_EQ(timelines[before].number, 0u);
    EXPECT_EQ(after, Timelines::kNone);
  }
}

TEST(Timelines, OrderOfArrivalDoesNotMatter) {
  std::vector<NumberedState> updates{update(0, 0)};
  for (std::uint64_t i = 1; i <= 200; ++i) updates.push_back(update(static_cast<std::int64_t>(i / 3 * 7), i));
  std::mt19937_64 random(1);
  for (int round = 0; round < 20; ++round) {
    Timelines timelines(1);
    timelines.reset(*testing::scene_of(1));
    std::vector<NumberedState> shuffled(updates.begin() + 1, updates.end());
    std::shuffle(shuffled.begin(), shuffled.end(), random);
    for (const NumberedState& u : shuffled) timelines.add(0, u.number, u.state);
    ASSERT_EQ(timelines.size(0), updates.size());
    for (std::int64_t tick = -1; tick < 480; ++tick) {
      const auto after = std::ranges::find_if(updates, [&](const auto& u) { return u.state.tick > tick; });
      const auto [before, next] = timelines.around(0, tick);
      EXPECT_EQ(timelines[before].number, after == updates.begin() ? 0 : (after - 1)->number) << tick;
      const auto following = after == updates.begin() ? after + 1 : after;  // before all: the first is shown, at its own tick
      EXPECT_EQ(next == Timelines::kNone ? 0 : timelines[next].number, following == updates.end() ? 0 : following->number)
          << tick;
    }
  }
}

/// One moves in every tick, 99 are updated once: what is older than the time kept goes, but the last before it.
TEST(Timelines, KeepATimeOfWhatMovesAndOneStateOfWhatRests) {
  Timelines timelines(100);
  timelines.reset(*testing::scene_of(100));
  timelines.keep(400);
  std::uint64_t number = 0;
  for (std::uint32_t i = 1; i < 100; ++i)
    for (std::int64_t tick = 1; tick <= 3; ++tick) timelines.add(i, ++number, update(tick, 0).state);
  for (std::int64_t tick = 4; tick <= 2000; ++tick) timelines.add(0, ++number, update(tick, 0).state);
  EXPECT_EQ(timelines.size(0), 401u);
  EXPECT_EQ(timelines[timelines.around(0, 1600).before].state.tick, 1600);
  EXPECT_EQ(timelines[timelines.around(0, 1599).before].state.tick, 1600);  // it is the first now
  for (std::uint32_t i = 1; i < 100; ++i) {
    EXPECT_EQ(timelines.size(i), 1u) << i;
    EXPECT_EQ(timelines[timelines.around(i, 2000).before].state.tick, 3) << i;
  }
}

/// More updates than there is room for: all objects forget what is oldest, and each keeps its newest.
TEST(Timelines, AreBounded) {
  constexpr std::uint32_t kObjects = 40;  // room for 40 + 5120 updates
  Timelines timelines(kObjects);
  timelines.reset(*testing::scene_of(kObjects));
  std::uint64_t number = 0;
  for (std::int64_t tick = 1; tick <= 1000; ++tick)
    for (std::uint32_t i = 0; i < kObjects; ++i) timelines.add(i, ++number, update(tick, 0).state);
  std::size_t all = 0;
  for (std::uint32_t i = 0; i < kObjects; ++i) {
    all += timelines.size(i);
    EXPECT_GE(timelines.size(i), 60u) << i;
    EXPECT_EQ(timelines[timelines.around(i, 5000).before].state.tick, 1000) << i;
    EXPECT_EQ(timelines[timelines.around(i, 950).before].state.tick, 950) << i;
  }
  EXPECT_LE(all, 5160u);
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
  EXPECT_TRUE(heard.all_between(72500, 72999)) << "a reordered packet";
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

}  // namespace
}  // namespace tactus
