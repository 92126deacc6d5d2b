// SPDX-License-Identifier: Apache-2.0
/// What an encoder of rigid objects chooses.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <tactus/base/geometry.h>
#include <tactus/rigid/encoder_choices.h>
#include "tests/unit/rigid_fixture.h"

namespace tactus {
namespace {

using testing::only;
using testing::scene_of;

// ==== acceleration ====

/// Of an object with these velocities along x, and about z.
Acceleration::Motion after(std::array<std::int64_t, 3> ticks, std::array<double, 3> velocities, std::uint32_t tick_rate = 1000) {
  SceneSpec spec = testing::spec_of(1);
  spec.tick_rate = tick_rate;
  const SharedScene scene = testing::shared(spec);
  Acceleration acceleration(*scene);
  for (std::size_t i = 0; i < 3; ++i) {
    const RigidSample sample{{}, {velocities[i], 0, 0}, {0, 0, 2 * velocities[i]}};
    acceleration.read(ticks[i], {&sample, 1}, scene->moving());
  }
  return acceleration.of(0);
}

TEST(Acceleration, IsTheSmallerOfTheLastTwoDifferences) {
  EXPECT_NEAR(after({7, 8, 9}, {0, 0.01, 0.02}).linear.x, 10, 1e-9);
  EXPECT_NEAR(after({7, 8, 9}, {0, 0.01, 0.02}).angular.z, 20, 1e-9);
  EXPECT_NEAR(after({7, 8, 9}, {0, -0.01, -0.03}).linear.x, -10, 1e-9);
  EXPECT_NEAR(after({0, 5, 10}, {0, 0.03, 0.04}).linear.x, 2, 1e-9) << "ticks between count";
  EXPECT_EQ(after({7, 8, 9}, {0, 0.01, 0.02}).linear.y, 0);
}

/// A kick, a pause and noise that turns around in every tick say nothing of the velocity to come.
TEST(Acceleration, IsNothingWhereTheLastTwoTicksDoNotAgreeOrAreLongAgo) {
  EXPECT_EQ(after({7, 8, 9}, {0, 0, 0.02}).linear, Vec3{});
  EXPECT_EQ(after({7, 8, 9}, {0, 0.02, 0.01}).linear, Vec3{});
  EXPECT_EQ(after({7, 8, 90}, {0, 0.01, 0.02}).linear, Vec3{});
  EXPECT_EQ(after({7, 8, 9}, {0, 0.01, 0.02}, 148).linear, Vec3{}) << "a third of the time in which it fades has passed";
  const SharedScene scene = scene_of(1);
  Acceleration fresh(*scene);
  const RigidSample first{{}, {1, 2, 3}, {4, 5, 6}};
  fresh.read(100, {&first, 1}, scene->moving());
  EXPECT_EQ(fresh.of(0).linear, Vec3{});
  EXPECT_EQ(fresh.of(0).angular, Vec3{});
}

/// By integrating a e^(-t/tau) twice in small steps.
TEST(Acceleration, DepartureIsThatOfAFadingAcceleration) {
  double velocity = 0, position = 0;
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 100000; ++i) {
    velocity += kStep * std::exp(-(i + 0.5) * kStep / Acceleration::kFade);
    position += kStep * velocity;
  }
  EXPECT_NEAR(Acceleration::departure(0.1), position, 1e-4 * position);
  EXPECT_EQ(Acceleration::departure(0), 0);
}

// ==== force trend ====

constexpr double kStiffness = 1000;

/// Of an object that a probe presses with these forces [N]; less than 0: it does not touch.
double decay_rate(std::array<std::int64_t, 3> ticks, std::array<double, 3> forces) {
  const SharedScene scene = testing::scene_of(2);
  ForceTrend trend(*scene);
  const std::vector<RigidSample> samples(2);
  for (std::size_t i = 0; i < 3; ++i) {
    Contact contact = testing::touch(1, {}, forces[i] / kStiffness, kStiffness);
    if (forces[i] < 0) contact.kind = ContactKind::none;
    trend.read(ticks[i], samples, {&contact, 1});
  }
  EXPECT_EQ(trend.relative_decay_rate(0), 0) << "of another object";
  return trend.relative_decay_rate(1);
}

TEST(ForceTrend, IsWhatTheLastTwoTicksTook) {
  EXPECT_NEAR(decay_rate({7, 8, 9}, {0.5, 0.46, 0.4}), 0.1 / 0.4 / 0.002, 1e-6);
  EXPECT_NEAR(decay_rate({1, 5, 9}, {0.5, 0.5, 0.4}), 0.1 / 0.4 / 0.008, 1e-6) << "ticks between count";
  EXPECT_NEAR(decay_rate({0, 5, 10}, {0.5, 0.5, 0.4}), 0.1 / 0.4 / 0.01, 1e-6) << "the longest that counts";
}

TEST(ForceTrend, IsNothingWhereTheForceGrowsBeginsOrWasLongAgo) {
  EXPECT_EQ(decay_rate({7, 8, 9}, {0.4, 0.6, 0.5}), 0);
  EXPECT_EQ(decay_rate({7, 8, 9}, {-1, 0.5, 0.4}), 0);
  EXPECT_EQ(decay_rate({7, 8, 9}, {0.5, 0.4, -1}), 0);
  EXPECT_EQ(decay_rate({7, 8, 9}, {0.5, 0.4, 0}), 0) << "nothing is left to decay";
  EXPECT_EQ(decay_rate({0, 5, 11}, {0.5, 0.45, 0.4}), 0);
  EXPECT_EQ(ForceTrend(*testing::scene_of(1)).relative_decay_rate(0), 0);
}

TEST(ForceTrend, TheLeastOfTheForcesCounts) {
  const SharedScene scene = testing::scene_of(1);
  ForceTrend trend(*scene);
  const RigidSample sample;
  for (std::int64_t tick = 0; tick < 3; ++tick) {
    const double lost = 0.02 * static_cast<double>(tick);
    const std::array contacts{testing::touch(0, {}, (2 - 5 * lost) / kStiffness, kStiffness),
                              testing::touch(0, {}, (0.3 - lost) / kStiffness, kStiffness)};
    trend.read(tick, {&sample, 1}, contacts);
  }
  EXPECT_NEAR(trend.relative_decay_rate(0), 0.04 / 0.26 / 0.002, 1e-6);
}

// ==== look-ahead velocity ====

constexpr double kTick = 1e-3;

/// At tick t an object under a constant acceleration along x.
RigidSample falling(double acceleration, std::int64_t tick) {
  const double t = kTick * static_cast<double>(tick);
  return {{{0.5 * acceleration * t * t, 0, 0}, {}}, {acceleration * t, 0, 0}, {}};
}

/// Who has read three ticks of that, up to now = falling(acceleration, 2).
Acceleration after_three_ticks(const Scene& scene, double acceleration) {
  Acceleration out(scene);
  for (std::int64_t tick = 0; tick < 3; ++tick) {
    const RigidSample sample = falling(acceleration, tick);
    out.read(tick, {&sample, 1}, scene.moving());
  }
  return out;
}

/// What is sent of the only object more than its velocities.
Acceleration::Motion lead_of(const Acceleration& acceleration, const RigidSample& now, std::span<const Contact> contacts,
                             const RigidTriggers& triggers) {
  return look_ahead_velocity(acceleration.of(0), ErrorRatio(0, now.pose, contacts, triggers));
}

/// Its senders look ahead.
SharedScene smoothed_scene() {
  SceneSpec spec = testing::spec_of(1);
  spec.is_smoothed = true;
  return testing::shared(spec);
}

SenderOptions without_heartbeat() {
  SenderOptions out;
  out.triggers.heartbeat = 0;
  out.policy.key_interval = 0;
  return out;
}

template <class Samples>
int packets(const SharedScene& scene, std::int64_t ticks, const Samples& sample_at) {
  auto sender = Sender::create(scene, without_heartbeat()).value();
  int out = 0;
  for (std::int64_t tick = 0; tick < ticks; ++tick) {
    const RigidSample sample = sample_at(tick);
    if (!only(sender.encode(tick, {.objects = {&sample, 1}})).bytes.empty()) ++out;
  }
  return out;
}

/// The velocity that is sent leads to an error of 0.6 of the bound on the one side, if the acceleration fades as is taken.
TEST(LookAheadVelocity, LeadsToTheFractionOfTheBoundThatIsTaken) {
  constexpr double kTau = 0.03, kMargin = 0.6;
  const RigidTriggers triggers{.visual_position = 6e-3, .haptic = HapticRule::off};
  for (const double acceleration : {0.3, 1.0, 3.0, 10.0, 40.0}) {
    const SharedScene scene = scene_of(1);
    const Acceleration fall = after_three_ticks(*scene, acceleration);
    const RigidSample now = falling(acceleration, 2);
    const double s = lead_of(fall, now, {}, triggers).linear.x / acceleration;
    ASSERT_GT(s, 0) << acceleration;
    ASSERT_LE(s, kTau * 1.0001) << acceleration;
    double largest = 0;
    for (double t = 0; t < 1; t += 1e-4)
      largest = std::max(largest, acceleration * (s * t - kTau * (t - kTau * (1 - std::exp(-t / kTau)))));
    if (acceleration * kTau * kTau > kMargin * triggers.visual_position)
      EXPECT_NEAR(largest / triggers.visual_position, kMargin, 0.07 * kMargin) << acceleration;
    else EXPECT_LT(largest, kMargin * triggers.visual_position) << acceleration;
  }
}

TEST(LookAheadVelocity, AnUpdateUnderAnAccelerationLastsLonger) {
  for (const double acceleration : {5.0, 20.0}) {
    const auto at = [&](std::int64_t tick) { return falling(acceleration, tick); };
    EXPECT_GT(packets(scene_of(1), 400, at), 1.7 * packets(smoothed_scene(), 400, at)) << acceleration;
  }
}

/// What is touched looks ahead as the force permits, along the normal.
TEST(LookAheadVelocity, TheForceBoundCountsWhereItIsTheNarrowest) {
  const SharedScene scene = scene_of(1);
  const Acceleration fall = after_three_ticks(*scene, 2);
  const RigidSample now = falling(2, 2);
  const auto lead = [&](const Vec3& normal, ContactKind kind) {
    const Contact contact{kind, 0, {}, normal, now.pose.position - 1e-3 * normal, 700};
    return lead_of(fall, now, {&contact, 1}, RigidTriggers{.weber_fraction = 0.04}).linear.x;
  };
  const double free = lead_of(fall, now, {}, RigidTriggers{}).linear.x;
  EXPECT_LT(lead({1, 0, 0}, ContactKind::surface), 0.5 * free);
  EXPECT_EQ(lead({0, 0, 1}, ContactKind::surface), free) << "the force does not change when it slides along the face";
  EXPECT_LT(lead({0, 0, 1}, ContactKind::spring), 0.5 * free) << "that of a spring does";
  EXPECT_EQ(lead({1, 0, 0}, ContactKind::none), free);
}

/// About z, from rest; the contact is 20 mm away from the axis.
TEST(LookAheadVelocity, WhatTurnsLooksAheadAsRotationAndForcePermit) {
  const SharedScene scene = scene_of(1);
  Acceleration fall(*scene);
  RigidSample now;
  for (std::int64_t tick = 0; tick < 3; ++tick) {
    now.angular_velocity = {0, 0, 0.08 * static_cast<double>(tick)};
    fall.read(tick, {&now, 1}, scene->moving());
  }
  const Contact contact{ContactKind::surface, 0, {0.02, 0, 0}, {0, 1, 0}, {0.02, -1e-3, 0}, 700};
  const auto lead = [&](const RigidTriggers& triggers, bool is_touched) {
    return lead_of(fall, now, {&contact, is_touched ? 1u : 0u}, triggers).angular.z;
  };
  const double free = lead({}, false);
  EXPECT_GT(free, 0);
  EXPECT_LT(lead({.visual_rotation = 0.005}, false), 0.7 * free);
  EXPECT_LT(lead({.weber_fraction = 0.01}, true), 0.7 * free) << "the lever moves along the normal";
  EXPECT_LT(lead({.haptic = HapticRule::fixed, .fixed_rotation = 0.005}, true), 0.7 * free);
  EXPECT_EQ(lead({.haptic = HapticRule::off, .weber_fraction = 0.01}, true), free);
}

TEST(LookAheadVelocity, FixedThresholdsOfWhatIsTouchedCount) {
  const SharedScene scene = scene_of(1);
  const Acceleration fall = after_three_ticks(*scene, 2);
  const RigidSample now = falling(2, 2);
  const Contact contact{ContactKind::surface, 0, {}, {0, 0, 1}, {}, 700};
  const auto lead = [&](double fixed) {
    const RigidTriggers triggers{.haptic = HapticRule::fixed, .fixed_position = fixed};
    return lead_of(fall, now, {&contact, 1}, triggers).linear.x;
  };
  EXPECT_LT(lead(1e-4), 0.7 * lead(5e-3));
}

TEST(LookAheadVelocity, MotionWithoutAccelerationIsSentAsWithoutIt) {
  const auto steady = [](std::int64_t tick) {
    RigidSample out = falling(0, tick);
    out.velocity = {0.3, 0, 0};
    out.pose.position.x = 0.3 * kTick * static_cast<double>(tick);
    return out;
  };
  const auto sent = [&](const SharedScene& scene) {
    auto sender = Sender::create(scene, without_heartbeat()).value();
    auto receiver = Receiver::create(scene).value();
    std::vector<std::array<std::int32_t, 3>> out;
    for (std::int64_t tick = 0; tick < 500; ++tick) {
      const RigidSample sample = steady(tick);
      const Packet packet = only(sender.encode(tick, {.objects = {&sample, 1}}));
      if (packet.bytes.empty()) continue;
      EXPECT_TRUE(receiver.push(packet.number, packet.bytes));
      out.push_back(receiver.object(0).velocity);
    }
    return out;
  };
  const auto plain = sent(scene_of(1));
  ASSERT_FALSE(plain.empty());
  EXPECT_EQ(sent(smoothed_scene()), plain);
}

/// A call that is refused leaves no acceleration behind.
TEST(LookAheadVelocity, RefusedTruthIsForgotten) {
  auto undisturbed = Sender::create(smoothed_scene(), without_heartbeat()).value();
  auto disturbed = Sender::create(smoothed_scene(), without_heartbeat()).value();
  for (std::int64_t tick = 0; tick < 600; tick += 2) {
    const RigidSample sample = falling(8, tick);
    const RigidSample wrong[2]{{}, sample};
    EXPECT_FALSE(disturbed.encode(tick, {.objects = wrong}));
    const Packet a = only(undisturbed.encode(tick, {.objects = {&sample, 1}}));
    const Packet b = only(disturbed.encode(tick, {.objects = {&sample, 1}}));
    ASSERT_TRUE(std::ranges::equal(a.bytes, b.bytes)) << tick;
  }
}

// ==== smoothing choice ====

const RigidTriggers kTriggers{.visual_position = 0.001, .visual_rotation = 0.05};
const ErrorRatio kRatio(0, {}, {}, kTriggers);

ErrorTrajectory trajectory(double offset, double drift, double acceleration) {
  return {{{offset, 0, 0}, {}}, {}, {{drift, 0, 0}, {}}, {{acceleration, 0, 0}, {}}};
}

TEST(SmoothingChoice, TakesSixteenMillisecondsWhereTheNewPathIsRight) {
  EXPECT_EQ(longest_smoothing_exp(trajectory(-0.001, 0, 0), kRatio, 1000), 4);
  EXPECT_EQ(longest_smoothing_exp(trajectory(-0.001, 0, 0), kRatio, 8000), 7) << "the longest there is";
  EXPECT_EQ(longest_smoothing_exp(trajectory(-0.001, 0, 0), kRatio, 148), 1);
  EXPECT_EQ(longest_smoothing_exp(trajectory(-0.001, 0, 0), kRatio, 60), 0) << "two ticks are longer than that";
  EXPECT_EQ(longest_smoothing_exp(trajectory(-0.001, 0, 0), kRatio, 1), 0);
}

/// The error that grows and the offset that shrinks are on the same side, or on different ones.
TEST(SmoothingChoice, IsShorterWhereTheErrorGrowsOnTheSideOfTheOffset) {
  const auto smoothing_exp = [](double drift) { return longest_smoothing_exp(trajectory(-0.001, drift, 0), kRatio, 1000); };
  EXPECT_EQ(smoothing_exp(0.03), 4);
  int before = 4;
  for (const double drift : {-0.02, -0.05, -0.1, -0.2, -0.5}) {
    EXPECT_LE(smoothing_exp(drift), before) << drift;
    before = smoothing_exp(drift);
  }
  EXPECT_EQ(before, 0);
  EXPECT_LT(longest_smoothing_exp(trajectory(-0.001, 0, 10), kRatio, 1000), 4) << "the truth runs away from where it is shown";
  EXPECT_EQ(longest_smoothing_exp(trajectory(-0.001, 0, -5), kRatio, 1000), 4);
}

/// An offset that the force permits now is gone before the force is.
TEST(SmoothingChoice, IsShorterWhereTheForceDecays) {
  const Contact contact{ContactKind::surface, 0, {}, {1, 0, 0}, {-0.001, 0, 0}, 1000};
  const auto smoothing_exp = [&](double rate_of_decay) {
    const ErrorRatio ratio(0, {}, {&contact, 1}, {.weber_fraction = 0.04}, rate_of_decay);
    return longest_smoothing_exp(trajectory(-0.000036, 0, 0), ratio, 1000);
  };
  EXPECT_EQ(smoothing_exp(0), 4);
  EXPECT_EQ(smoothing_exp(20), 4) << "a third in 16 ms";
  EXPECT_LT(smoothing_exp(60), 4);
  EXPECT_GT(smoothing_exp(60), 0);
  EXPECT_LT(smoothing_exp(200), smoothing_exp(60));
}

TEST(SmoothingChoice, RotationCountsAsWell) {
  const ErrorTrajectory turned{{{}, {0, 0.05, 0}}, {}, {{}, {0, 40, 0}}, {}};
  EXPECT_LT(longest_smoothing_exp(turned, kRatio, 1000), 2);
  const auto smoothing_exp = [](double acceleration) {
    return longest_smoothing_exp({{{}, {0, -0.02, 0}}, {{}, {0, -0.02, 0}}, {}, {{}, {0, acceleration, 0}}}, kRatio, 1000);
  };
  EXPECT_LT(smoothing_exp(250), 4) << "the truth turns away from where it is shown";
  EXPECT_EQ(smoothing_exp(-250), 4);
}

/// The error leaves its bounds in the first quarter of 16 ms and is back before the half.
TEST(SmoothingChoice, LooksAtTheFirstQuarter) {
  EXPECT_LT(longest_smoothing_exp(trajectory(0.001, 0.08, 16), kRatio, 1000), 4);
  EXPECT_EQ(longest_smoothing_exp(trajectory(0.001, 0.07, 16), kRatio, 1000), 4);
}

// ==== error ratio ====

Pose moved(const Pose& pose, const Vec3& by, const Vec3& turn) {
  const double angle = norm(turn), half = angle / 2;
  const Vec3 axis = angle > 0 ? (std::sin(half) / angle) * turn : Vec3{};
  return {pose.position + by, Quat{std::cos(half), axis.x, axis.y, axis.z} * pose.rotation};
}

/// Held against the rule itself, for errors so small that the first order is all there is.
TEST(ErrorRatio, IsTheRatioOfTheRuleForSmallErrors) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  const auto vector = [&](double size) { return Vec3{size * normal(random), size * normal(random), size * normal(random)}; };
  for (int round = 0; round < 500; ++round) {
    const Vec3 turn = vector(1);
    const Pose truth = moved({vector(0.1), {}}, {}, turn);
    const bool is_spring = round % 2 == 0;
    const Vec3 raw = vector(1), point = vector(0.03);
    const Vec3 normal_of = (1 / norm(raw)) * raw;
    const Vec3 device = to_world(truth, point) - 2e-3 * rotate(truth.rotation, normal_of);
    const Contact contact{is_spring ? ContactKind::spring : ContactKind::surface, 0, point, normal_of, device, 500};
    const RigidTriggers triggers{.visual_position = 1, .visual_rotation = 3, .weber_fraction = 0.04};
    const Vec3 by = vector(1e-7), turned = vector(1e-6);
    const double ratio = haptic_ratio(triggers, contact_force(contact, truth), contact_force(contact, moved(truth, by, turned)));
    EXPECT_NEAR(ErrorRatio(0, truth, {&contact, 1}, triggers)(by, turned), ratio, 0.02 * ratio + 1e-6) << round;
  }
}

