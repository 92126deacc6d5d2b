// SPDX-License-Identifier: Apache-2.0
/// Curves, and the paths on which a client smooths errors of updates.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include <tactus/base/fixed.h>
#include <tactus/client/replica.h>
#include <tactus/rigid/curve.h>
#include <tactus/rigid/rigid_states.h>
#include <tactus/tactus.h>
#include "tests/unit/rigid_fixture.h"

namespace tactus {
namespace {

using testing::only;
using testing::scene_of;

// ==== rigid curve ====

TEST(PoseOffsets, ChangesSaturateAsExactArithmeticWould) {
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

TEST(PoseOffsets, AnOffsetLeadsFromOnePoseToTheOther) {
  const SharedScene scene = scene_of(1);
  const RigidState a = to_grid({{{0.1, -0.2, 0.3}, {std::cos(0.3), std::sin(0.3), 0, 0}}, {}, {}}, 0, scene->grid).value();
  const RigidState b = to_grid({{{-0.4, 0.2, 0}, {std::cos(1.1), 0, -std::sin(1.1), 0}}, {}, {}}, 0, scene->grid).value();
  const RigidPose from{a.position, a.rotation}, to{b.position, b.rotation};
  const RigidPose there = displaced(from, offset_between(from, to), {}, {kOne30, kOne30, 0});
  EXPECT_EQ(there.position, to.position);
  EXPECT_LT(angle_between(to_pose(there, 22).rotation, to_pose(to, 22).rotation), 1e-7);
  EXPECT_EQ(displaced(from, offset_between(from, to), {}, {}), from);
}

// ==== smoothing ====

SharedScene smoothed_scene(std::uint8_t span = 1) {
  SceneSpec spec = testing::spec_of(1);
  spec.is_smoothed = true;
  spec.baseline_span = span;
  return testing::shared(spec);
}

RigidState update_at(std::int64_t tick, std::int32_t x, std::uint8_t smoothing_exp, std::uint8_t retained = 0) {
  return {.tick = tick, .position = {x, 0, 0}, .smoothing_exp = smoothing_exp, .retained = retained};
}

TEST(Smoothing, OffsetShrinksInAStraightLine) {
  const SharedScene scene = smoothed_scene();
  const RigidPredictor predictor(*scene);
  SmoothedPath path;
  path.follow(predictor, update_at(10, 1600, 4));
  for (std::int64_t t = 0; t <= 40; ++t)
    EXPECT_EQ(path.pose(predictor, 10 + t).position[0], 1600 - 100 * std::max<std::int64_t>(16 - t, 0)) << t;
}

TEST(Smoothing, KeepsTheSixteenthsThatAreSignalled) {
  const SharedScene scene = smoothed_scene();
  const RigidPredictor predictor(*scene);
  for (const auto& [retained, left] : {std::pair{0, 1600}, {1, 1500}, {2, 1200}, {3, 800}}) {
    SmoothedPath path;
    path.follow(predictor, update_at(10, 1600, 4, static_cast<std::uint8_t>(retained)));
    EXPECT_EQ(path.pose(predictor, 10).position[0], 1600 - left) << retained;
  }
}

TEST(Smoothing, WithoutSmoothingTheUpdateIsShownAtOnce) {
  const SharedScene scene = smoothed_scene();
  const RigidPredictor predictor(*scene);
  SmoothedPath path;
  path.follow(predictor, update_at(10, 1600, 4));
  path.follow(predictor, update_at(12, 500, 0));
  EXPECT_EQ(path.pose(predictor, 12).position[0], 500);
}

/// Rotations by every angle up to half a circle: half of the time leaves half of the angle.
TEST(Smoothing, RotationsShrinkByTheirAngle) {
  const SharedScene scene = smoothed_scene();
  const RigidPredictor predictor(*scene);
  for (double angle = 0.01; angle < 3.1; angle += 0.1) {
    RigidState turned = update_at(5, 0, 6);
    const double s = std::sin(angle / 2);
    turned.rotation = {static_cast<std::int32_t>(std::lround(1073741823.0 * std::cos(angle / 2))), 0,
                       static_cast<std::int32_t>(std::lround(1073741823.0 * s)), 0};
    SmoothedPath path;
    path.follow(predictor, turned);
    const auto angle_at = [&](std::int64_t tick) {
      return angle_between(to_pose(path.pose(predictor, tick), 22).rotation, to_pose({{}, turned.rotation}, 22).rotation);
    };
    EXPECT_NEAR(angle_at(5), angle, 2e-4) << angle;
    EXPECT_NEAR(angle_at(5 + 32), angle / 2, 2e-4) << angle;
    EXPECT_NEAR(angle_at(5 + 64), 0, 1e-9) << angle;
  }
}

/// Eventful motion: what is shown keeps the bounds at every tick and does not jump where it would without smoothing.
TEST(Smoothing, BoundsHoldMeanwhileAndStepsAreSmall) {
  RigidTriggers triggers{.visual_position = 0.001, .visual_rotation = 0.02, .haptic = HapticRule::off};
  const auto worst_step = [&](bool is_smoothed, int& packets, std::vector<double>& steps) {
    SceneSpec spec = testing::spec_of(1);
    spec.is_smoothed = is_smoothed;
    const SharedScene scene = testing::shared(spec);
    auto sender = Sender::create(scene, {.triggers = triggers}).value();
    auto receiver = Receiver::create(scene).value();
    testing::Motion motion(5);
    Vec3 before;
    for (std::int64_t tick = 0; tick < 20000; ++tick) {
      const RigidSample truth = motion.step(1e-3);
      const Packet packet = only(sender.encode(tick, {.objects = {&truth, 1}}));
      if (!packet.bytes.empty()) {
        ++packets;
        ASSERT_TRUE(receiver.push(packet.number, packet.bytes));
      }
      const Pose shown = to_pose(receiver.replica().pose(0, tick), scene->grid.position);
      ASSERT_LE(norm(shown.position - truth.pose.position), triggers.visual_position) << tick;
      ASSERT_LE(angle_between(shown.rotation, truth.pose.rotation), triggers.visual_rotation) << tick;
      const Vec3 error = shown.position - truth.pose.position;
      if (!packet.bytes.empty()) steps.push_back(norm(error - before));
      before = error;
    }
  };
  int plain = 0, smoothed = 0;
  std::vector<double> jumps, steps;
  worst_step(false, plain, jumps);
  worst_step(true, smoothed, steps);
  ASSERT_GT(plain, 200);
  EXPECT_LT(smoothed, 1.1 * plain);
  const auto median = [](std::vector<double>& of) {
    std::nth_element(of.begin(), of.begin() + static_cast<std::ptrdiff_t>(of.size() / 2), of.end());
    return of[of.size() / 2];
  };
  EXPECT_LT(median(steps), 0.25 * median(jumps));
}

/// The same updates, none of which is smoothed: in a smoothed scene each of them says so.
TEST(Smoothing, ASceneThatIsNotSmoothedHasNoBitOfIt) {
  const auto bytes_of = [](const SharedScene& scene) {
    const RigidTriggers triggers{.reduction = Reduction::none, .visual_position = 0.001, .haptic = HapticRule::off};
    auto sender = Sender::create(scene, {.triggers = triggers}).value();
    testing::Motion motion(6);
    std::size_t bytes = 0;
    for (std::int64_t tick = 0; tick < 3000; ++tick) {
      const RigidSample truth = motion.step(1e-3);
      bytes += only(sender.encode(tick, {.objects = {&truth, 1}})).bytes.size();
    }
    return bytes;
  };
  EXPECT_LT(bytes_of(testing::scene_of(1)), bytes_of(smoothed_scene()));
}

/// Who begins at a key packet has shown nothing before it.
TEST(Smoothing, KeyPacketsAreNotSmoothed) {
  const RigidTriggers triggers{.visual_position = 0.001, .haptic = HapticRule::off};
  SenderOptions options{.triggers = triggers};
  options.policy.key_interval = 0.2;
  auto sender = Sender::create(smoothed_scene(), options).value();
  testing::Motion motion(6);
  auto receiver = Receiver::create(smoothed_scene()).value();
  std::size_t keys = 0, smoothed = 0;
  for (std::int64_t tick = 0; tick < 9000; ++tick) {
    const RigidSample truth = motion.step(1e-3);
    const Packet packet = only(sender.encode(tick, {.objects = {&truth, 1}}));
    if (packet.bytes.empty()) continue;
    ASSERT_TRUE(receiver.push(packet.number, packet.bytes));
    smoothed += receiver.object(0).smoothing_exp > 0;
    if (!packet.key) continue;
    ++keys;
    auto late = Receiver::create(smoothed_scene()).value();
    ASSERT_TRUE(late.push(packet.number, packet.bytes));
    ASSERT_EQ(late.object(0).smoothing_exp, 0);
    const RigidPose shown = late.replica().pose(0, tick);
    ASSERT_EQ(shown.position, late.object(0).position);
  }
  EXPECT_GT(keys, 20U);
  EXPECT_GT(smoothed, 20U);
}

/// All packets build on the first one, so that they can be decoded in any order.
TEST(Smoothing, PlayoutShowsThePathWhateverTheOrderOfArrival) {
  const SharedScene scene = smoothed_scene(64);
  const RigidTriggers triggers{.visual_position = 0.0005, .haptic = HapticRule::off};
  auto sender =
      Sender::create(scene, {.triggers = triggers, .policy = {.key_interval = 0, .baseline = Baseline::acknowledged}}).value();
  auto direct = Receiver::create(scene).value();
  testing::Motion motion(8);
  std::vector<RigidPose> shown;
  std::vector<std::pair<std::uint64_t, std::vector<std::uint8_t>>> packets;  // and their numbers
  for (std::int64_t tick = 0; packets.size() < 60; ++tick) {
    const RigidSample truth = motion.step(1e-3);
    const Packet packet = only(sender.encode(tick, {.objects = {&truth, 1}}));
    if (!packet.bytes.empty()) {
      ASSERT_TRUE(direct.push(packet.number, packet.bytes));
      if (packets.empty()) sender.acknowledge(0, packet.number);
      packets.emplace_back(packet.number, std::vector<std::uint8_t>(packet.bytes.begin(), packet.bytes.end()));
    }
    shown.push_back(direct.replica().pose(0, tick));
  }
  std::mt19937_64 random(3);
  for (int round = 0; round < 10; ++round) {
    std::shuffle(packets.begin() + 1, packets.end(), random);
    auto late = Receiver::create(scene, {.replica = {.interpolation = Interpolation::playout}, .limits = {}}).value();
    for (const auto& [number, bytes] : packets) ASSERT_TRUE(late.push(number, bytes)) << round;
    for (std::size_t tick = 0; tick < shown.size(); ++tick)
      ASSERT_EQ(late.replica().pose(0, static_cast<std::int64_t>(tick)), shown[tick]) << round << " tick " << tick;
  }
}

}  // namespace
}  // namespace tactus
