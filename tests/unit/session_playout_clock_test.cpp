// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/timing.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <random>

namespace tactus {
namespace {

/// Packets of every tick at 1 kHz that travel over a way of some delay, and a clock that is asked each millisecond.
struct Way {
  explicit Way(const PlayoutOptions& options = {}) : clock(1000, options) {}

  /// in   delay(time) [us]; nothing: lost.   Both times are those of the server's clock; the client's is `client(time)`.
  ///      every  [ticks] from number to number
  void run(std::uint64_t milliseconds, const std::function<std::optional<std::uint64_t>(std::uint64_t)>& delay,
           std::uint64_t every = 1) {
    for (const std::uint64_t end = time + 1000 * milliseconds; time < end; time += 1000) {
      const auto tick = static_cast<std::int64_t>(time / 1000);
      if (const auto after = delay(time)) coming.emplace(time + *after, tick);
      for (; !coming.empty() && coming.begin()->first <= time; coming.erase(coming.begin())) {
        const std::int64_t arrived = coming.begin()->second;
        clock.heard(static_cast<std::uint64_t>(arrived) / every + 1, arrived, client(coming.begin()->first));
        first = first < 0 ? arrived : first;
        ++packets;
        if (arrived < last && time >= settled) ++late;
      }
      const std::int64_t shown = clock.shown(client(time));
      EXPECT_GE(shown, last);
      EXPECT_GE(shown, first);
      EXPECT_LE(shown, tick);
      if (shown >= 0) lag = 1000 * (tick - shown);
      last = shown;
    }
  }