TEST(ErrorRatio, TheNarrowestBoundCounts) {
  const RigidTriggers seen{.visual_position = 0.002, .visual_rotation = 0.05};
  const ErrorRatio free(0, {}, {}, seen);
  EXPECT_NEAR(free({0, 0.001, 0}, {}), 0.5, 1e-12);
  EXPECT_NEAR(free({0, 0.001, 0}, {0.04, 0, 0}), 0.8, 1e-12);
  std::vector<Contact> contacts{{ContactKind::surface, 1, {}, {0, 0, 1}, {0, 0, -0.001}, 1000},
                                {ContactKind::none, 0, {}, {0, 0, 1}, {0, 0, -0.001}, 1000}};
  EXPECT_EQ(ErrorRatio(0, {}, contacts, seen)({0, 0, 0.001}, {}), free({0, 0, 0.001}, {})) << "of another object, and of none";
  contacts[0].object = 0;
  EXPECT_NEAR(ErrorRatio(0, {}, contacts, {.weber_fraction = 0.1})({0, 0, 0.0005}, {}), 5, 1e-9) << "0.5 N off at 1 N";
  EXPECT_NEAR(ErrorRatio(0, {}, contacts, {.visual_position = 6e-3, .haptic = HapticRule::fixed, .fixed_position = 0.001})(
                  {0.0005, 0, 0}, {}),
              0.5, 1e-9);
  EXPECT_NEAR(ErrorRatio(0, {}, contacts, {.haptic = HapticRule::cone, .cone_angle = 0.01})({}, {0.005, 0, 0}), 0.5, 1e-9);
  EXPECT_LT(ErrorRatio(0, {}, contacts, {.visual_position = 6e-3, .haptic = HapticRule::off})({0, 0, 0.0005}, {}), 0.1);
}

