// SPDX-License-Identifier: Apache-2.0
#include <tactus/metrics/delay_tolerance.h>

#include <gtest/gtest.h>

namespace tactus {
namespace {

constexpr double kStiffness = 700, kWeber = 0.1;

/// Thesis 4.2.4.1: 18 ms; the Jenga block of 4.2.4.3 (0.3 kg, mu 0.45, d 0.995): 4.0 ms at 0.05 m/s, 2.1 ms at 0.1 m/s.
TEST(TolerableRoundTrip, IsThatOfTheThesis) {
  EXPECT_NEAR(*tolerable_round_trip({-12.6, 0, 0}, {0.1, 0, 0}, kStiffness, kWeber), 0.018, 1e-12);
  const double friction = 0.45 * 0.3 * 9.81, damping = 0.3 * (1 - 0.995 * 0.995) / 2e-3;
  for (const auto& [speed, expected] : {std::pair{0.05, 4.0e-3}, std::pair{0.1, 2.1e-3}}) {
    const auto most = tolerable_round_trip({0, -(friction + damping * speed), 0}, {0, speed, 0}, kStiffness, kWeber);
    ASSERT_TRUE(most);
    EXPECT_NEAR(*most, expected, 5e-5);
  }
}

TEST(TolerableRoundTrip, OnlyMotionAgainstTheForceCounts) {
  const Vec3 force{0, 0, 2};
  EXPECT_FALSE(tolerable_round_trip(force, {0, 0, 0.1}, kStiffness, kWeber)) << "lets go";
  EXPECT_FALSE(tolerable_round_trip(force, {0.3, 0.1, 0}, kStiffness, kWeber)) << "along the surface";
  EXPECT_FALSE(tolerable_round_trip(force, {}, kStiffness, kWeber));
  EXPECT_FALSE(tolerable_round_trip({}, {0, 0, -0.1}, kStiffness, kWeber));
  EXPECT_EQ(tolerable_round_trip(force, {0.3, 0.1, -0.1}, kStiffness, kWeber),
            tolerable_round_trip(force, {0, 0, -0.1}, kStiffness, kWeber));
}

class Tolerance : public ::testing::Test {
 protected:
  Tolerance() {
    info_.objects = {{"cube"}};
    info_.users = {{"hand"}};
    frame_.objects.resize(1);
    frame_.users.resize(1);
  }
  void push(DelayTolerance& tolerance, int ticks, double speed, double force, int step = 1) {
    UserSample& user = frame_.users[0];
    for (int i = 0; i < ticks; ++i) {
      user.device.position.x += 1e-3 * step * speed;
      user.contact.kind = ContactKind::surface;
      user.contact.stiffness = kStiffness;
      user.server_force = {-force, 0, 0};
      tolerance.add(frame_);
      frame_.tick += step;
    }
  }
  TraceInfo info_;
  TraceFrame frame_;
};

TEST_F(Tolerance, CountsTheTicksInWhichARoundTripIsFelt) {
  DelayTolerance tolerance(info_, kWeber);
  push(tolerance, 1, 0.1, 12.6);                           // no velocity yet
  for (int i = 0; i < 9; ++i) push(tolerance, 1, 0.1, 0);  // no force
  push(tolerance, 300, 0.1, 12.6);                         // 18 ms
  push(tolerance, 12, 0, 12.6);                            // until it has stopped
  push(tolerance, 100, 0, 12.6);
  ASSERT_EQ(tolerance.touches().size(), 1u);
  const auto& [pair, touch] = *tolerance.touches().begin();
  EXPECT_EQ(pair.object, 0u);
  EXPECT_EQ(touch.ticks(), 421u);
  EXPECT_GE(touch.pressing(), 300u);
  EXPECT_LE(touch.pressing(), 309u);
  EXPECT_NEAR(*touch.quantile(0.5), 0.018, 2e-4);
  EXPECT_EQ(touch.felt(0), 0);                    // 10 ms
  EXPECT_NEAR(touch.felt(1), 300 / 421.0, 0.01);  // 25 ms
}

TEST_F(Tolerance, APauseIsNoMotion) {
  DelayTolerance tolerance(info_, kWeber);
  push(tolerance, 20, 0, 1);
  frame_.tick += 5000;
  frame_.users[0].device.position.x += 1;
  push(tolerance, 20, 0, 1);
  EXPECT_EQ(tolerance.touches().begin()->second.pressing(), 0u);
  EXPECT_FALSE(tolerance.touches().begin()->second.quantile(0.5));
}

/// 100 Hz: a tick is longer than the window of the velocity.
TEST_F(Tolerance, SparseTicksHaveAVelocityToo) {
  info_.tick_rate = 100;
  DelayTolerance tolerance(info_, kWeber);
  push(tolerance, 50, 1, 12.6);  // 1 mm per tick of 10 ms: 0.1 m/s
  EXPECT_EQ(tolerance.touches().begin()->second.pressing(), 49u);
  EXPECT_NEAR(*tolerance.touches().begin()->second.quantile(0.5), 0.018, 2e-4);
}

TEST_F(Tolerance, MeshesAreApart) {
  info_.meshes.resize(1);
  DelayTolerance tolerance(info_, kWeber);
  SurfaceContact contact;
  contact.stiffness = kStiffness;
  for (int i = 0; i < 10; ++i) {
    frame_.users[0].surface_contact = contact;
    frame_.users[0].device.position.z -= 1e-4;
    frame_.users[0].server_force = {0, 0, 12.6};
    tolerance.add(frame_);
    ++frame_.tick;
  }
  ASSERT_EQ(tolerance.touches().size(), 1u);
  EXPECT_TRUE(tolerance.touches().begin()->first.is_mesh);
  EXPECT_EQ(tolerance.touches().begin()->second.pressing(), 9u);
}

}  // namespace
}  // namespace tactus
