// SPDX-License-Identifier: Apache-2.0
/// Interpolations of a client with component thesis: linear, hermite and blending.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <tactus/client/replica.h>
#include <tactus/player.h>
#include <tactus/thesis/thesis.h>
#include "tests/unit/replica_fixture.h"

namespace tactus {
namespace {

using testing::Feeder;
using testing::kWithThesis;
using testing::NumberedFeeder;
using testing::scene_of;

constexpr Interpolation kAll[] = {Interpolation::linear, Interpolation::hermite, Interpolation::blending};

/// R-API-16. A scene that was made with the component brings it to its receivers.
TEST(ThesisInterpolation, IsUnsupportedWithoutTheComponent) {
  const SharedScene scene = scene_of(1), with = testing::shared(testing::spec_of(1), kWithThesis);
  for (const Interpolation mode : kAll) {
    const ReceiverOptions options{.replica = {.interpolation = mode}, .limits = {}};
    const auto receiver = Receiver::create(scene, options);
    ASSERT_FALSE(receiver);
    EXPECT_EQ(receiver.error().code, Errc::unsupported);
    EXPECT_STREQ(receiver.error().rule, "R-API-16");
    const auto checked = Replica::check(options.replica, *scene);
    ASSERT_FALSE(checked);
    EXPECT_EQ(checked.error().code, Errc::unsupported);
    EXPECT_STREQ(checked.error().rule, "R-API-16");
    EXPECT_TRUE(Replica::check(options.replica, *scene, &thesis_component));
    EXPECT_TRUE(Receiver::create(scene, {.replica = options.replica, .limits = kWithThesis}));
    EXPECT_TRUE(Receiver::create(with, options));
    const auto bytes = write_scene(*scene).value();
    const auto player = Player::open(bytes, options);
    ASSERT_FALSE(player);
    EXPECT_STREQ(player.error().rule, "R-API-16");
    EXPECT_TRUE(Player::open(bytes, {.replica = options.replica, .limits = kWithThesis}));
  }
  for (const Interpolation mode : {Interpolation::none, Interpolation::playout})
    EXPECT_TRUE(Receiver::create(scene, {.replica = {.interpolation = mode}, .limits = {}}));
}

TEST(ThesisInterpolation, ASmoothedSceneIsRefused) {
  SceneSpec spec = testing::spec_of(1);
  spec.is_smoothed = true;
  const SharedScene scene = testing::shared(std::move(spec));
  for (const Interpolation mode : kAll) {
    const auto receiver = Receiver::create(scene, {.replica = {.interpolation = mode}, .limits = kWithThesis});
    ASSERT_FALSE(receiver);
    EXPECT_EQ(receiver.error().code, Errc::invalid_argument);
    EXPECT_STREQ(receiver.error().rule, "R-API-4");
  }
}

TEST(ThesisInterpolation, LinearInterpolationReachesThePredictedPositionAfterTN) {
  Feeder f(Interpolation::linear, &thesis_component);
  f.update(0, {}, {});
  f.update(40, {}, {});                     // no interpolation before a gap is known; afterwards the gap is 40
  f.update(80, {0.03, 0, 0}, {0.5, 0, 0});  // t_N = 0.75 * 40 = 30 ticks
  EXPECT_NEAR(f.shown(80).position.x, 0, 1e-6) << "thesis eq. 3.6 starts where the object was shown";
  EXPECT_NEAR(f.shown(95).position.x, 0.5 * (0.03 + 0.5 * 0.03), 1e-6) << "halfway to the position predicted for its end";
  EXPECT_NEAR(f.shown(110).position.x, 0.03 + 0.5 * 0.03, 1e-6);
  EXPECT_NEAR(f.shown(150).position.x, 0.03 + 0.5 * 0.07, 1e-6) << "then dead reckoning";
}

TEST(ThesisInterpolation, AnUpdateDuringAnInterpolationIsAppliedAtOnce) {
  for (const Interpolation mode : kAll) {
    Feeder f(mode, &thesis_component);
    f.update(0, {}, {});
    f.update(40, {}, {});
    f.update(80, {0.03, 0, 0}, {});
    f.update(90, {0.06, 0, 0}, {});
    EXPECT_NEAR(f.shown(90).position.x, 0.06, 1e-6);
    EXPECT_NEAR(f.shown(95).position.x, 0.06, 1e-6);
  }
}

TEST(ThesisInterpolation, TheIntervalIsClippedAndAveragesFiveGaps) {
  const auto arrives = [](const std::vector<std::int64_t>& gaps) {
    Feeder f(Interpolation::linear, &thesis_component);
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

TEST(ThesisInterpolation, TimesBeforeTheNewestUpdateCountAsThatUpdate) {
  constexpr std::int64_t kLongAgo = std::numeric_limits<std::int64_t>::min();
  for (const Interpolation mode : kAll) {
    Feeder f(mode, &thesis_component);
    f.update(960, {}, {0.1, 0, 0}, {}, {0, 1, 0});
    f.update(1000, {0.03, 0, 0}, {0.5, 0, 0}, {}, {0, 1, 0});
    f.update(1040, {0.1, 0, 0}, {0.5, 0, 0}, {}, {0, 1, 0});
    const Pose first = f.shown(1040);
    for (const std::int64_t tick : {std::int64_t{1039}, std::int64_t{999}, std::int64_t{-1}, kLongAgo}) {
      EXPECT_EQ(f.shown(tick).position.x, first.position.x) << tick;
      EXPECT_EQ(f.shown(tick).rotation.y, first.rotation.y) << tick;
    }
  }
  Feeder unheard(Interpolation::linear, &thesis_component);
  EXPECT_EQ(unheard.shown(kLongAgo).position.x, 0);
}

TEST(ThesisInterpolation, AnUpdateIsNotAppliedBeforeItsTickNorBeforeTheLastOne) {
  Feeder f(Interpolation::linear, &thesis_component), late(Interpolation::linear, &thesis_component);
  f.update(0, {}, {});
  f.update_at(-7, 40, {}, {});
  f.update_at(20, 80, {0.03, 0, 0}, {0.5, 0, 0});
  EXPECT_NEAR(f.shown(95).position.x, 0.5 * (0.03 + 0.5 * 0.03), 1e-6) << "as if each had come at its own tick";
  late.update_at(100, 40, {}, {});
  late.update_at(99, 80, {0.03, 0, 0}, {0.5, 0, 0});
  EXPECT_NEAR(late.shown(100).position.x, 0, 1e-6) << "a gap of 0 ticks, and so the shortest interpolation";
  EXPECT_NEAR(late.shown(105).position.x, 0.03 + 0.5 * 0.025, 1e-6);
}

TEST(ThesisInterpolation, RotationTurnsAtConstantRate) {
  Feeder f(Interpolation::linear, &thesis_component);
  f.update(0, {}, {});
  f.update(40, {}, {});
  const double angle = 2.5;
  f.update(80, {}, {}, {std::cos(angle / 2), 0, std::sin(angle / 2), 0});
  for (int i = 0; i <= 30; ++i) {
    const double expected = angle * i / 30;
    EXPECT_NEAR(angle_between(f.shown(80 + i).rotation, {std::cos(expected / 2), 0, std::sin(expected / 2), 0}), 0, 1e-5) << i;
  }
}

TEST(ThesisInterpolation, RotationTakesTheShortWay) {
  Feeder f(Interpolation::linear, &thesis_component);
  f.update(0, {}, {});
  f.update(40, {}, {});
  f.update(80, {}, {}, {-std::cos(0.1), 0, 0, -std::sin(0.1)});  // the same as a turn of 0.2 rad
  EXPECT_NEAR(angle_between(f.shown(95).rotation, {std::cos(0.05), 0, 0, std::sin(0.05)}), 0, 1e-5);
}

TEST(ThesisInterpolation, OptionsOutsideTheirRangeAreRefused) {
  const auto refused = [](const ReplicaOptions& options) {
    const auto receiver = Receiver::create(scene_of(1), {.replica = options, .limits = kWithThesis});
    EXPECT_EQ(receiver.has_value(), Replica::check(options, *scene_of(1), &thesis_component).has_value());
    return !receiver && std::string_view(receiver.error().rule) == "R-API-4";
  };
  EXPECT_TRUE(refused({Interpolation::linear, 0, 0.005, 0.1}));
  EXPECT_TRUE(refused({Interpolation::linear, 1.5, 0.005, 0.1}));
  EXPECT_TRUE(refused({Interpolation::linear, std::nan(""), 0.005, 0.1}));
  EXPECT_TRUE(refused({Interpolation::linear, 0.75, 0.2, 0.1}));
  EXPECT_TRUE(refused({Interpolation::linear, 0.75, 0.005, 10.1}));
  EXPECT_FALSE(refused({Interpolation::linear, 0.75, 0.005, 0.1}));
}

TEST(ThesisInterpolation, AReorderedUpdateIsNotShown) {
  for (const Interpolation mode : kAll) {
    NumberedFeeder client(mode, &thesis_component), spared(mode, &thesis_component);
    for (NumberedFeeder* both : {&client, &spared}) {
      both->take({1, 400}, 400);
      both->take({3, 440}, 440);
    }
    client.take({2, 420}, 445);
    for (std::int64_t tick = 445; tick < 500; ++tick) EXPECT_EQ(client.shown(tick), spared.shown(tick));
  }
}

// ==== curves ====

constexpr std::int64_t kStart = 80, kTicks = 30;  // t_0 and t_N: three quarters of gaps of 40 ticks
constexpr double kTick = 1e-3;                    // [s]

/// A client of an interpolation, after two updates 40 ticks apart, and a third that finds the object elsewhere.
class Client {
 public:
  explicit Client(Interpolation interpolation, std::uint16_t max_extrapolation = 500) : scene_(scene(max_extrapolation)) {
    replica_.emplace(*scene_, ReplicaOptions{.interpolation = interpolation}, std::vector<DeformableDecoder*>{}, nullptr,
                     &thesis_component);
    take(before(0));
    take(before(40));
    take(after());
  }
  static RigidSample before(std::int64_t tick) {
    return {{{0.2 * kTick * static_cast<double>(tick), 0, 0}, {}}, {0.2, 0.1, 0}, {0, 0, 3}};
  }
  static RigidSample after() {
    return {{{0.03, -0.01, 0.002}, {std::cos(0.2), 0, 0, std::sin(0.2)}}, {-0.3, 0, 0.5}, {0, 0, -2}};
  }
  RigidPose grid(std::int64_t tick) const { return replica_->pose(0, tick); }
  Pose shown(std::int64_t tick) const { return to_pose(grid(tick), scene_->grid.position); }
  const Scene& scene() const { return *scene_; }

 private:
  static SharedScene scene(std::uint16_t max_extrapolation) {
    SceneSpec spec;
    spec.max_extrapolation = max_extrapolation;
    spec.objects.push_back({"o", Dof::all, {}});
    return Scene::create(std::move(spec)).value();
  }
  void take(const RigidSample& sample) {
    const RigidState state = to_grid(sample, tick_, scene_->grid).value();
    const RigidUpdate named{0, Reason::visual, 0};
    DecodedPacket packet;
    packet.tick = tick_;
    packet.number = ++number_;
    packet.updates = {&named, 1};
    replica_->apply(packet, {tick_, PagedArray<RigidState>(1, 1, [&](std::size_t) { return state; })}, tick_);
    tick_ += 40;
  }

  SharedScene scene_;
  std::optional<Replica> replica_;
  std::int64_t tick_ = 0;
  std::uint64_t number_ = 0;
};

/// x_o(t) of an equation of the thesis, from i, x_o^0, x_o^1, xdot_o^0 t_N and xdot_o^1 t_N.
using Equation = std::function<Vec3(double, const Vec3&, const Vec3&, const Vec3&, const Vec3&)>;

void follows(Interpolation interpolation, const Equation& equation) {
  const Client client(interpolation);
  const Vec3 x0 =
      to_pose(RigidPredictor(client.scene()).pose(to_grid(Client::before(40), 40, client.scene().grid).value(), kStart),
              client.scene().grid.position)
          .position;
  const RigidSample before = Client::before(40), after = Client::after();
  const double t_n = kTick * static_cast<double>(kTicks);
  for (std::int64_t tick = 0; tick < kTicks; ++tick) {
    const double i = static_cast<double>(tick) / static_cast<double>(kTicks);
    const Vec3 expected = equation(i, x0, after.pose.position, t_n * before.velocity, t_n * after.velocity);
    EXPECT_LT(norm(client.shown(kStart + tick).position - expected), 2e-6) << tick;
  }
  const Pose end = client.shown(kStart + kTicks);
  EXPECT_LT(norm(end.position - (after.pose.position + t_n * after.velocity)), 2e-6) << "then dead reckoning";
}

TEST(ThesisCurve, LinearIsEquation36) {
  follows(Interpolation::linear,
          [](double i, const Vec3& x0, const Vec3& x1, const Vec3&, const Vec3& v1) { return (1 - i) * x0 + i * x1 + i * v1; });
}

TEST(ThesisCurve, HermiteIsEquation37) {
  follows(Interpolation::hermite, [](double i, const Vec3& x0, const Vec3& x1, const Vec3& v0, const Vec3& v1) {
    const double i2 = i * i, i3 = i2 * i;
    return (2 * i3 - 3 * i2 + 1) * x0 + (3 * i2 - 2 * i3) * x1 + (i3 - 2 * i2 + i) * v0 + (2 * i2 - i3) * v1;
  });
}

TEST(ThesisCurve, BlendingIsEquation38) {
  follows(Interpolation::blending, [](double i, const Vec3& x0, const Vec3& x1, const Vec3& v0, const Vec3& v1) {
    const double i2 = i * i, i3 = i2 * i;
    return (1 - i) * x0 + i * x1 + (i3 - 2 * i2 + i) * v0 + (2 * i2 - i3) * v1;
  });
}

/// Angle about z.
double angle_of(const Pose& pose) { return 2 * std::atan2(pose.rotation.z, pose.rotation.w); }

TEST(ThesisCurve, OfOneAxisRotationsFollowTheSameEquations) {
  constexpr double kRounding =
      4.0 / 27 * 0x1p-13 + 1e-6;  // what the rates turn is a multiple of 2^-12 rad, of which cubics take 4/27 at most
  const double a0 = 0, a1 = 0.4, w0 = 3 * kTick * kTicks, w1 = -2 * kTick * kTicks;
  const double start = a0 + 3 * 40 * kTick;  // turned by dead reckoning from the second update to the third
  for (std::int64_t tick = 0; tick < kTicks; ++tick) {
    const double i = static_cast<double>(tick) / static_cast<double>(kTicks), i2 = i * i, i3 = i2 * i;
    const double of_rates = (i3 - 2 * i2 + i) * w0 + (2 * i2 - i3) * w1;
    EXPECT_NEAR(angle_of(Client(Interpolation::linear).shown(kStart + tick)), (1 - i) * start + i * a1 + i * w1, kRounding);
    EXPECT_NEAR(angle_of(Client(Interpolation::hermite).shown(kStart + tick)),
                (2 * i3 - 3 * i2 + 1) * start + (3 * i2 - 2 * i3) * a1 + of_rates, kRounding);
    EXPECT_NEAR(angle_of(Client(Interpolation::blending).shown(kStart + tick)), (1 - i) * start + i * a1 + of_rates, kRounding);
  }
}

TEST(ThesisCurve, OnlyHermiteKeepsTheVelocityAtBothEnds) {
  const auto jump = [](Interpolation interpolation, std::int64_t tick) {
    const Client client(interpolation);
    const auto velocity = [&](std::int64_t from) { return client.shown(from + 1).position - client.shown(from).position; };
    const Vec3 outside = kTick * (tick == kStart ? Client::before(40).velocity : Client::after().velocity);
    return norm(velocity(tick == kStart ? tick : tick - 1) - outside) / norm(outside);
  };
  for (const std::int64_t tick : {kStart, kStart + kTicks}) {
    EXPECT_LT(jump(Interpolation::hermite, tick), 0.5) << "what it changes within a tick";
    EXPECT_GT(jump(Interpolation::linear, tick), 1);
    EXPECT_GT(jump(Interpolation::blending, tick), 1);
  }
}

TEST(ThesisCurve, AnObjectThatHasStoppedHasNoOldVelocity) {
  const Client client(Interpolation::hermite, 40);
  const Vec3 first = client.shown(kStart + 1).position - client.shown(kStart).position;
  EXPECT_LT(norm(first), 0.5 * kTick * norm(Client::before(40).velocity)) << "dead reckoning ended 40 ticks after the update";
}

}  // namespace
}  // namespace tactus