/// What is permitted at a force that decays by a tenth per 10 ms, down to what is permitted at the floor; what is seen stays.
TEST(ErrorRatio, AForceThatDecaysLeavesLessLater) {
  const Contact contact{ContactKind::surface, 0, {}, {0, 0, 1}, {0, 0, -0.001}, 1000};
  const RigidTriggers triggers{.visual_position = 0.01, .weber_fraction = 0.1, .force_floor = 0.2};
  const ErrorRatio ratio(0, {}, {&contact, 1}, triggers, 10);
  const Vec3 wrong{0, 0, 0.00005};
  EXPECT_NEAR(ratio(wrong, {}), 0.5, 1e-9);
  EXPECT_NEAR(ratio(wrong, {}, 0.01), 0.5 / 0.9, 1e-9);
  EXPECT_NEAR(ratio(wrong, {}, 0.05), 1, 1e-9);
  EXPECT_NEAR(ratio(wrong, {}, 0.2), 0.5 / 0.2, 1e-9);
  EXPECT_EQ(ratio({0.001, 0, 0}, {}, 0.2), ratio({0.001, 0, 0}, {}));
  EXPECT_EQ(ErrorRatio(0, {}, {&contact, 1}, triggers)(wrong, {}, 0.2), ratio(wrong, {}));
}

TEST(ErrorRatio, LooksAtEightContacts) {
  std::vector<Contact> contacts(9, {ContactKind::surface, 0, {}, {0, 0, 1}, {0, 0, -0.01}, 100});
  const auto ratio = [&] { return ErrorRatio(0, {}, contacts, {.weber_fraction = 0.04})({0, 0, 0.0001}, {}); };
  const double before = ratio();
  contacts[8].stiffness = contacts[8].stiffness * 1000;
  contacts[8].device.z = -1e-6;
  EXPECT_EQ(ratio(), before);
  contacts[7] = contacts[8];
  EXPECT_GT(ratio(), before);
}

}  // namespace
}  // namespace tactus
