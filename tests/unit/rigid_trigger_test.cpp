// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/trigger.h>

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

TEST(RigidTrigger, PerceptualCurveFollowsItsPoints) {
  EXPECT_DOUBLE_EQ(perceptual_fraction(0), 0.22);
  EXPECT_DOUBLE_EQ(perceptual_fraction(0.3), 0.22);
  EXPECT_DOUBLE_EQ(perceptual_fraction(0.5), 0.17);
  EXPECT_DOUBLE_EQ(perceptual_fraction(0.75), 0.155);
  EXPECT_DOUBLE_EQ(perceptual_fraction(1.0), 0.14);
  EXPECT_DOUBLE_EQ(perceptual_fraction(2.5), 0.10);
  EXPECT_DOUBLE_EQ(perceptual_fraction(100), 0.10);
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
