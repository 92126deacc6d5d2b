// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/congestion.h>

#include <gtest/gtest.h>

#include <cmath>

namespace tactus {
namespace {

constexpr std::uint64_t kPeriod = 500'000;  // [us]

/// A server's ticks, one each millisecond, and the answers of a client each 20 ms.
struct Ticks {
  explicit Ticks(double most = 8) : congestion(most) { congestion.begin(now); }
  /// in   held  of the ticks of each period, the first ones      trip  [us] of each answer
  void periods(unsigned count, unsigned held, std::int64_t trip = 40'000) {
    for (unsigned i = 0; i < count; ++i) {
      for (unsigned tick = 0; tick < 500; ++tick) {
        now += 1000;
        if (tick % 20 == 0) congestion.round_trip({trip, variation, 40'000}, trip, now);
        if (congestion.tick(tick < held, now)) ++changes;
      }
    }
  }

  Congestion congestion;
  std::uint64_t now = 7 * kPeriod;
  std::int64_t variation = 5'000;
  int changes = 0;
};

TEST(Congestion, AFreeWayWidensNothing) {
  Ticks run;
  run.periods(100, 0);
  run.periods(100, 49);
  EXPECT_EQ(run.congestion.widening(), 1);
  EXPECT_EQ(run.congestion.so_far().time, 0u);
  EXPECT_EQ(run.congestion.so_far().widest, 1);
  EXPECT_EQ(run.changes, 0);
}

TEST(Congestion, SilenceSaysNothing) {
  Ticks run;
  run.periods(6, 500);
  const double widest = run.congestion.widening();
  EXPECT_GT(widest, 7);
  for (unsigned tick = 0; tick < 60'000; ++tick) run.congestion.tick(false, run.now += 1000);
  EXPECT_EQ(run.congestion.widening(), widest) << "no answer came";
  run.periods(6, 0);
  EXPECT_LT(run.congestion.widening(), widest);
}

TEST(Congestion, WidensByStepsToItsLimit) {
  for (const double most : {1.0, 1.4, 2.0, 8.0, 64.0}) {
    Ticks run(most);
    run.periods(1, 51);
    EXPECT_EQ(run.congestion.widening(), most < 1.5 ? 1 : std::sqrt(2.0)) << most;
    run.periods(30, 500);
    EXPECT_EQ(run.congestion.widening(), most < 1.5 ? 1 : most);
    EXPECT_EQ(run.congestion.so_far().widest, run.congestion.widening());
  }
}

TEST(Congestion, AStandingQueueIsCongestion) {
  Ticks run;
  run.periods(4, 0, 119'000);
  EXPECT_EQ(run.congestion.widening(), 1);
  run.periods(4, 0, 121'000);
  EXPECT_EQ(run.congestion.widening(), 4);
  Ticks jitter;
  jitter.variation = 50'000;
  jitter.periods(4, 0, 139'000);
  EXPECT_EQ(jitter.congestion.widening(), 1);
}

TEST(Congestion, OneFastAnswerInAPeriodIsEnough) {
  Ticks run;
  for (int i = 0; i < 8; ++i) {
    run.congestion.round_trip({500'000, 1000, 40'000}, 40'500, run.now);
    run.periods(1, 0, 500'000);
  }
  EXPECT_EQ(run.congestion.widening(), 1);
}

TEST(Congestion, NarrowsAfterFourCalmPeriodsEach) {
  Ticks run;
  run.periods(2, 500);
  EXPECT_EQ(run.congestion.widening(), 2);
  run.periods(3, 0);
  EXPECT_EQ(run.congestion.widening(), 2);
  run.periods(1, 0);
  EXPECT_EQ(run.congestion.widening(), std::sqrt(2.0));
  run.periods(3, 0);
  run.periods(1, 1);  // neither calm nor congested: it begins anew
  run.periods(3, 0);
  EXPECT_EQ(run.congestion.widening(), std::sqrt(2.0));
  run.periods(1, 0);
  EXPECT_EQ(run.congestion.widening(), 1);
  EXPECT_EQ(run.changes, 4);
  EXPECT_EQ(run.congestion.so_far().widest, 2);
  EXPECT_EQ(run.congestion.so_far().time, (1 + 12) * kPeriod);
}

/// How many calm periods pass until a step narrower.
unsigned patience(Ticks& run) {
  const double before = run.congestion.widening();
  unsigned out = 0;
  for (; run.congestion.widening() == before && out < 1000; ++out) run.periods(1, 0);
  return out;
}

TEST(Congestion, AStepThatWasTooEarlyMakesItWaitLonger) {
  Ticks run;
  run.periods(4, 500);
  for (const unsigned expected : {4u, 8u, 16u, 32u, 64u, 64u}) {
    EXPECT_EQ(patience(run), expected);
    run.periods(1, 500);
  }
  EXPECT_EQ(patience(run), 64u);
  EXPECT_EQ(patience(run), 64u) << "the one before still counts";
  EXPECT_EQ(patience(run), 4u) << "it was not too early";
}

TEST(Congestion, ANewEpochBeginsAtItsBounds) {
  Ticks run;
  run.periods(4, 500);
  const std::uint64_t before = run.congestion.so_far().time;
  EXPECT_EQ(before, 3 * kPeriod);
  run.congestion.begin(run.now);
  EXPECT_EQ(run.congestion.widening(), 1);
  run.periods(4, 0);
  EXPECT_EQ(run.congestion.so_far().time, before);
  EXPECT_EQ(run.congestion.so_far().widest, 4);
}

}  // namespace
}  // namespace tactus
