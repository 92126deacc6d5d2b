// SPDX-License-Identifier: Apache-2.0
/// How transparent what is rendered is.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <tactus/sim/transparency/transparency.h>

namespace tactus::sim {
namespace {

// ==== rigid transparency ====

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

TEST(RigidTransparency, AtTheTolerableDelayTheForceIsTheFractionAbove) {
  for (const double others : {0.0, 0.5, -0.4}) {
    SteadyPush push = block(0.08);
    push.others = others;
    const double delay = *tolerable_delay(push, 700, 0.1);
    EXPECT_NEAR(client_force(push, 700, 700, delay), 1.1 * push.server_force(), 1e-12);
    const double change = *tolerable_change(push, 700, 0.05, 0.1);
    EXPECT_NEAR(client_force(push, 700, 700, 0.05 + change), 1.1 * client_force(push, 700, 700, 0.05), 1e-12);
    EXPECT_NEAR(client_force(push, reduced_stiffness(push, 700, 0.05), 700, 0.05), push.server_force(), 1e-12);
  }
  EXPECT_FALSE(tolerable_delay(block(0), 700, 0.1));
  EXPECT_FALSE(tolerable_change(block(0), 700, 0.05, 0.1));
  EXPECT_EQ(reduced_stiffness(SteadyPush{}, 700, 0.05), 700);
}

TEST(RigidTransparency, InThreeDimensionsTheFractionAlongTheMotionCounts) {
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

// ==== deformable transparency ====

/// Thesis, figures 4.20 to 4.22.
constexpr DeformableCoupling kObject{.object_stiffness = 100,
                                     .object_damping = 2,
                                     .object_mass = 0.1,
                                     .client_stiffness = 340,
                                     .client_damping = 5,
                                     .server_stiffness = 340};

double omega(double hertz) { return 2 * std::numbers::pi * hertz; }
double excess(const DeformableCoupling& coupling, double hertz, double round_trip) {
  return std::abs(client_impedance(coupling, omega(hertz), round_trip)) / std::abs(server_impedance(coupling, omega(hertz))) - 1;
}

TEST(DeformableTransparency, TolerableDelaysOfTheThesis) {
  EXPECT_NEAR(*tolerable_delay(kObject, omega(0.5), 0.1), 37.50e-3, 5e-6);
  EXPECT_NEAR(*tolerable_delay(kObject, omega(1), 0.1), 18.40e-3, 5e-6);
  EXPECT_NEAR(*tolerable_delay(kObject, omega(2), 0.1), 8.49e-3, 5e-6);
}

TEST(DeformableTransparency, ImpedancesOfTheThesisAt75Milliseconds) {
  EXPECT_NEAR(excess(kObject, 0.5, 0.075), 0.394, 5e-4);
  DeformableCoupling reduced = kObject;
  reduced.client_stiffness = reduced_stiffness_undamped(kObject, omega(0.5), 0.075);
  EXPECT_NEAR(reduced.client_stiffness, 251.56, 5e-3);
  EXPECT_NEAR(excess(reduced, 0.5, 0.075), 0.032, 5e-4);
  reduced.client_stiffness = reduced_stiffness(kObject, omega(0.5), 0.075);
  EXPECT_NEAR(reduced.client_stiffness, 251.07, 5e-3);
  EXPECT_NEAR(excess(reduced, 0.5, 0.075), 0.030, 5e-4);
}

TEST(DeformableTransparency, TheSlowImpedanceRisesByTheDecibelsOfTheThesis) {
  const double level = 20 * std::log10(std::abs(slow_client_impedance(kObject, omega(0.5), 0.037)) * omega(0.5) /
                                       (340 * (1 - follows_slowly(kObject))));
  EXPECT_NEAR(level, 0.82, 0.02);
}

TEST(DeformableTransparency, AtTheTolerableDelayTheSlowImpedanceIsTheFractionAbove) {
  for (const double hertz : {0.2, 0.5, 1.0, 3.0})
    for (const double weber : {0.05, 0.1, 0.25}) {
      const auto delay = tolerable_delay(kObject, omega(hertz), weber);
      if (!delay) continue;  // the damper alone is rendered
      const double wanted = 340 * (1 - follows_slowly(kObject)) / omega(hertz);
      EXPECT_NEAR(std::abs(slow_client_impedance(kObject, omega(hertz), *delay)), (1 + weber) * wanted, 1e-9 * wanted);
    }
}

TEST(DeformableTransparency, TheReducedStiffnessRestoresTheSlowImpedance) {
  for (const double delay : {0.0, 0.02, 0.1, 0.3}) {
    DeformableCoupling reduced = kObject;
    reduced.client_stiffness = reduced_stiffness(kObject, omega(0.5), delay);
    const double wanted = 340 * (1 - follows_slowly(kObject)) / omega(0.5);
    EXPECT_NEAR(std::abs(slow_client_impedance(reduced, omega(0.5), delay)), wanted, 1e-9 * wanted) << delay;
  }
  EXPECT_EQ(reduced_stiffness_undamped(kObject, omega(1), 0), 340);
}

TEST(DeformableTransparency, DampingThatIsRenderedByItselfLeavesNoTolerableDelay) {
  DeformableCoupling damped = kObject;
  damped.client_damping = 100;
  EXPECT_FALSE(tolerable_delay(damped, omega(2), 0.1));
  EXPECT_EQ(reduced_stiffness(damped, omega(2), 0.1), 0);
}

TEST(DeformableTransparency, TheObjectFollowsAllTheMoreTheSofterItIs) {
  EXPECT_NEAR(follows_slowly(kObject), 340.0 / 440, 1e-15);
  EXPECT_NEAR(std::abs(follows(kObject, 1e-6)), follows_slowly(kObject), 1e-9);
  EXPECT_LT(std::abs(follows(kObject, 1e4)), 1e-3);
}

// ==== pressing ====

/// The object of thesis figures 4.18 to 4.24.
Pressing one_user(std::uint32_t round_trip) {
  Pressing out;
  out.object = {100, 2, 0.1};
  out.stiffness = 340;
  out.client_damping = 5;
  out.duration = 2.5;
  out.users = {{{{0.2, 0.7, 1.5, 0.03}}, round_trip / 2, round_trip - round_trip / 2}};
  return out;
}

double peak(const std::vector<double>& force) { return *std::ranges::max_element(force); }
double peak_rendered(const Pressing& pressing) { return peak(press(pressing)->front().client); }

TEST(PressedObject, AHandGoesInHoldsAndComesOut) {
  const std::vector<Press> presses{{1, 2, 3, 0.02}};
  EXPECT_LT(depth_of(presses, 0.9, 0.5), 0);
  EXPECT_EQ(depth_of(presses, 1, 0.5), 0);
  EXPECT_NEAR(depth_of(presses, 1.25, 0.5), 0.02 * std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(depth_of(presses, 1.7, 0.5), 0.02, 1e-12);
  EXPECT_EQ(depth_of(presses, 2.5, 0.5), 0.02);
  EXPECT_NEAR(depth_of(presses, 3.25, 0.5), 0.02 * std::sqrt(0.5), 1e-12);
  EXPECT_LT(depth_of(presses, 3.6, 0.5), 0);
}

TEST(PressedObject, WhoHoldsStillFeelsBothSpringsWhateverTheDelay) {
  for (const std::uint32_t round_trip : {0U, 37U, 80U, 150U})
    for (const std::optional<double> compensation : {std::optional<double>(), std::optional(0.01)}) {
      Pressing pressing = one_user(round_trip);
      pressing.compensation = compensation;
      const auto forces = press(pressing);
      ASSERT_TRUE(forces);
      EXPECT_NEAR(forces->front().client[1490], 340 * 100 / 440.0 * 0.03, 0.002) << round_trip;
      EXPECT_NEAR(forces->front().server[1490], 340 * 100 / 440.0 * 0.03, 0.002) << round_trip;
      EXPECT_EQ(forces->front().client[2400], 0);
    }
}

/// Equation 4.39, whose approximation 4.45 gives 37.5 ms for 10 %; here a tick passes until the object gives way (T_c of figure 4.14).
TEST(PressedObject, DelayRaisesThePeakAsTheTransferFunctionsPredict) {
  const DeformableCoupling coupling{100, 2, 0.1, 340, 5, 340};
  const double omega = std::numbers::pi;  // 0.5 Hz
  const double reference = peak(press(one_user(0))->front().server);
  for (const std::uint32_t round_trip : {10U, 37U, 50U, 75U}) {
    const double expected =
        std::abs(client_impedance(coupling, omega, 1e-3 * (round_trip + 1))) / std::abs(server_impedance(coupling, omega));
    EXPECT_NEAR(peak_rendered(one_user(round_trip)) / reference, expected, 0.015) << round_trip;
  }
}

TEST(PressedObject, CompensationTakesThePeakAway) {
  const double reference = peak(press(one_user(0))->front().server);
  for (const std::uint32_t round_trip : {50U, 75U, 100U, 150U}) {
    Pressing pressing = one_user(round_trip);
    EXPECT_GT(peak_rendered(pressing), 1.15 * reference) << round_trip;
    for (const double filter : {1.0, 0.1, 0.01}) {
      pressing.compensation = filter;
      EXPECT_NEAR(peak_rendered(pressing) / reference, 1, 0.01) << round_trip << ", " << filter;
    }
  }
}

double error_of(const std::vector<double>& force, const std::vector<double>& reference) {
  double sum = 0;
  for (std::size_t i = 0; i < force.size(); ++i) sum += (force[i] - reference[i]) * (force[i] - reference[i]);
  return std::sqrt(sum / static_cast<double>(force.size()));
}

/// Objects, hands and delays that the filter's default was not chosen on.
TEST(PressedObject, CompensationHelpsElsewhere) {
  for (const MsdObject& object : {MsdObject{350, 2, 0.1}, MsdObject{50, 1, 0.02}, MsdObject{200, 5, 0.5}})
    for (const double stiffness : {250.0, 700.0})
      for (const double frequency : {0.3, 1.0, 2.0})
        for (const std::uint32_t round_trip : {40U, 120U}) {
          Pressing pressing = one_user(0);
          pressing.object = object;
          pressing.stiffness = stiffness;
          pressing.frequency = frequency;
          pressing.users[0].presses = {{0.2, 1.2, 1.8, 0.02}};
          pressing.duration = 1.8;  // while the hand goes in and holds: letting go is left as it is
          const std::vector<double> reference = press(pressing)->front().server;
          pressing.users[0].to_server = pressing.users[0].from_server = round_trip / 2;
          const double without = error_of(press(pressing)->front().client, reference);
          pressing.compensation = StiffnessReduction::kFilter;
          const double with = error_of(press(pressing)->front().client, reference);
          EXPECT_LT(with, 0.65 * without) << object.stiffness << ", " << stiffness << ", " << frequency << " Hz, " << round_trip
                                          << " ms";
        }
}

TEST(PressedObject, WithoutDelayCompensationChangesNothing) {
  Pressing pressing = one_user(0);
  const std::vector<double> without = press(pressing)->front().client;
  pressing.compensation = 1;
  EXPECT_EQ(press(pressing)->front().client, without);
}

TEST(PressedObject, WhoOnlyHoldsFeelsNoMoreWhenAnotherPresses) {
  Pressing pressing = one_user(80);
  pressing.duration = 4;
  pressing.users[0].presses = {{0.2, 0.7, 3.5, 0.03}};
  pressing.users.push_back({{{1.5, 2, 3, 0.03}}, 30, 30});
  const auto forces = press(pressing);
  ASSERT_TRUE(forces);
  const auto alone = forces->front().client[1490];
  for (std::size_t tick = 1600; tick < 2900; ++tick) EXPECT_LE(forces->front().client[tick], alone + 1e-6) << tick;
}

TEST(PressedObject, WhatItCannotTakeIsRefused) {
  Pressing pressing = one_user(10);
  pressing.users[0].to_server = StiffnessReduction::kMostDelay;
  EXPECT_STREQ(press(pressing).error().rule, "R-API-4");
  pressing = one_user(10);
  pressing.compensation = 0;
  EXPECT_STREQ(press(pressing).error().rule, "R-API-4");
}

}  // namespace
}  // namespace tactus::sim
