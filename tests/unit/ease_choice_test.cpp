// SPDX-License-Identifier: Apache-2.0
#include <tactus/rigid/encoder_choices.h>

#include <gtest/gtest.h>

namespace tactus {
namespace {

const RigidTriggers kTriggers{.visual_position = 0.001, .visual_rotation = 0.05};
const ErrorShare kShare(0, {}, {}, kTriggers);

UpdateCourse course(double offset, double drift, double acceleration) {
  return {{{offset, 0, 0}, {}}, {}, {{drift, 0, 0}, {}}, {{acceleration, 0, 0}, {}}};
}

TEST(EaseChoice, TakesSixteenMillisecondsWhereTheNewPathIsRight) {
  EXPECT_EQ(longest_ease(course(-0.001, 0, 0), kShare, 1000), 4);
  EXPECT_EQ(longest_ease(course(-0.001, 0, 0), kShare, 8000), 7) << "the longest there is";
  EXPECT_EQ(longest_ease(course(-0.001, 0, 0), kShare, 148), 1);
  EXPECT_EQ(longest_ease(course(-0.001, 0, 0), kShare, 60), 0) << "two ticks are longer than that";
  EXPECT_EQ(longest_ease(course(-0.001, 0, 0), kShare, 1), 0);
}

/// The error that grows and the offset that shrinks are on the same side, or on different ones.
TEST(EaseChoice, IsShorterWhereTheErrorGrowsOnTheSideOfTheOffset) {
  const auto ease = [](double drift) { return longest_ease(course(-0.001, drift, 0), kShare, 1000); };
  EXPECT_EQ(ease(0.03), 4);
  int before = 4;
  for (const double drift : {-0.02, -0.05, -0.1, -0.2, -0.5}) {
    EXPECT_LE(ease(drift), before) << drift;
    before = ease(drift);
  }
  EXPECT_EQ(before, 0);
  EXPECT_LT(longest_ease(course(-0.001, 0, 10), kShare, 1000), 4) << "the truth runs away from where it is shown";
  EXPECT_EQ(longest_ease(course(-0.001, 0, -5), kShare, 1000), 4);
}

/// An offset that the force permits now is gone before the force is.
TEST(EaseChoice, IsShorterWhereTheForceSinks) {
  const Contact contact{ContactKind::surface, 0, {}, {1, 0, 0}, {-0.001, 0, 0}, 1000};
  const auto ease = [&](double sinking) {
    const ErrorShare share(0, {}, {&contact, 1}, {.weber_fraction = 0.04}, sinking);
    return longest_ease(course(-0.000036, 0, 0), share, 1000);
  };
  EXPECT_EQ(ease(0), 4);
  EXPECT_EQ(ease(20), 4) << "a third in 16 ms";
  EXPECT_LT(ease(60), 4);
  EXPECT_GT(ease(60), 0);
  EXPECT_LT(ease(200), ease(60));
}

TEST(EaseChoice, RotationCountsAsWell) {
  const UpdateCourse turned{{{}, {0, 0.05, 0}}, {}, {{}, {0, 40, 0}}, {}};
  EXPECT_LT(longest_ease(turned, kShare, 1000), 2);
  const auto ease = [](double acceleration) {
    return longest_ease({{{}, {0, -0.02, 0}}, {{}, {0, -0.02, 0}}, {}, {{}, {0, acceleration, 0}}}, kShare, 1000);
  };
  EXPECT_LT(ease(250), 4) << "the truth turns away from where it is shown";
  EXPECT_EQ(ease(-250), 4);
}

/// The error leaves its bounds in the first quarter of 16 ms and is back before the half.
TEST(EaseChoice, LooksAtTheFirstQuarter) {
  EXPECT_LT(longest_ease(course(0.001, 0.08, 16), kShare, 1000), 4);
  EXPECT_EQ(longest_ease(course(0.001, 0.07, 16), kShare, 1000), 4);
}

}  // namespace
}  // namespace tactus
