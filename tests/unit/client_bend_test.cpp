// SPDX-License-Identifier: Apache-2.0
#include <tactus/client/replica.h>

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/smooth_motion.h"

namespace tactus {
namespace {

using testing::along;
using testing::scene_of;

double distance(const RigidPose& a, const RigidPose& b) {
  const unsigned exponent = scene_of(1)->grid.position;
  return norm(to_pose(a, exponent).position - to_pose(b, exponent).position);
}
double angle(const RigidPose& a, const RigidPose& b) { return angle_between(to_pose(a, 22).rotation, to_pose(b, 22).rotation); }

TEST(Bend, MeetsBothUpdatesAndTheMotionBetween) {
  const SharedScene scene = scene_of(1);
  const RigidPredictor predictor(*scene);
  for (const std::int64_t length : {20, 60, 300}) {
    const RigidState a = along(400, true), b = along(400 + length, true);
    const RigidPose first = bend(*scene, a, b, 400), last = bend(*scene, a, b, 400 + length - 1);
    EXPECT_EQ(first, (RigidPose{a.position, a.rotation}));
    EXPECT_LT(distance(last, {b.position, b.rotation}), 2e-3);
    double worst = 0, turned = 0, reckoned = 0;
    for (std::int64_t tick = 400; tick < 400 + length; ++tick) {
      const RigidState truth = along(tick, true);
      const RigidPose shown = bend(*scene, a, b, tick), at{truth.position, truth.rotation};
      worst = std::max(worst, distance(shown, at));
      turned = std::max(turned, angle(shown, at));
      reckoned = std::max(reckoned, distance(predictor.pose(a, tick), at));
    }
    const double t = 1e-3 * static_cast<double>(length);
    EXPECT_LT(worst, 1e-5 + 8.1 * t * t * t * t / 384) << "of fourth order: the largest fourth derivative is 0.1 * 3^4 m/s^4";
    EXPECT_LT(turned, 1e-4 + 12 * t * t * t * t / 384) << length;
    EXPECT_GT(reckoned, 5 * worst) << "dead reckoning is of second order";
  }
}

TEST(Bend, WithoutVelocitiesTheWayIsStraight) {
  const SharedScene scene = scene_of(1);
  const RigidState a = along(400, false), b = along(500, false);
  const RigidPose from{a.position, a.rotation}, to{b.position, b.rotation};
  for (std::int64_t tick = 400; tick < 500; ++tick) {
    const double share = static_cast<double>(tick - 400) / 100;
    const RigidPose shown = bend(*scene, a, b, tick);
    EXPECT_NEAR(distance(from, shown), share * distance(from, to), 1e-6);
    EXPECT_NEAR(angle(from, shown), share * angle(from, to), 1e-6);
  }
}

}  // namespace
}  // namespace tactus
