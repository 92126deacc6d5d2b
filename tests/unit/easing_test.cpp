// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/curve.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include <tactus/tactus.h>
#include "tests/unit/rigid_fixture.h"

namespace tactus {
namespace {

using testing::only;

SharedScene eased_scene(std::uint8_t span = 1) {
  SceneSpec spec = testing::spec_of(1);
  spec.is_eased = true;
  spec.baseline_span = span;
  return testing::shared(spec);
}

RigidState update_at(std::int64_t tick, std::int32_t x, std::uint8_t ease, std::uint8_t keep = 0) {
  return {.tick = tick, .position = {x, 0, 0}, .ease = ease, .keep = keep};
}

TEST(Easing, OffsetShrinksInAStraightLine) {
  const SharedScene scene = eased_scene();
  const RigidPredictor predictor(*scene);
  EasedPath path;
  path.follow(predictor, update_at(10, 1600, 4));
  for (std::int64_t t = 0; t <= 40; ++t)
    EXPECT_EQ(path.pose(predictor, 10 + t).position[0], 1600 - 100 * std::max<std::int64_t>(16 - t, 0)) << t;
}

TEST(Easing, KeepsTheSixteenthsThatAreTold) {
  const SharedScene scene = eased_scene();
  const RigidPredictor predictor(*scene);
  for (const auto& [keep, left] : {std::pair{0, 1600}, {1, 1500}, {2, 1200}, {3, 800}}) {
    EasedPath path;
    path.follow(predictor, update_at(10, 1600, 4, static_cast<std::uint8_t>(keep)));
    EXPECT_EQ(path.pose(predictor, 10).position[0], 1600 - left) << keep;
  }
}

TEST(Easing, WithoutEaseTheUpdateIsShownAtOnce) {
  const SharedScene scene = eased_scene();
  const RigidPredictor predictor(*scene);
  EasedPath path;
  path.follow(predictor, update_at(10, 1600, 4));
  path.follow(predictor, update_at(12, 500, 0));
  EXPECT_EQ(path.pose(predictor, 12).position[0], 500);
}

/// Rotations by every angle up to half a circle: half of the time leaves half of the angle.
TEST(Easing, RotationsShrinkByTheirAngle) {
  const SharedScene scene = eased_scene();
  const RigidPredictor predictor(*scene);
  for (double angle = 0.01; angle < 3.1; angle += 0.1) {
    RigidState turned = update_at(5, 0, 6);
    const double s = std::sin(angle / 2);
    turned.rotation = {static_cast<std::int32_t>(std::lround(1073741823.0 * std::cos(angle / 2))), 0,
                       static_cast<std::int32_t>(std::lround(1073741823.0 * s)), 0};
    EasedPath path;
    path.follow(predictor, turned);
    const auto angle_at = [&](std::int64_t tick) {
      return angle_between(to_pose(path.pose(predictor, tick), 22).rotation, to_pose({{}, turned.rotation}, 22).rotation);
    };
    EXPECT_NEAR(angle_at(5), angle, 2e-4) << angle;
    EXPECT_NEAR(angle_at(5 + 32), angle / 2, 2e-4) << angle;
    EXPECT_NEAR(angle_at(5 + 64), 0, 1e-9) << angle;
  }
}

/// Eventful motion: what is shown keeps the bounds at every tick and does not jump where it would without easing.
TEST(Easing, BoundsHoldOnTheWayAndStepsAreSmall) {
  RigidTriggers triggers{.visual_position = 0.001, .visual_rotation = 0.02, .haptic = HapticRule::off};
  const auto worst_step = [&](bool is_eased, int& packets, std::vector<double>& steps) {
    SceneSpec spec = testing::spec_of(1);
    spec.is_eased = is_eased;
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
        ASSERT_TRUE(receiver.push(packet.bytes));
      }
      const Pose shown = to_pose(receiver.replica().pose(0, tick), scene->grid.position);
      ASSERT_LE(norm(shown.position - truth.pose.position), triggers.visual_position) << tick;
      ASSERT_LE(angle_between(shown.rotation, truth.pose.rotation), triggers.visual_rotation) << tick;
      const Vec3 error = shown.position - truth.pose.position;
      if (!packet.bytes.empty()) steps.push_back(norm(error - before));
      before = error;
    }
  };
  int plain = 0, eased = 0;
  std::vector<double> jumps, steps;
  worst_step(false, plain, jumps);
  worst_step(true, eased, steps);
  ASSERT_GT(plain, 200);
  EXPECT_LT(eased, 1.1 * plain);
  const auto median = [](std::vector<double>& of) {
    std::nth_element(of.begin(), of.begin() + static_cast<std::ptrdiff_t>(of.size() / 2), of.end());
    return of[of.size() / 2];
  };
  EXPECT_LT(median(steps), 0.25 * median(jumps));
}

