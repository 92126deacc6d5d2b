// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/transparency/transparency.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace tactus::sim {
namespace {

using Complex = std::complex<double>;

constexpr RigidCoupling kCube{
    .mass = 0.25, .damping = 0.25, .client_stiffness = 500, .server_stiffness = 700, .forward = 0.02, .backward = 0.03};

/// The tower's block of the thesis at a velocity: 0.3 kg, friction 0.45, velocities times 0.995 per millisecond.
SteadyPush block(double velocity) {
  return {.velocity = velocity, .damping = damping_of_factor(0.3, 0.995, 1e-3), .external = 0.45 * 0.3 * 9.81};
}

TEST(RigidTransparency, PadeHasTheMagnitudeOfADelayAndItsPhaseAtLowFrequencies) {
  for (const double omega : {0.1, 1.0, 10.0, 100.0}) EXPECT_NEAR(std::abs(delay_factor(omega, 0.05, DelayModel::pade)), 1, 1e-12);
  const double limit = pade_limit(0.05);
  EXPECT_NEAR(limit, 6.667, 1e-3);
  EXPECT_NEAR(std::arg(delay_factor(limit, 0.05, DelayModel::pade)), -limit * 0.05, 0.004);
  EXPECT_GT(std::abs(std::arg(delay_factor(8 * limit, 0.05, DelayModel::pade)) + 8 * limit * 0.05), 0.3);
  EXPECT_TRUE(std::isinf(pade_limit(0)));
  EXPECT_EQ(delay_factor(3, 0, DelayModel::exact), Complex(1));
}

/// Equations 4.7 and 4.8 as the thesis writes them out.
TEST(RigidTransparency, ResponsesWithPadeAreTheFractionsOfTheThesis) {
  const auto& [m, b, kc, ks, bc, bs, forward, backward] = kCube;
  const double r = kCube.round_trip();
  for (const double omega : {0.3, 3.0, 30.0, 300.0}) {
    const Complex s(0, omega);
    const Complex velocity = (s * s * (kc * m * r / 2) + s * (m * kc + b * kc * r / 2) + kc * ks * r + b * kc) /
                             (s * s * s * (m * r / 2) + s * s * (m + b * r / 2) + s * (ks * r / 2 + b) + ks);
    EXPECT_LT(std::abs(force_by_velocity(kCube, omega, DelayModel::pade) - velocity), 1e-9 * std::abs(velocity)) << omega;
    const Complex resistance = (-kc * backward / 2 * s + kc) / (s * s * s * (m * backward / 2) + s * s * (m + b * backward / 2) +
                                                                s * (ks * backward / 2 + b) + ks);
    EXPECT_LT(std::abs(force_by_resistance(kCube, omega, DelayModel::pade) - resistance), 1e-9 * std::abs(resistance)) << omega;
  }
}

TEST(RigidTransparency, SlowlyTheResponsesAreThoseOfASteadyPush) {
  const double omega = 1e-5;
  for (const DelayModel model : {DelayModel::exact, DelayModel::pade}) {
    const double velocity = force_by_velocity(kCube, omega, model).real(),
                 force = force_by_resistance(kCube, omega, model).real();
    const SteadyPush push{.velocity = 0.1, .damping = kCube.damping, .external = 0.7, .others = 0.2};
    EXPECT_NEAR(velocity * push.velocity + force * (push.external - push.others), client_force(push, 500, 700, 0.05), 1e-6);
  }
}

/// A step of time simulates the same loop: a probe that moves on, a mass at the server, both delays.
TEST(RigidTransparency, ASimulatedPushSettlesAtTheSteadyForce) {
  constexpr double kStep = 1e-5, kVelocity = 0.1, kFriction = 0.6;
  const std::size_t forward = 2000, backward = 3000;  // steps
  std::vector<double> probe{0}, object{0};
  double speed = 0, force = 0;
  for (std::size_t i = 1; i <= 200'000; ++i) {
    probe.push_back(kVelocity * kStep * static_cast<double>(i));
    const double at_server = i > forward ? probe[i - forward] : 0, at_client = i > backward ? object[i - backward] : 0;
    const double pull = 700 * (at_server - object.back()) - (kCube.damping + 20) * speed - (speed > 0 ? kFriction : 0);
    speed = std::max(speed + kStep / kCube.mass * pull, 0.0);
    object.push_back(object.back() + kStep * speed);
    force = 500 * (probe.back() - at_client);
  }
  const SteadyPush push{.velocity = kVelocity, .damping = kCube.damping + 20, .external = kFriction};
  EXPECT_NEAR(force, client_force(push, 500, 700, 0.05), 1e-3);
}

TEST(RigidTransparency, DampingOfAFactor) {
  EXPECT_NEAR(damping_of_factor(0.25, 0.999, 1e-3), 0.2499, 5e-5);
  double speed = 1;
  for (int i = 0; i < 100; ++i) speed *= 0.999;
  EXPECT_NEAR(std::exp(-0.1 * damping_of_factor(0.25, 0.999, 1e-3) / 0.25), speed, 1e-4);
  EXPECT_EQ(damping_of_factor(1, 1, 1e-3), 0);
}

TEST(RigidTransparency, TheBlockOfTheTower) {
  EXPECT_NEAR(*tolerable_delay(block(0.05), 700, 0.1), 4.0e-3, 5e-5);
  EXPECT_NEAR(*tolerable_delay(block(0.1), 700, 0.1), 2.1e-3, 5e-5);
  EXPECT_NEAR(reduced_stiffness(block(0.05), 700, 0.05), 311, 0.5);
  EXPECT_NEAR(reduced_stiffness(block(0.1), 700, 0.05), 207, 0.5);
}

TEST(RigidTransparency, AtTheTolerableDelayTheForceIsTheShareAbove) {
  for (const double others : {0.0, 0.5, -0.4}) {
    SteadyPush push = block(0.08);
    push.others = others;
    const double delay = *tolerable_delay(push, 700, 0.1);
    EXPECT_NEAR(client_force(push, 700, 700, delay), 1.1 * push.server_force(), 1e-12);
    EXPECT_NEAR(excess_force(push.velocity, 700, delay), 0.1 * push.server_force(), 1e-12);
    const double change = *tolerable_change(push, 700, 0.05, 0.1);
    EXPECT_NEAR(client_force(push, 700, 700, 0.05 + change), 1.1 * client_force(push, 700, 700, 0.05), 1e-12);
    EXPECT_NEAR(client_force(push, reduced_stiffness(push, 700, 0.05), 700, 0.05), push.server_force(), 1e-12);
  }
  EXPECT_FALSE(tolerable_delay(block(0), 700, 0.1));
  EXPECT_FALSE(tolerable_change(block(0), 700, 0.05, 0.1));
  EXPECT_EQ(reduced_stiffness(SteadyPush{}, 700, 0.05), 700);
}

TEST(RigidTransparency, InThreeDimensionsTheShareAlongTheMotionCounts) {
  const Vec3 velocity{0.06, 0, 0.08};
  EXPECT_NEAR(resistive_force({1, 5, 2}, velocity), -(0.6 * 1 + 0.8 * 2), 1e-12);
  EXPECT_GT(resistive_force({-1, 0, 0}, velocity), 0);
  EXPECT_EQ(resistive_force({1, 1, 1}, {}), 0);
  const SteadyPush push = block(0.1);
  EXPECT_NEAR(reduced_stiffness(-push.server_force(), 0.1, 700, 0.05, 1), reduced_stiffness(push, 700, 0.05), 1e-9);
  EXPECT_EQ(reduced_stiffness(-1, 0.1, 700, 0.05, 0), 700);
  EXPECT_NEAR(*tolerable_delay(-push.server_force(), 0.1, 700, 0.1), *tolerable_delay(push, 700, 0.1), 1e-12);
  EXPECT_NEAR(*tolerable_change(-push.server_force(), 0.1, 700, 0.05, 0.1), *tolerable_change(push, 700, 0.05, 0.1), 1e-12);
  EXPECT_FALSE(tolerable_delay(-1, 0, 700, 0.1));
  EXPECT_FALSE(tolerable_change(-1, 0, 700, 0.05, 0.1));
}

TEST(RigidTransparency, BlendingByTheAngleBetweenFaceAndConstraint) {
  EXPECT_NEAR(blending({0, 0, 1}, {1, 0, 0}), 1, 1e-12);
  EXPECT_NEAR(blending({0, 0, 1}, {0, 0, -1}), 0, 1e-12);
  EXPECT_NEAR(blending({0, 0, 1}, {0, std::sqrt(0.5), std::sqrt(0.5)}), 0.5, 1e-12);
  EXPECT_EQ(blending({0, 0, 1}, {0, 0, 1 + 1e-15}), 0);  // rounding
}

}  // namespace
}  // namespace tactus::sim
