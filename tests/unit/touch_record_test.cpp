// SPDX-License-Identifier: Apache-2.0
// What a run was like at a hand, and what a hand tolerates: sim/user/passivity.h, sim/user/passivity.h.
#include <tactus/sim/user/passivity.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace tactus::sim {
namespace {

UserSample at(const Vec3& position) { return {.device = {.position = position}, .contact = {}, .force = {}, .server_force = {}}; }

UserSample pressing(const Vec3& force, const Vec3& position = {}) {
  UserSample sample = at(position);
  sample.contact.kind = ContactKind::surface;
  sample.force = force;
  return sample;
}

TEST(TouchRecord, CountsContactsAndThoseOfTheWorstSecond) {
  TouchRecord record;
  // 5 contacts a second for three seconds, then 20 within one, then silence
  const auto touches = [](int tick) { return tick < 3000 ? tick % 200 < 50 : tick < 4000 && tick % 50 < 10; };
  std::uint64_t in_contact = 0;
  for (int tick = 0; tick < 6000; ++tick) {
    record.add(touches(tick) ? pressing({0, 0, 1}) : UserSample{});
    in_contact += touches(tick) ? 1U : 0U;
  }
  const TouchSummary& all = record.summary();
  EXPECT_EQ(all.ticks, in_contact);
  EXPECT_EQ(all.contacts, 15U + 20U);
  EXPECT_EQ(all.most_in_a_second, 20U);
  EXPECT_EQ(all.largest_force, 1);
  EXPECT_FALSE(all.hardest);
}

/// A spring that is sampled gives away k d times the depth; a contact before it that took energy does not hide it.
TEST(TouchRecord, TheEnergyOfEachContactIsItsOwn) {
  constexpr double kStep = 1e-4, kStiffness = 1000;
  TouchRecord record;
  const auto go = [&](double depth, double force) {
    record.add(depth > 0 ? pressing({0, 0, force}, {0, 0, -depth}) : at({0, 0, -depth}));
  };
  for (int i = 0; i < 100; ++i) go(i * kStep, 5.0);  // as through honey: all is taken
  go(99 * kStep, 0);
  go(0, 0);
  EXPECT_EQ(record.summary().lowest_energy, 0);
  for (int i = 1; i <= 50; ++i) go(i * kStep, kStiffness * i * kStep);
  for (int i = 49; i >= 0; --i) go(i * kStep, kStiffness * i * kStep);
  EXPECT_NEAR(record.summary().lowest_energy, -kStiffness * kStep * 50 * kStep, 1e-12);
  EXPECT_EQ(record.summary().contacts, 2U);
}

/// To and fro four times: a push from outside is none, nor is slow motion, nor what the hand is to do itself.
TEST(TouchRecord, SwingsOfAHandThatHoldsStill) {
  using Aim = TouchRecord::Aim;
  const auto swing = [](auto&& position, Aim aim) {
    TouchRecord record;
    for (int tick = 0; tick < 4000; ++tick) record.add(pressing({1, 0, 0}, {position(1e-3 * tick), 0, 0}), aim);
    return record.summary().swing;
  };
  const auto wave = [](double hertz) { return [hertz](double t) { return 2e-3 * std::sin(2 * 3.14159265 * hertz * t); }; };
  EXPECT_NEAR(swing(wave(3), Aim::rests), 4e-3, 1e-6);
  EXPECT_GT(swing([&](double t) { return 1e-2 * t + wave(3)(t); }, Aim::rests), 2e-3) << "on a path";
  EXPECT_EQ(swing(wave(3), Aim::moves), 0);
  EXPECT_EQ(swing(wave(3), Aim::unknown), 0);
  EXPECT_EQ(swing(wave(0.5), Aim::rests), 0) << "four within two seconds";
  EXPECT_EQ(swing([](double t) { return t > 1 && t < 1.5 ? 5e-3 : 0.0; }, Aim::rests), 0);
  EXPECT_LT(swing([&](double t) { return std::exp(-8 * t) * wave(3)(t); }, Aim::rests), 1e-3) << "dies away";
}

TEST(TouchRecord, RemembersWhereADeformableWasPressedHardest) {
  TouchRecord record;
  for (const double force : {0.5, 2.0, 1.0}) {
    UserSample sample;
    sample.server_force = {0, 0, force};
    sample.surface_contact.emplace().triangle = static_cast<std::uint32_t>(10 * force);
    record.add(sample);
  }
  ASSERT_TRUE(record.summary().hardest);
  EXPECT_EQ(record.summary().hardest->triangle, 20U);
  EXPECT_EQ(record.summary().contacts, 1U);
}

TEST(TouchRecord, RemembersTheStiffestCouplingThatWasTouched) {
  TouchRecord record;
  UserSample away;
  away.contact.stiffness = 9000;
  record.add(away);
  EXPECT_EQ(record.summary().stiffest, 0);
  UserSample rigid = pressing({0, 0, 1}), deformable;
  rigid.contact.stiffness = 500;
  deformable.surface_contact.emplace().stiffness = 300;
  record.add(deformable);
  EXPECT_EQ(record.summary().stiffest, 300);
  record.add(rigid);
  record.add(deformable);
  EXPECT_EQ(record.summary().stiffest, 500);
}

/// How far a hand strays late that a spring holds where it starts, as a multiple of how far it strays early, after a blow; with the
/// device's real filter.
double strays(Grip grip, SceneDevice device, double stiffness) {
  device.resolution = 1e-12;
  SceneUser user;
  user.device = device;
  Hand hand(user, grip, 1);
  Vec3 rendered{0, 0, 1};
  double early = 0, late = 0;  // the second quarter and the last one
  const int ticks = 6000 + 400 * static_cast<int>(device.filter);
  for (int tick = 0; tick < ticks; ++tick) {
    rendered = -stiffness * hand.step(rendered, {}).position;
    const double away = norm(hand.position());
    if (tick >= ticks / 4 && tick < ticks / 2) early = std::max(early, away);
    if (tick >= ticks - ticks / 4) late = std::max(late, away);
    if (away > 1) return 2;
  }
  return early > 1e-9 ? late / early : 0;  // less: it trembles by the encoders' steps
}

/// Measured by the hand itself: below the limit it comes to rest, above it swings up.
TEST(SampledLimit, IsWhereTheHandBeginsToSwing) {
  for (const Grip grip : {Grip::loose, Grip::normal, Grip::firm}) {
    for (const std::uint32_t filter : {1U, 2U, 3U, 8U, 9U, 32U, 33U, 200U, 1000U}) {
      SceneDevice device;
      device.filter = filter;
      const double limit = sampled_limit(hand_impedance(grip), device);
      ASSERT_GT(limit, 0);
      EXPECT_LT(strays(grip, device, 0.97 * limit), 1) << "filter " << filter << ", " << limit << " N/m";
      EXPECT_GT(strays(grip, device, 1.03 * limit), 1) << "filter " << filter << ", " << limit << " N/m";
    }
  }
}

TEST(SampledLimit, IsAboutDampingOverDelay) {
  const HandImpedance hand = hand_impedance(Grip::normal);
  const SceneDevice device{.filter = 8};
  const double delay = (8 - 1) * kTick / 2;
  EXPECT_NEAR(sampled_limit(hand, device) / (hand.damping / delay), 1, 0.15);
}

}  // namespace
}  // namespace tactus::sim
