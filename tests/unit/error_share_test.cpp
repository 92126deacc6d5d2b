// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/encoder_choices.h>

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include <tactus/base/geometry.h>

namespace tactus {
namespace {

Pose moved(const Pose& pose, const Vec3& by, const Vec3& turn) {
  const double angle = norm(turn), half = angle / 2;
  const Vec3 axis = angle > 0 ? (std::sin(half) / angle) * turn : Vec3{};
  return {pose.position + by, Quat{std::cos(half), axis.x, axis.y, axis.z} * pose.rotation};
}

/// Held against the rule itself, for errors so small that the first order is all there is.
TEST(ErrorShare, IsTheRatioOfTheRuleForSmallErrors) {
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
    EXPECT_NEAR(ErrorShare(0, truth, {&contact, 1}, triggers)(by, turned), ratio, 0.02 * ratio + 1e-6) << round;
  }
}

TEST(ErrorShare, TheNarrowestBoundCounts) {
  const RigidTriggers seen{.visual_position = 0.002, .visual_rotation = 0.05};
  const ErrorShare free(0, {}, {}, seen);
  EXPECT_NEAR(free({0, 0.001, 0}, {}), 0.5, 1e-12);
  EXPECT_NEAR(free({0, 0.001, 0}, {0.04, 0, 0}), 0.8, 1e-12);
  std::vector<Contact> contacts{{ContactKind::surface, 1, {}, {0, 0, 1}, {0, 0, -0.001}, 1000},
                                {ContactKind::none, 0, {}, {0, 0, 1}, {0, 0, -0.001}, 1000}};
  EXPECT_EQ(ErrorShare(0, {}, contacts, seen)({0, 0, 0.001}, {}), free({0, 0, 0.001}, {})) << "of another object, and of none";
  contacts[0].object = 0;
  EXPECT_NEAR(ErrorShare(0, {}, contacts, {.weber_fraction = 0.1})({0, 0, 0.0005}, {}), 5, 1e-9) << "0.5 N off at 1 N";
  EXPECT_NEAR(ErrorShare(0, {}, contacts, {.haptic = HapticRule::fixed, .fixed_position = 0.001})({0.0005, 0, 0}, {}), 0.5, 1e-9);
  EXPECT_NEAR(ErrorShare(0, {}, contacts, {.haptic = HapticRule::cone, .cone_angle = 0.01})({}, {0.005, 0, 0}), 0.5, 1e-9);
  EXPECT_LT(ErrorShare(0, {}, contacts, {.haptic = HapticRule::off})({0, 0, 0.0005}, {}), 0.1);
}

/// What is permitted at a force that sinks by a tenth per 10 ms, down to what is permitted at the floor; what is seen stays.
TEST(ErrorShare, AForceThatSinksLeavesLessLater) {
  const Contact contact{ContactKind::surface, 0, {}, {0, 0, 1}, {0, 0, -0.001}, 1000};
  const RigidTriggers triggers{.visual_position = 0.01, .weber_fraction = 0.1, .force_floor = 0.2};
  const ErrorShare share(0, {}, {&contact, 1}, triggers, 10);
  const Vec3 wrong{0, 0, 0.00005};
  EXPECT_NEAR(share(wrong, {}), 0.5, 1e-9);
  EXPECT_NEAR(share(wrong, {}, 0.01), 0.5 / 0.9, 1e-9);
  EXPECT_NEAR(share(wrong, {}, 0.05), 1, 1e-9);
  EXPECT_NEAR(share(wrong, {}, 0.2), 0.5 / 0.2, 1e-9);
  EXPECT_EQ(share({0.001, 0, 0}, {}, 0.2), share({0.001, 0, 0}, {}));
  EXPECT_EQ(ErrorShare(0, {}, {&contact, 1}, triggers)(wrong, {}, 0.2), share(wrong, {}));
}

TEST(ErrorShare, LooksAtEightContacts) {
  std::vector<Contact> contacts(9, {ContactKind::surface, 0, {}, {0, 0, 1}, {0, 0, -0.01}, 100});
  const auto share = [&] { return ErrorShare(0, {}, contacts, {.weber_fraction = 0.04})({0, 0, 0.0001}, {}); };
  const double before = share();
  contacts[8].stiffness = contacts[8].stiffness * 1000;
  contacts[8].device.z = -1e-6;
  EXPECT_EQ(share(), before);
  contacts[7] = contacts[8];
  EXPECT_GT(share(), before);
}

}  // namespace
}  // namespace tactus
