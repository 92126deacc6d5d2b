// SPDX-License-Identifier: Apache-2.0
// What a run was like at a hand, and what a hand bears: sim/user/touch_record.h, sim/user/sampled_limit.h.
#include "sim/user/touch_record.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/user/sampled_limit.h"

namespace tactus {
namespace {

UserSample pressing(const Vec3& force) {
  UserSample sample;
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
    record.add(touches(tick) ? pressing({0, 0, 1}) : UserSample{}, {});
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
    record.add(depth > 0 ? pressing({0, 0, force}) : UserSample{}, {0, 0, -depth});
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

TEST(TouchRecord, RemembersWhereADeformableWasPressedHardest) {
  TouchRecord record;
  for (const double force : {0.5, 2.0, 1.0}) {
    UserSample sample;
    sample.server_force = {0, 0, force};
    sample.mesh_contact.emplace().triangle = static_cast<std::uint32_t>(10 * force);
    record.add(sample, {});
  }
  ASSERT_TRUE(record.summary().hardest);
  EXPECT_EQ(record.summary().hardest->triangle, 20U);
  EXPECT_EQ(record.summary().contacts, 1U);
}

/// How far a hand strays that is held by a spring at where it starts, but for a blow at the beginning; with the device's real filter.
double strays(const HandImpedance& wanted, SceneDevice device, double stiffness) {
  device.resolution = 1e-12;
  SceneUser user;
  user.device = device;
  const Grip grip = wanted.mass < 0.15 ? Grip::loose : wanted.mass < 0.25 ? Grip::normal : Grip::firm;
  Hand hand(user, grip, 1);
  Vec3 felt{0, 0, 1};
  double early = 0, late = 0;
  for (int tick = 0; tick < 6000; ++tick) {
    const Vec3 at = hand.step(felt, {}).position;
    felt = -stiffness * at;
    (tick < 1000 ? early : late) = std::max(tick < 1000 ? early : late, norm(hand.position()));
    if (late > 1) break;
  }
  return late / early;
}

/// Measured by the hand itself: below the limit it comes to rest, above it swings up.
TEST(SampledLimit, IsWhereTheHandBeginsToSwing) {
  for (const Grip grip : {Grip::loose, Grip::normal, Grip::firm}) {
    for (const std::uint32_t filter : {1U, 2U, 3U, 8U, 9U, 32U}) {
      SceneDevice device;
      device.filter = filter;
      const HandImpedance hand = hand_impedance(grip);
      const double limit = sampled_limit(hand, device);
      ASSERT_GT(limit, 0);
      EXPECT_LT(strays(hand, device, 0.97 * limit), 1) << "filter " << filter << ", " << limit << " N/m";
      EXPECT_GT(strays(hand, device, 1.03 * limit), 1) << "filter " << filter << ", " << limit << " N/m";
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
}  // namespace tactus
