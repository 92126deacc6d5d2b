// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/trigger.h>

#include <cmath>

#include <gtest/gtest.h>

#include "tests/unit/rigid_fixture.h"

namespace tactus {
namespace {

TEST(RigidTrigger, IsotropicZoneIsASphere) {
  RigidTriggers t;
  t.weber_fraction = 0.1;
  const Vec3 force{0, 0, 2};
  EXPECT_NEAR(haptic_ratio(t, force, {0, 0, 2.2}), 1, 1e-12);
  EXPECT_NEAR(haptic_ratio(t, force, {0.2, 0, 2}), 1, 1e-12);
  EXPECT_NEAR(haptic_ratio(t, force, {0, 0, 1.9}), 0.5, 1e-12);
  EXPECT_NEAR(haptic_ratio(t, {}, {0, 0, 0.005}), 1, 1e-12) << "at the floor of 0.05 N";
}

TEST(RigidTrigger, ConeJudgesSizeAndDirectionApart) {
  RigidTriggers t;
  t.haptic = HapticRule::cone;
  t.weber_fraction = 0.18;
  t.cone_angle = 0.05;
  const Vec3 force{0, 0, 1};
  EXPECT_NEAR(haptic_ratio(t, force, {0, 0, 1.18}), 1, 1e-12);
  EXPECT_NEAR(haptic_ratio(t, force, {std::sin(0.05), 0, std::cos(0.05)}), 1, 1e-9);
  EXPECT_NEAR(haptic_ratio(t, force, {1.18 * std::sin(0.025), 0, 1.18 * std::cos(0.025)}), 1, 1e-9)
      << "the larger of both counts";
  EXPECT_GT(haptic_ratio(t, force, {0, 0, -1}), 1) << "opposite";
  EXPECT_LT(haptic_ratio(t, {0, 0, 0.01}, {0.01, 0, 0}), 1) << "below the floor direction means nothing";
}

TEST(RigidTrigger, OtherRulesDoNotLookAtForces) {
  RigidTriggers t;
  t.haptic = HapticRule::off;
  EXPECT_EQ(haptic_ratio(t, {0, 0, 1}, {9, 9, 9}), 0);
  t.haptic = HapticRule::fixed;
  EXPECT_EQ(haptic_ratio(t, {0, 0, 1}, {9, 9, 9}), 0);
}

TEST(RigidTrigger, PerceptualFollowsTheCurveTimesItsFraction) {
  RigidTriggers t{.haptic = HapticRule::perceptual, .weber_fraction = 1e-6};
  EXPECT_NEAR(haptic_ratio(t, {0, 0, 2.5}, {0, 0.25, 2.5}), 1, 1e-12);
  EXPECT_NEAR(haptic_ratio(t, {0, 0, 0.3}, {0, 0, 0.3 * 1.22}), 1, 1e-12);
  EXPECT_NEAR(haptic_ratio(t, {}, {0.05 * 0.22, 0, 0}), 1, 1e-12) << "at the floor of 0.05 N";
  t.perceptual_fraction = 0.5;
  EXPECT_NEAR(haptic_ratio(t, {0, 0, 1}, {0, 0, 1.07}), 1, 1e-12);
  t.force_floor = 1;
  EXPECT_NEAR(haptic_ratio(t, {0, 0, 0.2}, {0, 0, 0.27}), 1, 1e-12) << "a force below the floor is judged as one at it";
  double before = 0;
  for (int i = 0; i < 400; ++i) {
    const double budget = force_budget({.haptic = HapticRule::perceptual}, 0.01 * i);
    EXPECT_GE(budget, before) << "a larger force never permits a smaller error";
    before = budget;
  }
}

TEST(RigidTrigger, NoForceInsideAnIsotropicDeadzoneLeavesItsAngle) {
  for (const double p : {0.01, 0.037, 0.187, 0.9}) {
    const double angle = isotropic_angle(p);
    const Vec3 tangent{p * std::cos(angle), 0, -p * std::sin(angle)};  // from the tip of the force to where the sphere is touched
    const Vec3 estimate = Vec3{0, 0, 1} + tangent;
    EXPECT_NEAR(std::atan2(estimate.x, estimate.z), angle, 1e-12);
    EXPECT_NEAR(dot(estimate, tangent), 0, 1e-12);
  }
  EXPECT_NEAR(isotropic_angle(0.037) * 180 / 3.14159265, 2.1, 0.03) << "thesis 3.2.4.5";
  EXPECT_NEAR(isotropic_angle(0.187) * 180 / 3.14159265, 10.8, 0.03);
  EXPECT_GT(isotropic_angle(1), 3.1);
}

TEST(RigidTrigger, PerceptualCurveFollowsItsPoints) {
  EXPECT_DOUBLE_EQ(weber_fraction_at(0), 0.22);
  EXPECT_DOUBLE_EQ(weber_fraction_at(0.3), 0.22);
  EXPECT_DOUBLE_EQ(weber_fraction_at(0.5), 0.17);
  EXPECT_DOUBLE_EQ(weber_fraction_at(0.75), 0.155);
  EXPECT_DOUBLE_EQ(weber_fraction_at(1.0), 0.14);
  EXPECT_DOUBLE_EQ(weber_fraction_at(2.5), 0.10);
  EXPECT_DOUBLE_EQ(weber_fraction_at(100), 0.10);
}

TEST(RigidTrigger, SurfaceForceIsNormalAndOnlyPushes) {
  const Pose pose{{1, 2, 3}, {std::cos(0.3), 0, std::sin(0.3), 0}};
  const Contact c = testing::touch(0, pose, 0.002);
  const Vec3 force = contact_force(c, pose), normal = rotate(pose.rotation, c.normal);
  EXPECT_NEAR(norm(force), 630 * 0.002, 1e-9);
  EXPECT_NEAR(norm(cross(force, normal)), 0, 1e-9);
  Pose away = pose;
  away.position = pose.position - 0.003 * normal;
  EXPECT_EQ(contact_force(c, away), (Vec3{})) << "a face does not pull";
}

TEST(RigidTrigger, SpringForceIsTheWholeVector) {
  Contact c;
  c.kind = ContactKind::spring;
  c.stiffness = 68;
  c.point = {0.02, 0, 0};
  c.device = {0.02, 0.01, -0.03};
  const Vec3 force = contact_force(c, {});
  EXPECT_NEAR(force.x, 0, 1e-12);
  EXPECT_NEAR(force.y, -0.68, 1e-12);
  EXPECT_NEAR(force.z, 2.04, 1e-12);
}

}  // namespace
}  // namespace tactus
