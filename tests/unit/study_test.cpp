// SPDX-License-Identifier: Apache-2.0
// The studies of `tactus bench stability`: what they measure must be what theory says, where it says something.
#include "lab/study/study.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lab/study/sampled_mass.h"
#include "lab/study/server_loop.h"
#include "lab/study/stability.h"
#include "lab/study/wall.h"

namespace tactus::sim::study {
namespace {

constexpr ServerLoop kFigure{.object = {.stiffness = 100, .damping = 1, .mass = 0.01}, .users = 2};  // thesis figure 4.16

void none(const std::string&, std::uint64_t, std::uint64_t) {}

TEST(Study, BisectionFindsTheBorder) {
  EXPECT_NEAR(bisect(1, 1e6, 1e-9, [](double x) { return x < 700; }), 700, 1e-6);
  EXPECT_NEAR(bisect(1e-6, 1, 1e-9, [](double x) { return x < 3e-5; }), 3e-5, 1e-13);
}

TEST(ServerLoop, Figure416LimitIs700) {
  EXPECT_NEAR(critical_stiffness(kFigure.object, kFigure.period()), 700, 1e-9);
  EXPECT_NEAR(kFigure.users * jury_limit(kFigure), 700, 1e-9);
  EXPECT_NEAR(kFigure.users * measured_limit(kFigure), 700, 7);
  EXPECT_EQ(step_response(kFigure, 360), Verdict::diverges);
  EXPECT_EQ(step_response(kFigure, 340), Verdict::stable);
}

TEST(ServerLoop, MeasuredLimitIsJurysInEveryCorner) {
  for (const std::uint32_t divider : {1u, 17u})
    for (const double damping : {0.0, 10.0})
      for (const double mass : {1e-3, 1.0}) {
        const ServerLoop loop{.object = {.stiffness = 100, .damping = damping, .mass = mass}, .divider = divider};
        EXPECT_NEAR(measured_limit(loop) / jury_limit(loop), 1, 0.01) << divider << ' ' << damping << ' ' << mass;
      }
}

TEST(ServerLoop, ALinearApproachHasALimitOfItsOwn) {
  ServerLoop loop = kFigure;
  loop.approach = Approach::linear;
  EXPECT_NEAR(measured_limit(loop) / jury_limit(loop), 1, 0.01);
  EXPECT_LT(jury_limit(loop), 0.7 * jury_limit(kFigure));
}

TEST(ServerLoop, PolesLeaveTheUnitCircleAtTheLimit) {
  for (const Approach approach : {Approach::at_once, Approach::linear}) {
    ServerLoop loop = kFigure;
    loop.approach = approach;
    const double limit = jury_limit(loop);
    EXPECT_LT(spectral_radius(loop, 0.999 * limit), 1);
    EXPECT_GT(spectral_radius(loop, 1.001 * limit), 1);
  }
}

TEST(SampledMass, IsTheClosedForm) {
  // Underdamped: x = X e^(-a t) (cos w t + a/w sin w t).
  const Impedance hand{.mass = 0.1, .damping = 0.8, .stiffness = 60};
  SampledMass mass(hand, 1e-3);
  mass.place(0.01, 0);
  const double a = hand.damping / (2 * hand.mass), w = std::sqrt(hand.stiffness / hand.mass - a * a);
  for (int n = 1; n <= 1000; ++n) {
    mass.step(0);
    const double t = 1e-3 * n;
    ASSERT_NEAR(mass.position(), 0.01 * std::exp(-a * t) * (std::cos(w * t) + a / w * std::sin(w * t)), 1e-14) << n;
  }
}

TEST(SampledMass, ConstantForceOnAFreeMass) {
  SampledMass mass({.mass = 2}, 0.01);
  for (int n = 0; n < 100; ++n) mass.step(3);
  EXPECT_NEAR(mass.position(), 0.75, 1e-12);
  EXPECT_NEAR(mass.velocity(), 1.5, 1e-12);
}

TEST(Wall, ObserverFindsEquation23) {
  for (const double damping : {0.1, 1.0}) {
    const double limit = 2 * damping / 1e-3;
    EXPECT_TRUE(is_passive({.stiffness = 0.99 * limit}, damping, 1e-3, Motion::slow));
    EXPECT_FALSE(is_passive({.stiffness = 1.01 * limit}, damping, 1e-3, Motion::slow));
  }
}

TEST(Wall, ASampledDamperGivesEnergyAwayInFastMotion) {
  const Wall wall{.stiffness = 600, .damping = 0.1};  // 2 (0.35 + 0.1) / T = 900, 2 (0.35 - 0.1) / T = 500
  EXPECT_TRUE(is_passive(wall, 0.35, 1e-3, Motion::slow));
  EXPECT_FALSE(is_passive(wall, 0.35, 1e-3, Motion::fast));
}

TEST(Wall, StableUpToJurysLimit) {
  const Impedance held{.mass = 0.15, .damping = 12.35, .stiffness = 220};
  const double limit = largest_spring(transition(held, 1e-3));
  EXPECT_TRUE(is_stable({.stiffness = 0.99 * limit}, held, 1e-3));
  EXPECT_FALSE(is_stable({.stiffness = 1.01 * limit}, held, 1e-3));
}

TEST(Stability, EveryLimitIsWithinAPercentOfTheory) {
  std::size_t compared = 0;
  for (const auto& study : {study_jury(Extent::brief, none), study_wall(Extent::brief, none)})
    for (const Row& row : study.rows)
      if (const auto deviation = row.deviation()) {
        EXPECT_LT(std::abs(*deviation), 0.01) << row.subject;
        ++compared;
      }
  EXPECT_GT(compared, 40u);
}

TEST(Stability, ClientOfFigure417) {
  const Study study = study_client(Extent::brief, none);
  ASSERT_EQ(study.rows.size(), 9u);                                            // six panels, three limits by bisection
  const auto energy = [&](std::size_t i) { return *study.rows[i].measured; };  // lowest [mJ]
  EXPECT_EQ(study.rows[0].verdict, Verdict::stable);
  EXPECT_NE(study.rows[1].verdict, Verdict::stable);
  EXPECT_LT(energy(1), -10);
  for (const std::size_t i : {2u, 3u, 4u, 5u}) EXPECT_EQ(study.rows[i].verdict, Verdict::stable) << i;
  for (const std::size_t i : {0u, 2u, 3u}) EXPECT_GT(energy(i), -1e-3) << i;
  EXPECT_LT(energy(4), 0) << "slightly active, says the thesis";
  EXPECT_GT(energy(4), -1);
  EXPECT_LT(*study.rows[6].measured, *study.rows[7].measured) << "damping at the client bears a longer delay";
}

}  // namespace
}  // namespace tactus::sim::study
