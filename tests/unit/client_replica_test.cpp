// SPDX-License-Identifier: Apache-2.0
#include <tactus/client/replica.h>

#include <gtest/gtest.h>

#include <limits>
#include <string_view>

#include "tests/unit/rigid_fixture.h"

namespace tactus {
namespace {

using testing::scene_of;

/// Hands a replica updates of one object without a bitstream.
class Feeder {
 public:
  explicit Feeder(Interpolation mode) : scene_(scene_of(1)), replica_(*scene_, {.interpolation = mode}, {}) {}

  void update(std::int64_t tick, const Vec3& position, const Vec3& velocity, const Quat& rotation = {},
              const Vec3& angular_velocity = {}) {
    update_at(tick, tick, position, velocity, rotation, angular_velocity);
  }
  /// A packet of tick `tick`, applied at `now`.
  void update_at(std::int64_t now, std::int64_t tick, const Vec3& position, const Vec3& velocity, const Quat& rotation = {},
                 const Vec3& angular_velocity = {}) {
    const RigidState state = to_grid({{position, rotation}, velocity, angular_velocity}, tick, scene_->grid).value();
    const RigidUpdate named{0, Reason::visual, 0};
    DecodedPacket packet;
    packet.tick = tick;
    packet.updates = {&named, 1};
    replica_.apply(packet, {&state, 1}, now);
  }
  Pose shown(std::int64_t tick) const { return to_pose(replica_.pose(0, tick), scene_->grid.position); }

