// SPDX-License-Identifier: Apache-2.0
/// What users feel behind a network, closed loop: thesis 4.2.4 and 4.3.4.
#include "lab/study/delay.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include <tactus/sim/simulation.h>

namespace tactus::sim::study {
namespace {

constexpr double kWeber = 0.1;
constexpr SceneCompensation kStiffness{}, kSimulation{.method = CompensationMethod::simulation};

Scene scene(const std::string& name) { return load_scene(*find_scene(name)).value(); }

LinkOptions delayed(Microseconds round_trip) { return {.delay = round_trip / 2}; }

std::vector<DelayEffect> effects(const Scene& scene, const DelayCase& one, const DelayRun& reference) {
  const DelayRun run = run_delayed(scene, one).value();
  std::vector<DelayEffect> out;
  for (std::size_t i = 0; i < scene.users.size(); ++i) out.push_back(effect_of(run.users[i], reference.users[i], kWeber));
  return out;
}

TEST(DelayStudy, TheRoundTripThatAClientTellsIsThatOfTheNetwork) {
  const DelayRun run = run_delayed(scene("push-cube"), {.link = delayed(80'000)}).value();
  for (std::size_t i = 2000; i < run.users[0].size(); ++i) ASSERT_NEAR(run.users[0][i].round_trip, 0.080, 0.002) << i;
}

TEST(DelayStudy, APushedCubeIsAsHeavyAsWithoutDelay) {
  const Scene cube = scene("push-cube");
  const DelayRun reference = run_delayed(cube, {.is_local = true}).value();
  for (const Microseconds round_trip : {50'000, 100'000, 150'000}) {
    const DelayEffect without = effects(cube, {.link = delayed(round_trip)}, reference)[0];
    const DelayEffect with = effects(cube, {.link = delayed(round_trip), .compensation = kStiffness}, reference)[0];
    EXPECT_GT(without.mean, 1.5 * without.reference_mean) << round_trip;
    EXPECT_NEAR(with.mean, with.reference_mean, 0.1 * with.reference_mean) << round_trip;
    EXPECT_LT(with.peak, 1.3 * with.reference_peak) << round_trip;
  }
}

/// The second user who presses makes the block heavier for the first; what the second one presses does not yield and is not softened.
TEST(DelayStudy, WhoPressesOnWhatCannotMoveFeelsItsWholeStiffness) {
  const Scene jenga = scene("jenga-press");
  const DelayRun run = run_delayed(jenga, {.link = delayed(80'000), .compensation = kStiffness}).value();
  double least = 1e9;
  for (std::size_t i = 0; i < run.users[1].size(); ++i)
    if (run.users[1][i].client > 0.5) least = std::min(least, run.users[1][i].stiffness);
  EXPECT_GT(least, 600);
  double softest = 1e9;
  for (const DelayTick& tick : run.users[0])
    if (tick.client > 0.5) softest = std::min(softest, tick.stiffness);
  EXPECT_LT(softest, 450);
}

TEST(DelayStudy, AOneDimensionalObjectIsPressedWithoutAPeak) {
  Scene msd = scene("msd-1d");
  msd.msds[0].object = {100, 2, 0.1};
  msd.msds[0].rate = 1;
  const DelayRun reference = run_delayed(msd, {.is_local = true}).value();
  const DelayEffect without = effects(msd, {.link = delayed(80'000)}, reference)[0];
  const DelayEffect with = effects(msd, {.link = delayed(80'000), .compensation = kStiffness}, reference)[0];
  EXPECT_GT(without.peak, 1.25 * without.reference_peak);
  EXPECT_LT(with.peak, 1.12 * with.reference_peak);
  EXPECT_LT(with.rms, 0.6 * without.rms);
}

/// [m] Farthest that the touched point is seen from where it is without delay, for 99 % of the time.
double seen_away(const DelayRun& run, const DelayRun& reference) {
  std::vector<double> away;
  for (std::size_t i = 0; i < reference.users[0].size(); ++i)
    if (run.users[0][i].touched && reference.users[0][i].touched)
      away.push_back(norm(*run.users[0][i].touched - *reference.users[0][i].touched));
  std::ranges::sort(away);
  return away.empty() ? 0 : away[away.size() * 99 / 100];
}

TEST(DelayStudy, WhatAClientSimulatesIsFeltAndSeenAtOnce) {
  const Scene cube = scene("push-cube");
  const DelayRun reference = run_delayed(cube, {.is_local = true}).value();
  for (const Microseconds round_trip : {100'000, 300'000}) {
    const DelayRun run = run_delayed(cube, {.link = delayed(round_trip), .compensation = kSimulation}).value();
    const DelayRun plain = run_delayed(cube, {.link = delayed(round_trip)}).value();
    EXPECT_LT(effect_of(run.users[0], reference.users[0], kWeber).rms, 0.01);
    EXPECT_LT(seen_away(run, reference), 1e-4);
    EXPECT_GT(seen_away(plain, reference), 10e-3);
  }
}

TEST(DelayStudy, AOneDimensionalObjectThatAClientSimulatesIsFeltAndSeenAtOnce) {
  Scene msd = scene("msd-1d");
  msd.users.resize(1);
  const DelayRun reference = run_delayed(msd, {.is_local = true}).value();
  const DelayRun run = run_delayed(msd, {.link = delayed(100'000), .compensation = kSimulation}).value();
  const DelayRun plain = run_delayed(msd, {.link = delayed(100'000)}).value();
  EXPECT_LT(effect_of(run.users[0], reference.users[0], kWeber).rms, 0.01);
  EXPECT_LT(seen_away(run, reference), 1e-5);
  EXPECT_GT(seen_away(plain, reference), 2e-3);
}

#ifdef TACTUS_WITH_FEM
TEST(DelayStudy, AMembraneThatAClientSimulatesIsFeltAndSeenAtOnce) {
  Scene membrane = scene("membrane-small");
  membrane.duration = 3;
  const DelayRun reference = run_delayed(membrane, {.is_local = true}).value();
  const DelayRun run = run_delayed(membrane, {.link = delayed(200'000), .compensation = kSimulation}).value();
  const DelayRun plain = run_delayed(membrane, {.link = delayed(200'000)}).value();
  EXPECT_LT(effect_of(run.users[0], reference.users[0], kWeber).rms, 0.02);
  EXPECT_LT(seen_away(run, reference), 1e-4);
  EXPECT_GT(seen_away(plain, reference), 5e-4);
}
#endif

TEST(DelayStudy, ClientsOfDifferentModelsArePulledToTheServer) {
  const Scene jenga = scene("jenga-press");
  Scene wrong = jenga;
  wrong.objects[0].mass *= 1.1;
  wrong.objects[0].friction *= 1.1;
  const DelayRun run = run_delayed(jenga, {.link = delayed(100'000), .compensation = kSimulation, .own = &wrong}).value();
  const auto& first = run.users[0];
  EXPECT_LT(norm(first.back().shown.position - run.users[1].back().shown.position), 0.5e-3) << "[m] at rest, both see the same";
  for (std::size_t i = 1; i < first.size(); ++i)
    ASSERT_LT(norm(first[i].shown.position - first[i - 1].shown.position), 1e-3) << "[m] in tick " << i;
}

/// A stiff coupling, a loose grip and 100 ms: figure 4.17b. The controller at the client adds what damping it takes.
TEST(DelayStudy, APassiveClientGivesNoEnergyAwayWhileItsStiffnessRises) {
  Scene msd = scene("msd-1d");
  msd.msds[0].object = {350, 2, 0.1};
  msd.msds[0].rate = 1;
  msd.msds[0].touch_damping = 0;
  msd.touch->stiffness = 700;
  msd.users.resize(1);
  msd.users[0].grip = Grip::loose;
  msd.users[0].device.max_force = 7.9;
  const DelayRun reference = run_delayed(msd, {.is_local = true}).value();
  for (const bool compensates : {false, true}) {
    DelayCase one{.link = delayed(100'000)};
    if (compensates) one.compensation = kStiffness;
    msd.touch->max_damping = 0;
    EXPECT_LT(effects(msd, one, reference)[0].lowest_energy, -0.1) << "[J] it swings";
    msd.touch->max_damping = 50;
    const DelayEffect passive = effects(msd, one, reference)[0];
    EXPECT_GE(passive.lowest_energy, -1e-6);
    EXPECT_NEAR(passive.mean, passive.reference_mean, 0.1 * passive.reference_mean);
  }
}

/// Compensation is absent unless the scene asks: the same packets, the same forces.
TEST(DelayStudy, ASceneThatDoesNotAskSendsNoLoads) {
  Scene cube = scene("push-cube");
  ASSERT_TRUE(cube.compensation);
  EXPECT_TRUE(scene_builder(cube).build().value()->loads);
  cube.compensation.reset();
  EXPECT_FALSE(scene_builder(cube).build().value()->loads);
  auto simulation = Simulation::create(cube, {.seed = 1, .grip = {}, .channel = ChannelOptions{}}).value();
  EXPECT_FALSE(simulation.stream_scene()->loads);
}

TEST(DelayStudy, EffectsAreMeasuredInContact) {
  std::vector<DelayTick> reference(100), delayed(100);
  for (std::size_t i = 20; i < 60; ++i) reference[i].client = 1, delayed[i].client = i < 30 ? 1.05 : 1.5;
  delayed[40].energy = -0.25;
  const DelayEffect effect = effect_of(delayed, reference, kWeber);
  EXPECT_NEAR(effect.reference_mean, 1, 1e-12);
  EXPECT_NEAR(effect.mean, (10 * 1.05 + 30 * 1.5) / 40, 1e-12);
  EXPECT_EQ(effect.peak, 1.5);
  EXPECT_EQ(effect.outside, 0.75);
  EXPECT_NEAR(effect.rms, std::sqrt((10 * 0.0025 + 30 * 0.25) / 40), 1e-12);
  EXPECT_EQ(effect.lowest_energy, -0.25);
}

}  // namespace
}  // namespace tactus::sim::study
