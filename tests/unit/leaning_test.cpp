// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/encoder_choices.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/unit/rigid_fixture.h"

namespace tactus {
namespace {

using testing::only;
using testing::scene_of;

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
    out.read(tick, {&sample, 1});
  }
  return out;
}

/// What is told of the only object more than its velocities.
Acceleration::Motion lead_of(const Acceleration& acceleration, const RigidSample& now, std::span<const Contact> contacts,
                             const RigidTriggers& triggers) {
  return leaning(acceleration.of(0), ErrorShare(0, now.pose, contacts, triggers));
}

/// Its senders lean.
SharedScene eased_scene() {
  SceneSpec spec = testing::spec_of(1);
  spec.is_eased = true;
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

/// The velocity that is told leads to an error of 0.6 of the bound on the one side, if the acceleration fades as is taken.
TEST(Leaning, LeadsToTheShareOfTheBoundThatIsTaken) {
  constexpr double kTau = 0.03, kMargin = 0.6;
  RigidTriggers triggers;
  triggers.haptic = HapticRule::off;
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

TEST(Leaning, AnUpdateUnderAnAccelerationLastsLonger) {
  for (const double acceleration : {5.0, 20.0}) {
    const auto at = [&](std::int64_t tick) { return falling(acceleration, tick); };
    EXPECT_GT(packets(scene_of(1), 400, at), 1.7 * packets(eased_scene(), 400, at)) << acceleration;
  }
}

/// What is touched leans as the force permits, along the normal.
TEST(Leaning, TheForceBoundCountsWhereItIsTheNarrowest) {
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
TEST(Leaning, WhatTurnsLeansAsRotationAndForcePermit) {
  const SharedScene scene = scene_of(1);
  Acceleration fall(*scene);
  RigidSample now;
  for (std::int64_t tick = 0; tick < 3; ++tick) {
    now.angular_velocity = {0, 0, 0.08 * static_cast<double>(tick)};
    fall.read(tick, {&now, 1});
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

TEST(Leaning, FixedThresholdsOfWhatIsTouchedCount) {
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

TEST(Leaning, MotionWithoutAccelerationIsToldAsWithoutIt) {
  const auto steady = [](std::int64_t tick) {
    RigidSample out = falling(0, tick);
    out.velocity = {0.3, 0, 0};
    out.pose.position.x = 0.3 * kTick * static_cast<double>(tick);
    return out;
  };
  const auto told = [&](const SharedScene& scene) {
    auto sender = Sender::create(scene, without_heartbeat()).value();
    auto receiver = Receiver::create(scene).value();
    std::vector<std::array<std::int32_t, 3>> out;
    for (std::int64_t tick = 0; tick < 500; ++tick) {
      const RigidSample sample = steady(tick);
      const Packet packet = only(sender.encode(tick, {.objects = {&sample, 1}}));
      if (packet.bytes.empty()) continue;
      EXPECT_TRUE(receiver.push(packet.bytes));
      out.push_back(receiver.objects()[0].velocity);
    }
    return out;
  };
  const auto plain = told(scene_of(1));
  ASSERT_FALSE(plain.empty());
  EXPECT_EQ(told(eased_scene()), plain);
}

/// A call that is refused leaves no acceleration behind.
TEST(Leaning, RefusedTruthIsForgotten) {
  auto undisturbed = Sender::create(eased_scene(), without_heartbeat()).value();
  auto disturbed = Sender::create(eased_scene(), without_heartbeat()).value();
  for (std::int64_t tick = 0; tick < 600; tick += 2) {
    const RigidSample sample = falling(8, tick);
    RigidSample wrong = sample;
    wrong.velocity.x = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(disturbed.encode(tick, {.objects = {&wrong, 1}}));
    const Packet a = only(undisturbed.encode(tick, {.objects = {&sample, 1}}));
    const Packet b = only(disturbed.encode(tick, {.objects = {&sample, 1}}));
    ASSERT_TRUE(std::ranges::equal(a.bytes, b.bytes)) << tick;
  }
}

}  // namespace
}  // namespace tactus
