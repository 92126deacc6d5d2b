// SPDX-License-Identifier: Apache-2.0
/// Studies in the program tactus-study.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <tactus/sim/simulation.h>
#include "lab/study/delay.h"
#include "lab/study/sampled_mass.h"
#include "lab/study/server_loop.h"
#include "lab/study/signals.h"
#include "lab/study/stability.h"
#include "lab/study/study.h"
#include "lab/study/wall.h"

namespace tactus::sim::study {
namespace {

// ==== study ====
// The studies of `tactus bench stability`: what they measure must be what theory says, where it says something.

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
  mass.move_to(0.01, 0);
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
  EXPECT_LT(*study.rows[6].measured, *study.rows[7].measured) << "damping at the client tolerates a longer delay";
}

// ==== study signals ====
// The study of `tactus bench signals` finds what is known of made-up signals.

TraceInfo recording(std::uint32_t tick_rate) {
  TraceInfo info;
  info.tick_rate = tick_rate;
  info.users = {{"still"}, {"hand"}};
  return info;
}

/// The second user circles; from the second second on it touches a wall, and feels a force that grows.
TraceFrame frame_at(std::int64_t tick, std::uint32_t tick_rate) {
  const double t = static_cast<double>(tick) / tick_rate, angle = 2 * std::numbers::pi * t;
  TraceFrame out{.tick = tick, .objects = {}, .users = std::vector<UserSample>(2)};
  UserSample& hand = out.users[1];
  hand.device.position = {0.05 * std::cos(angle), 0.05 * std::sin(angle), 0};
  if (t < 1) return out;
  hand.server_force = {0, 0, t};
  hand.surface_contact = SurfaceContact{.proxy = hand.device.position + Vec3{0, 0, 2e-3}, .stiffness = 500};
  return out;
}

const SignalResult& find(const std::vector<SignalResult>& results, Signal signal, const std::string& name) {
  const auto found = std::ranges::find_if(results, [&](const auto& r) { return r.signal == signal && r.name == name; });
  EXPECT_NE(found, results.end()) << name;
  return *found;
}

TEST(SignalStudy, EveryBoundIsKeptAndEveryRateCounted) {
  for (const std::uint32_t rate : {500u, 1000u}) {
    auto study = SignalStudy::create(recording(rate)).value();
    for (std::int64_t tick = 0; tick < 3 * rate; ++tick) ASSERT_TRUE(study.add(frame_at(tick, rate)));
    const auto results = study.results();
    for (const SignalResult& r : results) {
      EXPECT_EQ(r.user, 1u) << "the other one neither moves nor feels";
      EXPECT_EQ(r.samples, 3 * rate);
      EXPECT_EQ(r.over, 0u) << r.name;
      EXPECT_LE(r.worst, 1) << r.name;
      EXPECT_LE(r.rms, r.largest);
      EXPECT_GT(r.bytes, 3 * r.packets);
    }
    EXPECT_EQ(find(results, Signal::device, "every sample").packets, 3 * rate);
    std::uint64_t before = 3 * rate;
    for (const char* name : {"0.1 mm", "0.3 mm", "1 mm", "3 mm"}) {
      const SignalResult& r = find(results, Signal::device, name);
      EXPECT_LT(r.packets, before) << name;
      EXPECT_GT(r.worst, 0.7) << "the bound is used";
      before = r.packets;
    }
    // On a circle the line leaves the bound e after the time sqrt(2 e / a); the velocity lags by half of its window.
    EXPECT_NEAR(static_cast<double>(find(results, Signal::device, "1 mm").packets), 3 * std::sqrt(1.97 / 2e-3), 15);
    EXPECT_GT(find(results, Signal::contact, "2 %, 0.5 mm").packets, find(results, Signal::contact, "20 %, 0.5 mm").packets);
    // From 1 to 3 N in steps of p: log 3 / log (1 + p).
    const std::uint64_t held = find(results, Signal::force, "4 %, hold").packets;
    EXPECT_NEAR(static_cast<double>(held), std::log(3) / std::log(1.04), 2);
    EXPECT_LT(find(results, Signal::force, "4 %, linear").packets, held) << "it grows linearly";
    EXPECT_NEAR(static_cast<double>(find(results, Signal::force, "IEEE 1918.1.1").packets), std::log(3) / std::log(1.1), 2);
  }
}

TEST(SignalStudy, WhatARecordingLacksIsLeftOut) {
  auto study = SignalStudy::create(recording(100)).value();
  for (std::int64_t tick = 0; tick < 100; ++tick) ASSERT_TRUE(study.add(frame_at(tick, 100)));  // no contact yet
  for (const SignalResult& r : study.results()) EXPECT_EQ(r.signal, Signal::device) << r.name;
  TraceFrame wrong = frame_at(100, 100);
  wrong.users[1].device.position.x = NAN;
  EXPECT_FALSE(study.add(wrong));
  EXPECT_TRUE(
      SignalStudy::create({.tick_rate = 100, .objects = {}, .users = {}, .source = {}, .scene = {}}).value().results().empty());
}

// ==== study delay ====
/// What users feel behind a network, closed loop: thesis 4.2.4 and 4.3.4.

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

TEST(DelayStudy, TheRoundTripThatAClientReportsIsThatOfTheNetwork) {
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

TEST(DelayStudy, WhatAClientSimulatesIsRenderedAndSeenAtOnce) {
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

TEST(DelayStudy, AOneDimensionalObjectThatAClientSimulatesIsRenderedAndSeenAtOnce) {
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
TEST(DelayStudy, AMembraneThatAClientSimulatesIsRenderedAndSeenAtOnce) {
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
