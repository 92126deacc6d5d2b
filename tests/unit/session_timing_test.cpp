// SPDX-License-Identifier: Apache-2.0
/// Clocks of a session, and when what is shown and rendered.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <map>
#include <random>
#include <vector>

#include <tactus/session/timing.h>

namespace tactus {
namespace {

// ==== session clock offset ====

TEST(ClockOffset, OfASymmetricLinkIsExact) {
  ClockOffset offset;
  EXPECT_EQ(offset.value(), std::nullopt);
  offset.add(5'000'000, 40'000, 1'000'000);
  EXPECT_EQ(offset.value(), 4'020'000) << "the other clock said 5 s, 20 ms ago";
  ClockOffset behind;
  behind.add(1'000'000, 40'000, 5'000'000);
  EXPECT_EQ(behind.value(), -3'980'000);
}

/// in   there, back  [us] of delay;  offset  [us] of the other clock
void exchange(ClockOffset& of, std::uint64_t now, std::int64_t there, std::int64_t back, std::int64_t offset) {
  of.add(static_cast<std::uint64_t>(static_cast<std::int64_t>(now) - back + offset), there + back, now);
}

TEST(ClockOffset, TheFastestOfEachDirectionInTenSecondsCounts) {
  ClockOffset offset;
  exchange(offset, 1'000'000, 10'000, 50'000, 100'000);
  EXPECT_EQ(offset.value(), 80'000);
  exchange(offset, 3'000'000, 70'000, 10'000, 100'000);
  EXPECT_EQ(offset.value(), 100'000) << "there in 10 ms, back in 10 ms, of two exchanges";
  exchange(offset, 9'900'000, 90'000, 90'000, 100'000);
  EXPECT_EQ(offset.value(), 100'000);
  exchange(offset, 12'000'000, 80'000, 80'000, 100'000);
  EXPECT_EQ(offset.value(), 130'000) << "70 and 10 ms: the first is over 10 s ago";
  exchange(offset, 800'000'000, 30'000, 30'000, -7'000);
  EXPECT_EQ(offset.value(), -7'000) << "long after all others";
}

/// Jitter of up to 30 ms each way, and a clock that runs fast by 50 ppm.
TEST(ClockOffset, StaysNearUnderJitterAndDrift) {
  ClockOffset offset;
  std::mt19937_64 random(2);
  for (std::uint64_t sent = 1'000'000; sent < 300'000'000; sent += 100'000) {
    const std::uint64_t there = random() % 30'000, back = random() % 30'000, now = sent + there + back;
    const auto other = [](std::uint64_t time) { return time + time / 20'000 + 7'000'000'000; };
    offset.add(other(sent + there), static_cast<std::int64_t>(there + back), now);
    if (sent < 11'000'000) continue;
    const auto truth = static_cast<std::int64_t>(other(now) - now);
    EXPECT_LT(std::abs(*offset.value() - truth), 1'500) << sent << ": 50 ppm of 10 s are 500 us";
  }
}

// ==== session playout clock ====

/// Packets of every tick at 1 kHz that travel over a link of some delay, and a clock that is asked each millisecond.
struct DelayedTicks {
  explicit DelayedTicks(const PlayoutOptions& options = {}) : clock(1000, options) {}

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

TEST(PlayoutClock, ReportsHowLateATickIsShown) {
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
    DelayedTicks line;
    line.clock.set_repair(RoundTrip{.smoothed = 40'000, .variation = 0, .least = 40'000});
    std::mt19937_64 random(jitter + 1);
    line.run(60'000, [&](std::uint64_t) { return 20'000 + random() % (jitter + 1); });
    EXPECT_LE(line.late, line.packets / 500) << jitter;
    EXPECT_GE(line.clock.delay(), static_cast<std::int64_t>(jitter + 9'000));
    EXPECT_LE(line.clock.delay(), static_cast<std::int64_t>(jitter + 32'000)) << jitter << ": nor more than there must be";
    EXPECT_NEAR(static_cast<double>(line.lag), static_cast<double>(20'000 + line.clock.delay()), 1500);
  }
}

/// Where nothing waits for what is lost, a hand does not wait for what does not come late.
TEST(PlayoutClock, WaitsForNothingThatIsNotLate) {
  struct Expected {
    std::uint64_t jitter = 0;
    std::int64_t delay = 0;
  };
  for (const Expected& of : {Expected{0, 2'000}, Expected{3'000, 5'000}, Expected{30'000, 45'000}}) {
    const std::uint64_t jitter = of.jitter;
    DelayedTicks line;
    std::mt19937_64 random(jitter + 1);
    line.run(60'000, [&](std::uint64_t) { return 20'000 + random() % (jitter + 1); });
    EXPECT_LE(line.late, line.packets / 500) << jitter;
    EXPECT_NEAR(static_cast<double>(line.clock.delay()), static_cast<double>(of.delay), 1'000) << jitter;
    EXPECT_NEAR(static_cast<double>(line.lag), static_cast<double>(20'000 + line.clock.delay()), 1500);
    line.run(3'000, [&, n = 0](std::uint64_t) mutable { return ++n % 50 ? std::optional<std::uint64_t>(20'000) : std::nullopt; });
    EXPECT_GE(line.clock.delay(), of.delay + (jitter < 30'000 ? 20'000 : -4'000)) << jitter << ": packets are lost";
  }
}

TEST(PlayoutClock, LossChangesNothing) {
  DelayedTicks line;
  std::mt19937_64 random(4);
  line.run(30'000, [&](std::uint64_t) { return random() % 2 ? std::optional<std::uint64_t>(random() % 30'000) : std::nullopt; });
  EXPECT_LE(line.late, line.packets / 500);
  EXPECT_LE(line.clock.delay(), 62'000);
}

/// Gilbert-Elliott: one loss in 20, on average five in a row.
TEST(PlayoutClock, BridgesBurstsOfLosses) {
  for (const std::uint64_t every : {1u, 5u}) {  // [ticks] from packet to packet
    DelayedTicks line;
    std::mt19937_64 random(6);
    bool lost = false;
    std::uint64_t row = 0, long_rows = 0, rows = 0;
    line.run(
        60'000,
        [&](std::uint64_t time) {
          if (time / 1000 % every > 0) return std::optional<std::uint64_t>();
          lost = random() % 1000 < (lost ? 800u : 10u);
          if (!lost && row > 0) {
            ++rows;
            if (1000 * (row + 1) * every > static_cast<std::uint64_t>(line.clock.delay()) + 1000) ++long_rows;
          }
          row = lost ? row + 1 : 0;
          return lost ? std::nullopt : std::optional<std::uint64_t>(20'000);
        },
        every);
    EXPECT_GT(rows, 100u);
    EXPECT_LE(long_rows, rows * 2 / 5) << "a third of them, and those of which it has not heard yet";
    if (every == 1) {
      EXPECT_LE(line.clock.delay(), 45'000);
    } else {
      EXPECT_GT(line.clock.delay(), 30'000);
    }
    EXPECT_LE(line.clock.delay(), 151'000);
  }
}

TEST(PlayoutClock, GrowsAtOnceAndShrinksByAMillisecondPerSecond) {
  DelayedTicks line;
  std::mt19937_64 random(5);
  const auto jitter = [&](std::uint64_t most) { return [&random, most](std::uint64_t) { return random() % most; }; };
  line.run(10'000, jitter(1'000));
  EXPECT_LT(line.clock.delay(), 32'000);
  line.run(1'000, jitter(60'000));
  const std::int64_t grown = line.clock.delay();
  EXPECT_GT(grown, 60'000);
  line.run(10'000, jitter(1'000));
  EXPECT_NEAR(static_cast<double>(line.clock.delay()), static_cast<double>(grown - 10'000), 2'500);
  line.run(60'000, jitter(1'000));
  EXPECT_LT(line.clock.delay(), 32'000);
}

TEST(PlayoutClock, AFixedDelayStays) {
  for (const std::uint32_t fixed : {0u, 25'000u}) {
    DelayedTicks line({.fixed = fixed});
    std::mt19937_64 random(6);
    line.run(20'000, [&](std::uint64_t) { return 10'000 + random() % 20'000; });
    EXPECT_EQ(line.clock.delay(), fixed);
    EXPECT_NEAR(static_cast<double>(line.lag), 10'000.0 + fixed, 1'500) << "behind the fastest";
  }
}

/// For 20 minutes the client's clock runs fast or slow by 50 ppm: 60 ms in all.
TEST(PlayoutClock, FollowsADriftingClock) {
  for (const bool fast : {true, false}) {
    DelayedTicks line;
    line.client = [fast](std::uint64_t t) { return fast ? t + t / 20'000 : t - t / 20'000; };
    std::mt19937_64 random(7);
    std::int64_t least = 1'000'000, most = 0;
    for (int minute = 0; minute < 20; ++minute) {
      line.run(60'000, [&](std::uint64_t) { return random() % 5'000; });
      least = std::min(least, line.lag);
      most = std::max(most, line.lag);
    }
    EXPECT_LE(line.late, line.packets / 500);
    EXPECT_GE(least, 5'000) << fast;
    EXPECT_LE(most, 15'000) << fast;
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

TEST(PlayoutClock, FollowsADelayThatChanges) {
  DelayedTicks line;
  const auto constant = [](std::uint64_t delay) { return [delay](std::uint64_t) { return delay; }; };
  line.run(15'000, constant(80'000));
  line.run(1'000, constant(10'000));
  EXPECT_LT(line.lag, 120'000) << "a shorter delay is used at once: packets come early";
  line.run(1'000, constant(200'000));
  line.run(1'000, constant(200'000));
  EXPECT_GE(line.lag, 200'000) << "a longer one, too";
  line.run(240'000, constant(200'000));
  EXPECT_LT(line.lag, 235'000);
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

// ==== session device tick mapping ====

std::vector<TickMappingPart> sent_in(DeviceTickMapping& mapping, std::uint64_t number) {
  DatagramWriter writer(Direction::down);
  writer.begin(number);
  mapping.send(writer, number);
  if (writer.empty()) return {};
  const auto bytes = writer.finish(7);
  const auto read = read_datagram(bytes, Direction::down).value();
  PartReader parts = std::get<Numbered>(read).parts(Direction::down);
  std::vector<TickMappingPart> out;
  while (const auto part = parts.next().value()) out.push_back(std::get<TickMappingPart>(*part));
  return out;
}

TEST(DeviceTickMapping, TheFastestPacketActsTwoMillisecondsAfterItCame) {
  DeviceTickMapping mapping(1000);
  const auto first = mapping.step(500, 430);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->from, 500);
  EXPECT_EQ(first->offset, 72);
  EXPECT_FALSE(mapping.step(501, 431));
}

TEST(DeviceTickMapping, WhatIsLateSlowsItDownAtOnce) {
  DeviceTickMapping mapping(1000);
  mapping.step(500, 430);
  mapping.heard(500 - 72 + 3);
  EXPECT_FALSE(mapping.step(501, 431));
  mapping.heard(501 - 72 - 4);
  mapping.heard(501 - 72);
  const auto slower = mapping.step(502, 432);
  ASSERT_TRUE(slower);
  EXPECT_EQ(slower->offset, 72 + 5);
  EXPECT_FALSE(mapping.step(503, 433)) << "once";
}

/// The delay gets longer by 100 ms, with a packet every 10 ms: until the device's tick goes on, all are too late to count, and the offset does not
/// get slower for it.
TEST(DeviceTickMapping, AJumpOfTheDelaySlowsItDownByAsMuch) {
  DeviceTickMapping mapping(1000);
  std::int64_t offset = mapping.step(0, -5)->offset;
  for (std::int64_t tick = 1; tick < 2000; ++tick) {
    if (tick % 10 == 0) mapping.heard(tick - (tick < 500 ? 5 : 105));
    if (const auto change = mapping.step(tick, tick - 5)) offset = change->offset;
  }
  EXPECT_GE(offset, 105);
  EXPECT_LE(offset, 108);
}

TEST(DeviceTickMapping, ItGetsFasterWhereAllComeEarly) {
  DeviceTickMapping mapping(1000);
  mapping.step(0, -50);
  std::int64_t offset = 52, faster = 0;
  for (std::int64_t tick = 1; tick <= 10'000; ++tick) {
    mapping.heard(tick - 1 - 47);  // of a link that always takes as long
    if (const auto change = mapping.step(tick, tick - 50)) {
      EXPECT_EQ(change->offset, offset - 1) << "a tick at a time";
      offset = change->offset;
      ++faster;
    }
  }
  EXPECT_EQ(faster, 3) << "until they come 2 ms before they act";
}

TEST(DeviceTickMapping, WithoutPacketsItStays) {
  DeviceTickMapping mapping(1000);
  mapping.step(0, -50);
  for (std::int64_t tick = 1; tick <= 10'000; ++tick) EXPECT_FALSE(mapping.step(tick, tick - 50));
}

TEST(DeviceTickMapping, ChangesAreSentUntilTheyAreAcknowledged) {
  DeviceTickMapping mapping(1000);
  EXPECT_FALSE(mapping.waits());
  mapping.step(500, 430);
  EXPECT_TRUE(mapping.waits());
  EXPECT_EQ(sent_in(mapping, 10).size(), 1u);
  mapping.heard(427);
  mapping.step(600, 530);
  const auto both = sent_in(mapping, 11);
  ASSERT_EQ(both.size(), 2u);
  EXPECT_EQ(both[0].from, 500);
  EXPECT_EQ(both[1].from, 600);
  mapping.acknowledged(9);
  EXPECT_EQ(sent_in(mapping, 12).size(), 2u);
  mapping.acknowledged(10);
  EXPECT_EQ(sent_in(mapping, 13).size(), 1u);
  mapping.acknowledged(11);
  EXPECT_FALSE(mapping.waits());
  EXPECT_TRUE(sent_in(mapping, 14).empty());
}

/// More changes than are kept: the newest are sent.
TEST(DeviceTickMapping, TheNewestChangesAreSent) {
  DeviceTickMapping mapping(1000);
  mapping.step(0, 0);
  for (std::int64_t tick = 1; tick < 20; ++tick) {
    mapping.heard(-100 * tick);
    mapping.step(tick, tick);
  }
  const auto all = sent_in(mapping, 3);
  ASSERT_EQ(all.size(), 8u);
  EXPECT_EQ(all.back().from, 19);
  EXPECT_EQ(all.front().from, 12);
}

// ==== session force fade ====

constexpr std::uint64_t kStart = 10'000'000, kMillis = 1000;

/// A fade that was looked at each millisecond while news came each millisecond, until all is permitted.
ForceFade risen() {
  ForceFade fade;
  EXPECT_EQ(fade.fraction(kStart - 600 * kMillis, 0), 0);
  for (std::uint64_t t = kStart - 599 * kMillis; t <= kStart; t += kMillis) fade.fraction(t, t);
  return fade;
}

TEST(ForceFade, FallsFrom70To100MillisecondsWithoutNews) {
  ForceFade fade = risen();
  for (std::uint64_t age = 0; age <= 70; ++age) EXPECT_EQ(fade.fraction(kStart + age * kMillis, kStart), ForceFade::kAll) << age;
  EXPECT_EQ(fade.fraction(kStart + 85 * kMillis, kStart), ForceFade::kAll / 2);
  EXPECT_EQ(fade.fraction(kStart + 100 * kMillis, kStart), 0);
  for (const std::uint64_t age : {101u, 1000u, 1'000'000u}) EXPECT_EQ(fade.fraction(kStart + age * kMillis, kStart), 0);
}

/// A client that computes what its device does waits longer for news.
TEST(ForceFade, FallsFrom300To400MillisecondsInADrivenScene) {
  ForceFade fade = risen();
  fade.set_limits(ForceFade::kDriven);
  EXPECT_EQ(fade.fraction(kStart + 300 * kMillis, kStart), ForceFade::kAll);
  EXPECT_EQ(fade.fraction(kStart + 350 * kMillis, kStart), ForceFade::kAll / 2);
  EXPECT_EQ(fade.fraction(kStart + 400 * kMillis, kStart), 0);
}

TEST(ForceFade, ReturnsOverHalfASecond) {
  for (const std::uint64_t step : {100u, 1000u, 10'000u}) {  // however often one looks
    ForceFade fade = risen();
    const std::uint64_t back = kStart + 3'000'000;
    for (std::uint64_t t = kStart; t <= back; t += step) fade.fraction(t, kStart);
    for (std::uint64_t t = back + step; t <= back + 500'000; t += step) {
      const double fraction = static_cast<double>(fade.fraction(t, t)) / ForceFade::kAll;
      EXPECT_NEAR(fraction, static_cast<double>(t - back) / 500'000, 0.01) << step;
    }
    EXPECT_NEAR(static_cast<double>(fade.fraction(back + 500'000, back + 500'000)), ForceFade::kAll, 0.01 * ForceFade::kAll);
  }
}

TEST(ForceFade, NeverJumps) {
  ForceFade fade = risen();
  std::mt19937_64 random(1);
  std::int64_t before = ForceFade::kAll;
  std::uint64_t heard = kStart, next = kStart;
  for (std::uint64_t now = kStart; now < kStart + 60'000'000; now += kMillis) {
    if (now >= next) {
      heard = now;
      next = now + random() % 200'000;
    }
    const std::int64_t fraction = fade.fraction(now, heard);
    EXPECT_LE(fraction - before, ForceFade::kAll / 500 + 1);
    EXPECT_LE(before - fraction, ForceFade::kAll / 30 + 1);
    EXPECT_TRUE(fraction >= 0 && fraction <= ForceFade::kAll);
    before = fraction;
  }
}

TEST(ForceFade, StartsWithNothing) {
  ForceFade fade;
  EXPECT_EQ(fade.fraction(kStart, 0), 0);
  EXPECT_LT(fade.fraction(kStart + kMillis, kStart + kMillis), ForceFade::kAll / 100);
}

/// A session that begins or comes back while something is touched: nobody looked for a while.
TEST(ForceFade, RisesSlowlyAfterAPauseToo) {
  ForceFade first;
  EXPECT_LT(first.fraction(kStart, kStart), ForceFade::kAll / 100);
  ForceFade fade = risen();
  const std::uint64_t later = kStart + 60'000'000;
  EXPECT_LT(fade.fraction(later, later), ForceFade::kAll / 100);
  EXPECT_NEAR(static_cast<double>(fade.fraction(later + 50'000, later + 50'000)), ForceFade::kAll / 10, ForceFade::kAll / 100);
}

TEST(ForceFade, ANewContactNeedNotRise) {
  ForceFade fade;
  fade.release(kStart);
  EXPECT_EQ(fade.fraction(kStart + kMillis, kStart + kMillis), ForceFade::kAll);
  fade.release(kStart + 200 * kMillis);
  EXPECT_EQ(fade.fraction(kStart + 200 * kMillis, kStart), 0) << "but not on old news";
}

}  // namespace
}  // namespace tactus