  PlayoutClock clock;
  std::function<std::uint64_t(std::uint64_t)> client = [](std::uint64_t t) { return t + 3'000'000'000; };
  std::uint64_t time = 0, settled = 2'000'000;  // [us]
  std::multimap<std::uint64_t, std::int64_t> coming;
  std::int64_t last = -1, first = -1, lag = 0;
  int packets = 0, late = 0;
};

TEST(PlayoutClock, WithoutPacketsThereIsNothingToShow) {
  PlayoutClock clock(1000, {});
  EXPECT_EQ(clock.shown(0), -1);
  EXPECT_EQ(clock.shown(1'000'000), -1);
  clock.heard(1, {}, 900'000);
  EXPECT_EQ(clock.shown(1'000'000), -1) << "a datagram without packets";
  clock.heard(2, 500, 1'000'000);
  EXPECT_EQ(clock.shown(1'000'000), 500) << "before its first packet nothing is known";
}

TEST(PlayoutClock, TellsHowLateATickIsShown) {
  PlayoutClock clock(1000, {.fixed = 20'000});
  EXPECT_FALSE(clock.behind(1'000'000));
  clock.heard(1, 500, 1'000'000);
  EXPECT_EQ(clock.shown(1'000'000), 500) << "not below that of the first packet";
  EXPECT_EQ(clock.behind(1'000'000), 0);
  EXPECT_EQ(clock.shown(1'050'300), 530);
  EXPECT_EQ(clock.behind(1'050'300), 20'300);
  EXPECT_EQ(clock.behind(1'051'000), 21'000) << "of the tick shown last";
}

TEST(PlayoutClock, AdaptsToJitterSoThatFewPacketsAreLate) {
  for (const std::uint64_t jitter : {0u, 3'000u, 30'000u}) {
    Way way;
    std::mt19937_64 random(jitter + 1);
    way.run(60'000, [&](std::uint64_t) { return 20'000 + random() % (jitter + 1); });
    EXPECT_LE(way.late, way.packets / 500) << jitter;
    EXPECT_GE(way.clock.delay(), static_cast<std::int64_t>(jitter + 9'000));
    EXPECT_LE(way.clock.delay(), static_cast<std::int64_t>(jitter + 32'000)) << jitter << ": nor more than there must be";
    EXPECT_NEAR(static_cast<double>(way.lag), static_cast<double>(20'000 + way.clock.delay()), 1500);
  }
}

TEST(PlayoutClock, LossChangesNothing) {
  Way way;
  std::mt19937_64 random(4);
  way.run(30'000, [&](std::uint64_t) { return random() % 2 ? std::optional<std::uint64_t>(random() % 30'000) : std::nullopt; });
  EXPECT_LE(way.late, way.packets / 500);
  EXPECT_LE(way.clock.delay(), 62'000);
}

/// Gilbert-Elliott: one loss in 20, on average five in a row.
TEST(PlayoutClock, BridgesBurstsOfLosses) {
  for (const std::uint64_t every : {1u, 5u}) {  // [ticks] from packet to packet
    Way way;
    std::mt19937_64 random(6);
    bool lost = false;
    std::uint64_t row = 0, long_rows = 0, rows = 0;
    way.run(
        60'000,
        [&](std::uint64_t time) {
          if (time / 1000 % every > 0) return std::optional<std::uint64_t>();
          lost = random() % 1000 < (lost ? 800u : 10u);
          if (!lost && row > 0) {
            ++rows;
            if (1000 * (row + 1) * every > static_cast<std::uint64_t>(way.clock.delay()) + 1000) ++long_rows;
          }
          row = lost ? row + 1 : 0;
          return lost ? std::nullopt : std::optional<std::uint64_t>(20'000);
        },
        every);
    EXPECT_GT(rows, 100u);
    EXPECT_LE(long_rows, rows * 2 / 5) << "a third of them, and those of which it has not heard yet";
    if (every == 1) {
      EXPECT_LE(way.clock.delay(), 45'000);
    } else {
      EXPECT_GT(way.clock.delay(), 30'000);
    }
    EXPECT_LE(way.clock.delay(), 151'000);
  }
}

TEST(PlayoutClock, GrowsAtOnceAndShrinksByAMillisecondPerSecond) {
  Way way;
  std::mt19937_64 random(5);
  const auto jitter = [&](std::uint64_t most) { return [&random, most](std::uint64_t) { return random() % most; }; };
  way.run(10'000, jitter(1'000));
  EXPECT_LT(way.clock.delay(), 32'000);
  way.run(1'000, jitter(60'000));
  const std::int64_t grown = way.clock.delay();
  EXPECT_GT(grown, 60'000);
  way.run(10'000, jitter(1'000));
  EXPECT_NEAR(static_cast<double>(way.clock.delay()), static_cast<double>(grown - 10'000), 2'500);
  way.run(60'000, jitter(1'000));
  EXPECT_LT(way.clock.delay(), 32'000);
}

TEST(PlayoutClock, AFixedDelayStays) {
  for (const std::uint32_t fixed : {0u, 25'000u}) {
    Way way({.fixed = fixed});
    std::mt19937_64 random(6);
    way.run(20'000, [&](std::uint64_t) { return 10'000 + random() % 20'000; });
    EXPECT_EQ(way.clock.delay(), fixed);
    EXPECT_NEAR(static_cast<double>(way.lag), 10'000.0 + fixed, 1'500) << "behind the fastest";
  }
}

/// For 20 minutes the client's clock runs fast or slow by 50 ppm: 60 ms in all.
TEST(PlayoutClock, FollowsADriftingClock) {
  for (const bool fast : {true, false}) {
    Way way;
    way.client = [fast](std::uint64_t t) { return fast ? t + t / 20'000 : t - t / 20'000; };
    std::mt19937_64 random(7);
    std::int64_t least = 1'000'000, most = 0;
    for (int minute = 0; minute < 20; ++minute) {
      way.run(60'000, [&](std::uint64_t) { return random() % 5'000; });
      least = std::min(least, way.lag);
      most = std::max(most, way.lag);
    }
    EXPECT_LE(way.late, way.packets / 500);
    EXPECT_GE(least, 10'000) << fast;
    EXPECT_LE(most, 40'000) << fast;
  }
}

/// Heartbeats alone, for an hour, from a clock that is 100 ppm faster or slower.
TEST(PlayoutClock, DriftAtRestAddsNoDelay) {
  for (const std::int64_t ppm : {-100, 100}) {
    PlayoutClock clock(1000, {});
    for (std::int64_t second = 0; second < 3600; ++second) {
      const std::int64_t now = 1'000'000 * second + ppm * second + 10'000'000;
      clock.heard(static_cast<std::uint64_t>(second) + 1, 1000 * second, static_cast<std::uint64_t>(now));
    }
    EXPECT_LE(clock.delay(), 40'000) << ppm;
  }
}

TEST(PlayoutClock, FollowsAWayThatChanges) {
  Way way;
  const auto constant = [](std::uint64_t delay) { return [delay](std::uint64_t) { return delay; }; };
  way.run(15'000, constant(80'000));
  way.run(1'000, constant(10'000));
  EXPECT_LT(way.lag, 120'000) << "a shorter way is used at once: packets come early";
  way.run(1'000, constant(200'000));
  way.run(1'000, constant(200'000));
  EXPECT_GE(way.lag, 200'000) << "a longer one, too";
  way.run(240'000, constant(200'000));
  EXPECT_LT(way.lag, 235'000);
}

TEST(PlayoutClock, ShownNeverFallsWhateverComes) {
  std::mt19937_64 random(8);
  for (const std::uint32_t rate : {1u, 60u, 1000u, 1'000'000u}) {
    PlayoutClock clock(rate, {});
    std::int64_t last = -1;
    std::uint64_t now = random() % 1'000'000'000'000;
    for (int i = 0; i < 20'000; ++i) {
      now += random() % (i % 100 == 0 ? 3'000'000 : 3'000);
      clock.heard(random() >> (random() % 64), static_cast<std::int64_t>(random() >> (32 + random() % 20)), now);
      const std::int64_t shown = clock.shown(now);
      ASSERT_GE(shown, last);
      ASSERT_GE(shown, 0);
      last = shown;
    }
  }
}

}  // namespace
}  // namespace tactus