 private:
  SharedScene scene_;
  Replica replica_;
};

TEST(ClientReplica, WithoutInterpolationUpdatesJump) {
  Feeder f(Interpolation::none);
  f.update(0, {0, 0, 0}, {0.1, 0, 0});
  EXPECT_NEAR(f.shown(100).position.x, 0.01, 1e-6);
  f.update(100, {0.05, 0, 0}, {});
  EXPECT_NEAR(f.shown(100).position.x, 0.05, 1e-6);
}

TEST(ClientReplica, LinearInterpolationReachesThePredictedPlaceAfterTN) {
  Feeder f(Interpolation::linear);
  f.update(0, {}, {});
  f.update(40, {}, {});                     // no interpolation before a gap is known; afterwards the gap is 40
  f.update(80, {0.03, 0, 0}, {0.5, 0, 0});  // t_N = 0.75 * 40 = 30 ticks
  EXPECT_NEAR(f.shown(80).position.x, 0, 1e-6) << "thesis eq. 3.6 starts where the object was shown";
  EXPECT_NEAR(f.shown(95).position.x, 0.5 * (0.03 + 0.5 * 0.03), 1e-6) << "half way to the place predicted for its end";
  EXPECT_NEAR(f.shown(110).position.x, 0.03 + 0.5 * 0.03, 1e-6);
  EXPECT_NEAR(f.shown(150).position.x, 0.03 + 0.5 * 0.07, 1e-6) << "then dead reckoning";
}

TEST(ClientReplica, AnUpdateDuringAnInterpolationIsAppliedAtOnce) {
  Feeder f(Interpolation::linear);
  f.update(0, {}, {});
  f.update(40, {}, {});
  f.update(80, {0.03, 0, 0}, {});
  f.update(90, {0.06, 0, 0}, {});
  EXPECT_NEAR(f.shown(90).position.x, 0.06, 1e-6);
  EXPECT_NEAR(f.shown(95).position.x, 0.06, 1e-6);
}

TEST(ClientReplica, TheIntervalIsClippedAndAveragesFiveGaps) {
  const auto arrives = [](const std::vector<std::int64_t>& gaps) {
    Feeder f(Interpolation::linear);
    std::int64_t tick = 0;
    f.update(tick, {}, {});
    for (const auto gap : gaps) f.update(tick += gap, {}, {});
    const std::int64_t start = tick + gaps.back();
    f.update(start, {0.1, 0, 0}, {});
    std::int64_t end = start;
    while (f.shown(end).position.x < 0.1 - 1e-6) ++end;
    return end - start;
  };
  EXPECT_EQ(arrives({1000}), 100) << "longest";
  EXPECT_EQ(arrives({2, 2}), 5) << "shortest";
  EXPECT_EQ(arrives({40}), 30);
  EXPECT_EQ(arrives({400, 400, 20, 20, 20, 20, 20}), 15) << "gaps older than five do not count";
}

TEST(ClientReplica, TimesBeforeTheNewestUpdateCountAsThatUpdate) {
  constexpr std::int64_t kLongAgo = std::numeric_limits<std::int64_t>::min();
  for (const Interpolation mode : {Interpolation::none, Interpolation::linear}) {
    Feeder f(mode);
    f.update(960, {}, {0.1, 0, 0}, {}, {0, 1, 0});
    f.update(1000, {0.03, 0, 0}, {0.5, 0, 0}, {}, {0, 1, 0});
    f.update(1040, {0.1, 0, 0}, {0.5, 0, 0}, {}, {0, 1, 0});
    const Pose first = f.shown(1040);
    for (const std::int64_t tick : {std::int64_t{1039}, std::int64_t{999}, std::int64_t{-1}, kLongAgo}) {
      EXPECT_EQ(f.shown(tick).position.x, first.position.x) << tick;
      EXPECT_EQ(f.shown(tick).rotation.y, first.rotation.y) << tick;
    }
  }
  Feeder unheard(Interpolation::linear);
  EXPECT_EQ(unheard.shown(kLongAgo).position.x, 0);
}

TEST(ClientReplica, AnUpdateIsNotAppliedBeforeItsTickNorBeforeTheLastOne) {
  Feeder f(Interpolation::linear), late(Interpolation::linear);
  f.update(0, {}, {});
  f.update_at(-7, 40, {}, {});
  f.update_at(20, 80, {0.03, 0, 0}, {0.5, 0, 0});
  EXPECT_NEAR(f.shown(95).position.x, 0.5 * (0.03 + 0.5 * 0.03), 1e-6) << "as if each had come at its own tick";
  late.update_at(100, 40, {}, {});
  late.update_at(99, 80, {0.03, 0, 0}, {0.5, 0, 0});
  EXPECT_NEAR(late.shown(100).position.x, 0, 1e-6) << "a gap of 0 ticks, and so the shortest interpolation";
  EXPECT_NEAR(late.shown(105).position.x, 0.03 + 0.5 * 0.025, 1e-6);
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
  replica.apply(packet, states, 100);
  packet.updates = named;
  states[1] = state(80);
  replica.apply(packet, states, 90);
  EXPECT_EQ(replica.pose(1, 95), predictor.pose(states[1], 95));
  EXPECT_EQ(replica.pose(0, 95), predictor.pose(states[0], 100)) << "this one was there at 100 already";
}

TEST(ClientReplica, RotationTurnsAtConstantRate) {
  Feeder f(Interpolation::linear);
  f.update(0, {}, {});
  f.update(40, {}, {});
  const double angle = 2.5;
  f.update(80, {}, {}, {std::cos(angle / 2), 0, std::sin(angle / 2), 0});
  for (int i = 0; i <= 30; ++i) {
    const double expected = angle * i / 30;
    EXPECT_NEAR(angle_between(f.shown(80 + i).rotation, {std::cos(expected / 2), 0, std::sin(expected / 2), 0}), 0, 1e-5) << i;
  }
}

TEST(ClientReplica, RotationTakesTheShortWay) {
  Feeder f(Interpolation::linear);
  f.update(0, {}, {});
  f.update(40, {}, {});
  f.update(80, {}, {}, {-std::cos(0.1), 0, 0, -std::sin(0.1)});  // the same as a turn of 0.2 rad
  EXPECT_NEAR(angle_between(f.shown(95).rotation, {std::cos(0.05), 0, 0, std::sin(0.05)}), 0, 1e-5);
}

TEST(ClientReplica, OptionsOutsideTheirRangeAreRefused) {
  const auto refused = [](ReplicaOptions options) {
    const auto receiver = Receiver::create(scene_of(1), {.replica = options, .limits = {}});
    EXPECT_EQ(receiver.has_value(), Replica::check(options).has_value());
    return !receiver && std::string_view(receiver.error().rule) == "R-API-4";
  };
  EXPECT_TRUE(refused({Interpolation::linear, 0, 0.005, 0.1}));
  EXPECT_TRUE(refused({Interpolation::linear, 1.5, 0.005, 0.1}));
  EXPECT_TRUE(refused({Interpolation::linear, std::nan(""), 0.005, 0.1}));
  EXPECT_TRUE(refused({Interpolation::linear, 0.75, 0.2, 0.1}));
  EXPECT_TRUE(refused({Interpolation::linear, 0.75, 0.005, 10.1}));
  EXPECT_FALSE(refused({}));
}

}  // namespace
}  // namespace tactus
