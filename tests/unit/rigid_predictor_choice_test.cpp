// SPDX-License-Identifier: Apache-2.0
/// Which predictor an update gets.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include <tactus/rigid/encoder_choices.h>
#include "tests/unit/driven_fixture.h"
#include "tests/unit/rigid_fixture.h"

namespace tactus {
namespace {

using testing::driven_scene;
using testing::kHold;
using testing::kMass;
using testing::kPush;

// ==== rigid predictor choice ====

constexpr double kGravity = 9.81, kFriction = 0.25;
constexpr PermittedError kPermitted{0.001, 0.02};

SharedScene scene_with(const MotionPhysics& physics, std::uint8_t dof = Dof::all) {
  return SceneBuilder().rigid("o", {}, {.dof = dof}).motion(physics).build().value();
}

/// Thrown, then sliding to rest on a floor, then thrown anew.
class Toss {
 public:
  RigidSample at(std::int64_t tick) const {
    const double t = 1e-3 * static_cast<double>(tick % 1000);
    const double up = 2, flight = 2 * up / kGravity, forward = 0.8, rest = forward / (kFriction * kGravity);
    RigidSample out;
    if (t < flight) {
      out.pose.position = {forward * t, 0, up * t - kGravity / 2 * t * t};
      out.velocity = {forward, 0, up - kGravity * t};
      return out;
    }
    const double s = std::min(t - flight, rest);
    out.pose.position = {forward * (flight + s - s * s / (2 * rest)), 0, 0};
    out.velocity = {forward * (1 - s / rest), 0, 0};
    return out;
  }
};

Predictor chosen_at(std::int64_t now, const SharedScene& scene, std::int64_t step = 1, bool is_touched = false) {
  const Toss toss;
  PastStates past(*scene);
  PredictorChoice choice(*scene, past);
  RigidState truth;
  for (std::int64_t tick = now - 200 * step; tick <= now; tick += step) {
    truth = to_grid(toss.at(tick), tick, scene->grid).value();
    past.read(tick, {&truth, 1}, scene->moving());
  }
  return choice.choose(0, truth, kPermitted, is_touched, {});
}

TEST(PredictorChoice, TakesWhatWouldHaveServedLongest) {
  const SharedScene scene = scene_with({{0, 0, -kGravity}, kFriction});
  EXPECT_EQ(chosen_at(1350, scene), Predictor::ballistic);
  EXPECT_EQ(chosen_at(1600, scene), Predictor::slide);
  EXPECT_EQ(chosen_at(1999, scene), Predictor::linear) << "at rest all serve alike";
}

TEST(PredictorChoice, WhatAnUnknownDeviceTouchesIsPredictedLinearly) {
  const SharedScene scene = scene_with({{0, 0, -kGravity}, kFriction});
  EXPECT_EQ(chosen_at(1350, scene, 1, true), Predictor::linear);
  EXPECT_EQ(chosen_at(1600, scene, 1, true), Predictor::linear);
}

TEST(PredictorChoice, NeverTakesWhatTheSceneDoesNotDeclare) {
  EXPECT_EQ(chosen_at(1350, scene_with({{0, 0, -kGravity}, 0})), Predictor::ballistic);
  EXPECT_NE(chosen_at(1600, scene_with({{0, 0, -kGravity}, 0})), Predictor::slide);
}

/// The residual could not bring it back.
TEST(PredictorChoice, WhatCannotFallIsNeverBallistic) {
  const auto rail = static_cast<std::uint8_t>(Dof::all & ~Dof::z);
  EXPECT_NE(chosen_at(1350, scene_with({{0, 0, -kGravity}, kFriction}, rail)), Predictor::ballistic);
}

/// Whichever way that is.
TEST(PredictorChoice, ARailAgainstGravityIsSeenOnEveryAxis) {
  const auto choose = [](std::size_t axis, std::uint8_t dof) {
    const auto along = [axis](double v) { return Vec3{axis == 0 ? v : 0, axis == 1 ? v : 0, axis == 2 ? v : 0}; };
    const SharedScene scene = scene_with({along(-kGravity), 0}, dof);
    PastStates past(*scene);
    PredictorChoice choice(*scene, past);
    RigidState truth;
    for (std::int64_t tick = 0; tick <= 200; ++tick) {
      const double t = 1e-3 * static_cast<double>(tick);
      truth = to_grid({{along(-kGravity / 2 * t * t), {}}, along(-kGravity * t), {}}, tick, scene->grid).value();
      past.read(tick, {&truth, 1}, scene->moving());
    }
    return choice.choose(0, truth, kPermitted, false, {});
  };
  const std::array axes{Dof::x, Dof::y, Dof::z};
  for (std::size_t axis = 0; axis < axes.size(); ++axis) {
    EXPECT_EQ(choose(axis, Dof::all), Predictor::ballistic) << axis;
    EXPECT_EQ(choose(axis, static_cast<std::uint8_t>(Dof::all & ~axes[axis])), Predictor::linear) << axis;
  }
}

TEST(PredictorChoice, WithoutAPastItIsLinear) {
  const SharedScene scene = scene_with({{0, 0, -kGravity}, kFriction});
  PastStates past(*scene);
  PredictorChoice choice(*scene, past);
  const RigidState truth = to_grid(Toss().at(1350), 1350, scene->grid).value();
  EXPECT_EQ(choice.choose(0, truth, kPermitted, false, {}), Predictor::linear);
  past.read(1350, {&truth, 1}, scene->moving());
  EXPECT_EQ(choice.choose(0, truth, kPermitted, false, {}), Predictor::linear);
}

/// Of a cube that has moved with this acceleration for 150 ms, at a device that explains none of it.
Predictor chosen_after(double acceleration, const RigidState& current) {
  const SharedScene scene = testing::driven_scene(Dof::all, {});
  const auto path = testing::path_along(scene, 151, [](std::int64_t) { return Vec3{-1, 0, 0}; });
  PastStates past(*scene);
  const PredictorChoice choice(*scene, past, path.get());
  RigidState truth;
  for (std::int64_t tick = 0; tick <= 150; ++tick) {
    const double t = 1e-3 * static_cast<double>(tick);
    truth = to_grid({{{acceleration / 2 * t * t, 0, 0}, {}}, {acceleration * t, 0, 0}, {}}, tick, scene->grid).value();
    truth.contact = testing::contact_at({-0.02, 0, 0}, {-1, 0, 0});
    past.read(tick, {&truth, 1}, scene->moving(), {&truth.contact, 1});
  }
  return choice.choose(0, truth, kPermitted, true, current);
}

/// It has served longer than a steady motion would have.
TEST(PredictorChoice, WhatTheDeviceHasDrivenLongerThanAnotherWouldServeItDrivesOn) {
  const RigidState driven{.tick = 90, .predictor = Predictor::driven}, linear{.tick = 90};
  EXPECT_EQ(chosen_after(2, driven), Predictor::driven) << "3.6 mm beside a steady motion since then";
  EXPECT_EQ(chosen_after(2, linear), Predictor::linear);
  EXPECT_EQ(chosen_after(0.1, driven), Predictor::linear) << "0.2 mm: a steady motion would have served as well";
  RigidState young = driven;
  young.tick = 140;
  EXPECT_EQ(chosen_after(2, young), Predictor::linear) << "0.1 mm";
}

struct Outcome {
  int packets = 0;
  double error = 0;  // largest, over the bound
};

Outcome send(const SharedScene& scene, const Toss& toss) {
  SenderOptions options;
  options.triggers.haptic = HapticRule::off;
  options.triggers.visual_position = 0.001;
  auto sender = Sender::create(scene, options).value();
  auto receiver = Receiver::create(scene).value();
  Outcome out;
  for (std::int64_t tick = 0; tick < 5000; ++tick) {
    const RigidSample sample = toss.at(tick);
    const Packet packet = testing::only(sender.encode(tick, {.objects = {&sample, 1}}));
    if (!packet.bytes.empty()) {
      ++out.packets;
      EXPECT_TRUE(receiver.push(packet.number, packet.bytes));
      EXPECT_EQ(sender.state_hash(0), receiver.state_hash(0));
    }
    const Pose shown = to_pose(receiver.replica().pose(0, tick), scene->grid.position);
    out.error = std::max(out.error, norm(shown.position - sample.pose.position) / 0.001);
  }
  return out;
}

TEST(PredictorChoice, TossesTakeAFractionOfThePacketsInsideTheSameBounds) {
  const Toss toss;
  const Outcome plain = send(scene_with({}), toss), motion = send(scene_with({{0, 0, -kGravity}, kFriction}), toss);
  EXPECT_LE(plain.error, 1);
  EXPECT_LE(motion.error, 1);
  EXPECT_LT(motion.packets, 0.4 * plain.packets);
}

/// A locked axis would run away for good.
TEST(PredictorChoice, AnObjectOnARailStaysOnIt) {
  const SharedScene scene = SceneBuilder().rigid("o", {}, {.dof = Dof::x}).motion({{0, 0, -kGravity}, kFriction}).build().value();
  auto sender = Sender::create(scene).value();
  auto receiver = Receiver::create(scene).value();
  for (std::int64_t tick = 0; tick < 3000; ++tick) {
    RigidSample sample = Toss().at(tick);
    sample.pose.position.z = sample.velocity.z = 0;
    for (const Packet& packet : testing::all(sender.encode(tick, {.objects = {&sample, 1}})))
      ASSERT_TRUE(receiver.push(packet.number, packet.bytes));
    ASSERT_EQ(receiver.replica().pose(0, tick).position[2], 0) << tick;
  }
}

// ==== rigid driven choice ====

constexpr double kTick = 1e-3;

/// A cube that a device pushes along x against a drag; the truth as a simulation gives it.
struct Pushing {
  SharedScene scene = driven_scene();
  double drag;
  Vec3 device{-0.0185, 0, 0};
  std::shared_ptr<DevicePath> path = std::make_shared<DevicePath>(device_scene(*scene).value());
  DrivenChoice choice{*scene, *path};
  RigidSample cube{{{}, {}}, {0.1, 0, 0}, {}};
  Contact contact{ContactKind::surface, 0, {-0.02, 0, 0}, {-1, 0, 0}, {}, kPush};
  std::int64_t tick = 0;
  DrivenContact signalled;

