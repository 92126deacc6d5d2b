// SPDX-License-Identifier: Apache-2.0
// Samples around a time, and how fast they move: io/trace/sample_track.h.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include <tactus/trace/sample_track.h>

namespace tactus {
namespace {

using Track = SampleTrack<std::int64_t>;
using Relation = Track::Relation;

constexpr std::int64_t kMs = 1'000'000;  // [ns]
constexpr double kNanosecond = 1e-9;

Pose along_x(double x) { return {{x, 0, 0}, {}}; }
Pose about_z(double angle) { return {{}, {std::cos(angle / 2), 0, 0, std::sin(angle / 2)}}; }

/// Samples every `period`, looked at every millisecond.
class Recorded {
 public:
  Recorded(const std::function<Pose(double)>& motion, const std::vector<std::int64_t>& times, double gap = 0.1e9) {
    Track track({.gap = gap, .tick = kMs});
    std::size_t next = 0;
    for (std::int64_t time = 0; time <= times.back() + 20 * kMs; time += kMs) {
      while (next < times.size() && !track.is_settled(time, next == 0 ? -1 : times[next - 1]))
        track.add({times[next], {motion(1e-9 * static_cast<double>(times[next])), {}, {}}}), ++next;
      track.move_to(time);
      at_.push_back(track.relation() == Relation::nowhere ? RigidSample{} : track.moving(kNanosecond));
      relations_.push_back(track.relation());
    }
  }
  const RigidSample& at(int ms) const { return at_[static_cast<std::size_t>(ms)]; }
  Relation relation(int ms) const { return relations_[static_cast<std::size_t>(ms)]; }