/// The same updates, none of which eases: in an eased scene each of them says so.
TEST(Easing, ASceneThatIsNotEasedHasNoBitOfIt) {
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
  EXPECT_LT(bytes_of(testing::scene_of(1)), bytes_of(eased_scene()));
}

/// Who begins at a key packet has shown nothing before it.
TEST(Easing, KeyPacketsAreNotEased) {
  const RigidTriggers triggers{.visual_position = 0.001, .haptic = HapticRule::off};
  SenderOptions options{.triggers = triggers};
  options.policy.key_interval = 0.2;
  auto sender = Sender::create(eased_scene(), options).value();
  testing::Motion motion(6);
  auto receiver = Receiver::create(eased_scene()).value();
  std::size_t keys = 0, eased = 0;
  for (std::int64_t tick = 0; tick < 9000; ++tick) {
    const RigidSample truth = motion.step(1e-3);
    const Packet packet = only(sender.encode(tick, {.objects = {&truth, 1}}));
    if (packet.bytes.empty()) continue;
    ASSERT_TRUE(receiver.push(packet.bytes));
    eased += receiver.objects()[0].ease > 0;
    if (!packet.key) continue;
    ++keys;
    auto late = Receiver::create(eased_scene()).value();
    ASSERT_TRUE(late.push(packet.bytes));
    ASSERT_EQ(late.objects()[0].ease, 0);
    const RigidPose shown = late.replica().pose(0, tick);
    ASSERT_EQ(shown.position, late.objects()[0].position);
  }
  EXPECT_GT(keys, 20U);
  EXPECT_GT(eased, 20U);
}

TEST(Easing, ALinearClientIsRefused) {
  const auto receiver = Receiver::create(eased_scene(), {.replica = {.interpolation = Interpolation::linear}, .limits = {}});
  ASSERT_FALSE(receiver);
  EXPECT_STREQ(receiver.error().rule, "R-API-4");
}

/// All packets build on the first one, so that they can be decoded in any order.
TEST(Easing, PlayoutShowsThePathWhateverTheOrderOfArrival) {
  const SharedScene scene = eased_scene(64);
  const RigidTriggers triggers{.visual_position = 0.0005, .haptic = HapticRule::off};
  auto sender =
      Sender::create(scene, {.triggers = triggers, .policy = {.key_interval = 0, .baseline = Baseline::acknowledged}}).value();
  auto direct = Receiver::create(scene).value();
  testing::Motion motion(8);
  std::vector<RigidPose> shown;
  std::vector<std::vector<std::uint8_t>> packets;
  for (std::int64_t tick = 0; packets.size() < 60; ++tick) {
    const RigidSample truth = motion.step(1e-3);
    const Packet packet = only(sender.encode(tick, {.objects = {&truth, 1}}));
    if (!packet.bytes.empty()) {
      ASSERT_TRUE(direct.push(packet.bytes));
      if (packets.empty()) sender.acknowledge(0, packet.sequence);
      packets.emplace_back(packet.bytes.begin(), packet.bytes.end());
    }
    shown.push_back(direct.replica().pose(0, tick));
  }
  std::mt19937_64 random(3);
  for (int round = 0; round < 10; ++round) {
    std::shuffle(packets.begin() + 1, packets.end(), random);
    auto late = Receiver::create(scene, {.replica = {.interpolation = Interpolation::playout}, .limits = {}}).value();
    for (const auto& packet : packets) ASSERT_TRUE(late.push(packet)) << round;
    for (std::size_t tick = 0; tick < shown.size(); ++tick)
      ASSERT_EQ(late.replica().pose(0, static_cast<std::int64_t>(tick)), shown[tick]) << round << " tick " << tick;
  }
}

}  // namespace
}  // namespace tactus