  explicit Pushing(double braked) : drag(braked) { path->shift(0, 0); }

  DrivenContact step() {
    path->add(static_cast<std::uint64_t>(tick) + 1, testing::device_state(*scene, tick, device));
    contact.device = device;
    choice.read(tick, {&cube, 1}, {&contact, contact.kind == ContactKind::none ? 0u : 1u}, {&signalled, 1});
    const double depth = std::max(0.0, device.x - (cube.pose.position.x - 0.02));
    const double speed = cube.velocity.x + kTick * (kPush / kMass * depth - drag);
    cube.pose.position.x += kTick * speed;
    cube.velocity.x = (1 - testing::kLoss) * speed;
    device.x += 1e-4;
    ++tick;
    return signalled;
  }
};

/// That of a receiver, whose point is on a grid.
TEST(DrivenChoice, TheDragExplainsTheMotion) {
  const double rounding = kPush / kMass * (std::ldexp(164.0, -DrivenContact::kPoint) - 0.02);
  for (const double drag : {0.0, 2.0, 6.9}) {
    Pushing pushing(drag);
    DrivenContact signalled;
    for (int i = 0; i < 20; ++i) {
      signalled = pushing.step();
      if (i < 4) {
        EXPECT_EQ(signalled, DrivenContact{}) << "too little was seen";
      }
    }
    EXPECT_NEAR(std::ldexp(signalled.drag, -DrivenContact::kDrag), drag + rounding, 0.04);
    EXPECT_EQ(signalled.point, (Vec3i{-164, 0, 0}));
    EXPECT_EQ(signalled.normal, (Vec3i{-1024, 0, 0}));
    EXPECT_FALSE(signalled.is_held);
  }
}

/// What is remembered of an object is its own.
TEST(DrivenChoice, ObjectsThatTheDeviceMovesInTurnsAreSignalledAlike) {
  constexpr std::size_t kCubes = 3;
  SceneBuilder builder;
  for (std::size_t i = 0; i < kCubes; ++i) builder.rigid("cube" + std::to_string(i), {}, {.driven = testing::cube_physics()});
  const SharedScene scene = builder.motion({{0, 0, -testing::kWeight}, testing::kGround}).baselines(64).build().value();
  DevicePath path(device_scene(*scene).value());
  path.shift(0, 0);
  DrivenChoice choice(*scene, path);
  std::vector<DrivenContact> signalled(kCubes);
  std::vector<RigidSample> cubes(kCubes);
  for (std::int64_t tick = 0; tick < 60; ++tick) {
    const auto pushed = static_cast<std::uint32_t>(tick / 20);
    const Vec3 device{1e-4 * static_cast<double>(tick), 0, 0};
    path.add(static_cast<std::uint64_t>(tick) + 1, testing::device_state(*scene, tick, device));
    // Pushed at a constant speed: the drag is what the spring pulls.
    for (RigidSample& cube : cubes) cube = {{device + Vec3{0.0185, 0, 0}, {}}, {0.1, 0, 0}, {}};
    const Contact contact{ContactKind::surface, pushed, {-0.02, 0, 0}, {-1, 0, 0}, device, kPush};
    choice.read(tick, cubes, {&contact, 1}, signalled);
    for (std::uint32_t i = 0; i < kCubes; ++i) {
      EXPECT_EQ(signalled[i] == DrivenContact{}, i != pushed || tick % 20 < 4) << tick << ' ' << i;
    }
    if (tick % 20 == 19) {
      EXPECT_NEAR(std::ldexp(signalled[pushed].drag, -DrivenContact::kDrag), kPush / kMass * 0.0015 - 0.1 * 1000 * testing::kLoss,
                  0.15);
    }
  }
}

TEST(DrivenChoice, WhatIsHeldIsSignalledAtOnce) {
  Pushing pushing(0);
  pushing.contact.kind = ContactKind::spring;
  pushing.contact.stiffness = kHold;
  const DrivenContact signalled = pushing.step();
  EXPECT_TRUE(signalled.is_held);
  EXPECT_EQ(signalled.normal, Vec3i{});
}

/// The contact of another user is where no path leads.
TEST(DrivenChoice, AnotherUsersContactIsNotSignalled) {
  Pushing pushing(2);
  for (int i = 0; i < 10; ++i) pushing.step();
  EXPECT_NE(pushing.step(), DrivenContact{});
  pushing.device.y += 1e-4;
  pushing.path->add(1000, testing::device_state(*pushing.scene, pushing.tick, {0, 0, 1}));
  EXPECT_EQ(pushing.step(), DrivenContact{});
}

/// Where nothing is touched for a moment, the drag is looked for anew.
TEST(DrivenChoice, AfterAPauseItWaitsForTheWindow) {
  Pushing pushing(2);
  for (int i = 0; i < 10; ++i) pushing.step();
  pushing.contact.kind = ContactKind::none;
  EXPECT_EQ(pushing.step(), DrivenContact{});
  pushing.contact.kind = ContactKind::surface;
  for (int i = 0; i < 4; ++i) EXPECT_EQ(pushing.step(), DrivenContact{});
  EXPECT_NE(pushing.step(), DrivenContact{});
}

}  // namespace
}  // namespace tactus
