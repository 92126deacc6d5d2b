// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/transparency/transparency.h>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace tactus::sim {
namespace {

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

TEST(DeformableTransparency, AtTheTolerableDelayTheSlowImpedanceIsTheShareAbove) {
  for (const double hertz : {0.2, 0.5, 1.0, 3.0})
    for (const double weber : {0.05, 0.1, 0.25}) {
      const auto delay = tolerable_delay(kObject, omega(hertz), weber);
      if (!delay) continue;  // the damper alone is felt
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

TEST(DeformableTransparency, DampingThatIsFeltByItselfLeavesNoTolerableDelay) {
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

}  // namespace
}  // namespace tactus::sim
