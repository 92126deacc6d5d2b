// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/curve.h>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <optional>

#include <tactus/base/fixed.h>
#include <tactus/client/replica.h>
#include "tests/unit/rigid_fixture.h"

namespace tactus {
namespace {

using testing::scene_of;

constexpr std::int64_t kStart = 80, kTicks = 30;  // t_0 and t_N: three quarters of gaps of 40 ticks
constexpr double kTick = 1e-3;                    // [s]

/// A client of a way, after two updates 40 ticks apart, and a third that finds the object elsewhere.
class Client {
 public:
  explicit Client(Interpolation way, std::uint16_t max_extrapolation = 500) : scene_(scene(max_extrapolation)) {
    replica_.emplace(*scene_, ReplicaOptions{.interpolation = way}, std::vector<DeformableDecoder*>{});
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
    replica_->apply(packet, {&state, 1}, tick_);
    tick_ += 40;
  }

  SharedScene scene_;
  std::optional<Replica> replica_;
  std::int64_t tick_ = 0;
  std::uint64_t number_ = 0;
};

/// x_o(t) of an equation of the thesis, from i, x_o^0, x_o^1, xdot_o^0 t_N and xdot_o^1 t_N.
using Equation = std::function<Vec3(double, const Vec3&, const Vec3&, const Vec3&, const Vec3&)>;

void follows(Interpolation way, const Equation& equation) {
  const Client client(way);
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

TEST(ClientCurve, LinearIsEquation36) {
  follows(Interpolation::linear,
          [](double i, const Vec3& x0, const Vec3& x1, const Vec3&, const Vec3& v1) { return (1 - i) * x0 + i * x1 + i * v1; });
}

TEST(ClientCurve, HermiteIsEquation37) {
  follows(Interpolation::hermite, [](double i, const Vec3& x0, const Vec3& x1, const Vec3& v0, const Vec3& v1) {
    const double i2 = i * i, i3 = i2 * i;
    return (2 * i3 - 3 * i2 + 1) * x0 + (3 * i2 - 2 * i3) * x1 + (i3 - 2 * i2 + i) * v0 + (2 * i2 - i3) * v1;
  });
}

TEST(ClientCurve, BlendingIsEquation38) {
  follows(Interpolation::blending, [](double i, const Vec3& x0, const Vec3& x1, const Vec3& v0, const Vec3& v1) {
    const double i2 = i * i, i3 = i2 * i;
    return (1 - i) * x0 + i * x1 + (i3 - 2 * i2 + i) * v0 + (2 * i2 - i3) * v1;
  });
}

/// Angle about z.
double angle_of(const Pose& pose) { return 2 * std::atan2(pose.rotation.z, pose.rotation.w); }

TEST(ClientCurve, OfOneAxisRotationsFollowTheSameEquations) {
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

TEST(ClientCurve, OnlyHermiteKeepsTheVelocityAtBothEnds) {
  const auto jump = [](Interpolation way, std::int64_t tick) {
    const Client client(way);
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

TEST(ClientCurve, AnObjectThatHasStoppedHasNoOldVelocity) {
  const Client client(Interpolation::hermite, 40);
  const Vec3 first = client.shown(kStart + 1).position - client.shown(kStart).position;
  EXPECT_LT(norm(first), 0.5 * kTick * norm(Client::before(40).velocity)) << "dead reckoning ended 40 ticks after the update";
}

TEST(ClientCurve, ChangesSaturateAsExactArithmeticWould) {
  SceneSpec spec;
  spec.tick_rate = 1;
  spec.grid = {22, 10, 20, 12};
  spec.objects.push_back({"o", Dof::all, {}});
  const SharedScene scene = Scene::create(std::move(spec)).value();
  constexpr std::int32_t kLargest = std::numeric_limits<std::int32_t>::max();
  const RigidMotion still, fast{{kLargest, -kLargest, 1}, {}};
  const PoseOffset change = change_between(*scene, still, fast, (1 << 24) - 1);
  EXPECT_EQ(change.position, (Vec3i{kLargest, std::numeric_limits<std::int32_t>::min(), kLargest}));
  EXPECT_EQ(change_between(*scene, still, {{5, -5, 0}, {}}, 3).position, (Vec3i{5 * 3 << 12, -5 * 3 * (1 << 12), 0}));
}

TEST(ClientCurve, AnOffsetLeadsFromOnePoseToTheOther) {
  const SharedScene scene = scene_of(1);
  const RigidState a = to_grid({{{0.1, -0.2, 0.3}, {std::cos(0.3), std::sin(0.3), 0, 0}}, {}, {}}, 0, scene->grid).value();
  const RigidState b = to_grid({{{-0.4, 0.2, 0}, {std::cos(1.1), 0, -std::sin(1.1), 0}}, {}, {}}, 0, scene->grid).value();
  const RigidPose from{a.position, a.rotation}, to{b.position, b.rotation};
  const RigidPose there = displaced(from, offset_between(from, to), {}, {kOne30, kOne30, 0});
  EXPECT_EQ(there.position, to.position);
  EXPECT_LT(angle_between(to_pose(there, 22).rotation, to_pose(to, 22).rotation), 1e-7);
  EXPECT_EQ(displaced(from, offset_between(from, to), {}, {}), from);
}

}  // namespace
}  // namespace tactus