 private:
  std::vector<RigidSample> at_;
  std::vector<Relation> relations_;
};

std::vector<std::int64_t> every(double ms, int count) {
  std::vector<std::int64_t> times;
  for (int i = 0; i < count; ++i) times.push_back(std::llround(ms * i * kMs));
  return times;
}

TEST(SampleTrack, AConstantVelocityIsItselfEverywhere) {
  const auto motion = [](double t) { return Pose{{2 * t, 0, 0}, {std::cos(1.5 * t), std::sin(1.5 * t), 0, 0}}; };
  for (const double period : {0.2, 1.0, 4.0, 33.0}) {
    const Recorded all(motion, every(period, 40));
    const int end = static_cast<int>(std::floor(39 * period));
    for (int ms = 0; ms <= end; ++ms) {
      EXPECT_NEAR(all.at(ms).pose.position.x, 0.002 * ms, 1e-12) << period << ' ' << ms;
      EXPECT_NEAR(all.at(ms).velocity.x, 2, 1e-6) << period << ' ' << ms;
      EXPECT_NEAR(all.at(ms).angular_velocity.x, 3, 1e-6) << period << ' ' << ms;
    }
    EXPECT_EQ(all.at(end + 2).velocity, Vec3());
  }
}

/// The velocity is that of the motion within h^2/6 of its third derivative, h a sample period, and it has no steps.
TEST(SampleTrack, ASineMovesSmoothlyBetweenSamplesThatAreFarApart) {
  const auto motion = [](double t) { return Pose{{0.1 * std::sin(6 * t), 0, 0}, about_z(std::cos(6 * t)).rotation}; };
  const Recorded all(motion, every(20, 60));
  for (int ms = 20; ms < 58 * 20; ++ms) {                  // the first and the last stretch are lines
    const double t = 0.001 * ms, most = 0.4e-3 / 6 * 216;  // of a unit of amplitude; and what the line between two samples is off
    EXPECT_NEAR(all.at(ms).velocity.x, 0.6 * std::cos(6 * t), 0.1 * 2 * most) << ms;
    EXPECT_NEAR(all.at(ms).angular_velocity.z, -6 * std::sin(6 * t), 2 * most) << ms;
    EXPECT_LT(std::abs(all.at(ms).velocity.x - all.at(ms - 1).velocity.x), 1.1 * 0.001 * 3.6) << ms;  // 3.6 m/s^2 at most
  }
}

TEST(SampleTrack, AtTheEndsOfAStretchTheVelocityIsThatOfItsOneSide) {
  std::vector<std::int64_t> times = every(10, 6);
  for (const std::int64_t time : every(10, 6)) times.push_back(time + 1000 * kMs);
  const auto motion = [](double t) { return along_x(t < 0.5 ? t * t : 5 - 3 * t); };  // there it jumps, too
  const Recorded all(motion, times);
  EXPECT_NEAR(all.at(0).velocity.x, 0.01, 1e-9);
  EXPECT_NEAR(all.at(20).velocity.x, 0.04, 1e-9);
  EXPECT_NEAR(all.at(25).velocity.x, 0.05, 1e-9);
  EXPECT_NEAR(all.at(50).velocity.x, 0.09, 1e-9);
  EXPECT_EQ(all.relation(51), Relation::after);
  for (const int ms : {51, 500, 999}) {
    EXPECT_NEAR(all.at(ms).pose.position.x, 0.0025, 1e-12);
    EXPECT_EQ(all.at(ms).velocity, Vec3());
  }
  EXPECT_NEAR(all.at(1000).pose.position.x, 2, 1e-9);
  for (int ms = 1000; ms <= 1050; ++ms) EXPECT_NEAR(all.at(ms).velocity.x, -3, 1e-6);
  EXPECT_EQ(all.at(1051).velocity, Vec3());
}

/// A jump, a stop and a bounce stay on their lines, with the velocities of these: nothing moves beyond what samples show.
TEST(SampleTrack, AJumpWithinTheGapStaysOnItsLine) {
  const Recorded all([](double t) { return along_x(t < 0.045 ? 0 : 1); }, every(10, 10));
  for (int ms = 0; ms <= 90; ++ms) {
    EXPECT_NEAR(all.at(ms).pose.position.x, ms <= 40 ? 0 : ms >= 50 ? 1 : 0.1 * (ms - 40), 1e-12) << ms;
    EXPECT_NEAR(all.at(ms).velocity.x, ms >= 40 && ms < 50 ? 100 : 0, 1e-9) << ms;
  }
}

TEST(SampleTrack, WhatStopsOrBouncesGoesNoFartherThanItsSamples) {
  const Recorded stop([](double t) { return along_x(2 * std::min(t, 0.1)); }, every(10, 20));
  const Recorded bounce([](double t) { return along_x(3 * std::abs(t - 0.1)); }, every(10, 20));
  for (int ms = 0; ms <= 190; ++ms) {
    EXPECT_NEAR(stop.at(ms).pose.position.x, 0.002 * std::min(ms, 100), 1e-12) << ms;
    EXPECT_NEAR(stop.at(ms).velocity.x, ms < 100 ? 2 : 0, 1e-9) << ms;
    EXPECT_NEAR(bounce.at(ms).pose.position.x, 0.003 * std::abs(ms - 100), 1e-12) << ms;
    EXPECT_NEAR(bounce.at(ms).velocity.x, ms < 100 ? -3 : 3, 1e-9) << ms;
  }
}

TEST(SampleTrack, AConstantAccelerationIsItselfBetweenSamples) {
  const auto motion = [](double t) { return Pose{{t * t, 0.3 * t - 2 * t * t, 0}, about_z(5 * t * t).rotation}; };
  for (const double period : {4.0, 33.0}) {
    const Recorded all(motion, every(period, 12));
    for (int ms = static_cast<int>(period) + 1; ms < 10 * period; ++ms) {
      const double t = 0.001 * ms;
      EXPECT_NEAR(all.at(ms).pose.position.y, 0.3 * t - 2 * t * t, 1e-12) << period << ' ' << ms;
      EXPECT_NEAR(angle_between(all.at(ms).pose.rotation, about_z(5 * t * t).rotation), 0, 1e-7) << period << ' ' << ms;
      EXPECT_NEAR(all.at(ms).velocity.x, 2 * t, 1e-8) << period << ' ' << ms;
      EXPECT_NEAR(all.at(ms).velocity.y, 0.3 - 4 * t, 1e-8) << period << ' ' << ms;
      EXPECT_NEAR(all.at(ms).angular_velocity.z, 10 * t, 1e-6) << period << ' ' << ms;
    }
  }
}

/// A minimum-jerk reach of 0.2 m in 0.8 s: lines between samples at 20 Hz are off by 1.4 mm.
TEST(SampleTrack, AReachThatIsSampledSeldomIsFollowed) {
  const auto reach = [](double t) {
    const double u = std::clamp((t - 0.3) / 0.8, 0.0, 1.0);
    return 0.2 * u * u * u * (10 + u * (6 * u - 15));
  };
  for (const auto& [period, most] : {std::pair{1000.0 / 60, 0.05e-3}, std::pair{50.0, 1.0e-3}}) {
    const Recorded all([&reach](double t) { return along_x(reach(t)); }, every(period, static_cast<int>(1400 / period)));
    double line = 0, curve = 0;
    for (int ms = 0; ms <= 1200; ++ms) {
      const double from = std::floor(ms / period) * period, fraction = (ms - from) / period;
      const double on_line = (1 - fraction) * reach(0.001 * from) + fraction * reach(0.001 * (from + period));
      line = std::max(line, std::abs(on_line - reach(0.001 * ms)));
      curve = std::max(curve, std::abs(all.at(ms).pose.position.x - reach(0.001 * ms)));
    }
    EXPECT_LT(curve, most) << period;
    EXPECT_LT(2 * curve, line) << period;
  }
}

/// Whatever the samples and however their times jitter: at a sample it is there, its velocity is off that of the line by no more than those
/// beside are, and its position off the line by a quarter of what those would make of it.
TEST(SampleTrack, NoCurveLeavesWhatTheChordsBesideAllow) {
  std::uint32_t state = 1;
  const auto random = [&state] { return (state = state * 1664525u + 1013904223u) / 4294967296.0; };
  for (int round = 0; round < 200; ++round) {
    std::vector<double> x;
    std::vector<std::int64_t> times{0};
    for (int i = 0; i < 6; ++i)
      x.push_back(random() - 0.5), times.push_back(times.back() + (3 + std::llround(30 * random())) * kMs);
    times.pop_back();
    Track track({.gap = 1e9, .tick = kMs});
    for (std::size_t i = 0; i < 6; ++i) track.add({times[i], {along_x(x[i]), {}, {}}});
    const auto chord = [&](std::size_t i) { return (x[i + 1] - x[i]) / (1e-9 * static_cast<double>(times[i + 1] - times[i])); };
    for (std::int64_t time = times[1]; time < times[4]; time += kMs) {
      std::size_t at = 1;
      while (times[at + 1] <= time) ++at;
      track.move_to(time);
      const double h = 1e-9 * static_cast<double>(times[at + 1] - times[at]),
                   since = 1e-9 * static_cast<double>(time - times[at]);
      const double line = x[at] + since * chord(at);
      const double beside = std::min(std::abs(chord(at - 1) - chord(at)), std::abs(chord(at + 1) - chord(at)));
      const RigidSample out = track.moving(kNanosecond);
      EXPECT_NEAR(out.pose.position.x, line, time == times[at] ? 0 : 0.25 * h * beside + 1e-12);
      const bool swings = (chord(at) - chord(at - 1)) * (chord(at + 1) - chord(at)) <= 0;
      if (!swings) EXPECT_NEAR(out.velocity.x, chord(at), beside + 1e-6);
      else EXPECT_NEAR(out.pose.position.x, line, 1e-12);
    }
  }
}

/// A tracker with 20 um of noise in each direction at 200 Hz: velocities of its chords have 9.8 mm/s.
TEST(SampleTrack, VelocitiesOfANoisyTrackerAreThoseOfSeveralSamples) {
  std::uint32_t state = 7;
  const auto random = [&state] {
    return 20e-6 * std::sqrt(12.0) * ((state = state * 1664525u + 1013904223u) / 4294967296.0 - 0.5);
  };
  const Recorded all([&random](double) { return Pose{{random(), random(), random()}, {}}; }, every(5, 800));
  double square = 0;
  for (int ms = 10; ms < 3980; ++ms) square += dot(all.at(ms).velocity, all.at(ms).velocity) / 3970;
  EXPECT_LT(std::sqrt(square), 6.5e-3);
}

/// Samples that are closer than ticks: what is returned at ticks follows from about a tick, not from the noise of two neighbours.
TEST(SampleTrack, DenseSamplesMoveOverATick) {
  const auto motion = [](double t) {
    return along_x(t + (std::llround(t * 2e4) % 2 == 0 ? 1e-5 : 0));
  };  // +-0.4 m/s from one to the next
  const Recorded all(motion, every(0.05, 2000));
  for (int ms = 1; ms < 99; ++ms) EXPECT_NEAR(all.at(ms).velocity.x, 1, 0.011) << ms;
}

TEST(SampleTrack, FramesAndEqualTimes) {
  Track track({.gap = 1e9, .tick = kMs});
  track.add({0, {along_x(0), {}, {}}, 1});
  track.add({10 * kMs, {along_x(1), {}, {}}, 1});
  track.add({10 * kMs, {along_x(2), {}, {}}, 1});
  track.add({20 * kMs, {along_x(7), {}, {}}, 2});
  track.move_to(5 * kMs);
  EXPECT_NEAR(track.value().pose.position.x, 1, 1e-12);
  EXPECT_NEAR(track.span(), 10 * kMs, 1e-3);
  track.move_to(15 * kMs);  // in another frame from 20 ms on
  EXPECT_EQ(track.relation(), Relation::after);
  EXPECT_EQ(track.value().pose.position.x, 2);
  EXPECT_TRUE(track.is_near(5 * kMs));
  EXPECT_FALSE(track.is_near(4 * kMs));
  track.move_to(30 * kMs);
  EXPECT_EQ(track.frame(), 2u);
}

TEST(SampleTrack, TwoSamplesAreJoinedUpToTheGapAndNoFarther) {
  for (const auto& [apart, is_joined] : {std::pair{100, true}, std::pair{101, false}}) {
    Track track({.gap = 100.0 * kMs, .tick = kMs});
    track.add({0, {along_x(0), {}, {}}});
    track.add({apart * kMs, {along_x(apart), {}, {}}});
    track.move_to(50 * kMs);
    EXPECT_EQ(track.relation(), is_joined ? Relation::between : Relation::after) << apart;
    EXPECT_NEAR(track.moving(kNanosecond).pose.position.x, is_joined ? 50 : 0, 1e-9) << apart;
    EXPECT_NEAR(track.moving(kNanosecond).velocity.x, is_joined ? 1000 : 0, 1e-6) << apart;
  }
}

}  // namespace
}  // namespace tactus
