// SPDX-License-Identifier: Apache-2.0
/// How much may be sent, and what is sent again.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <set>
#include <span>
#include <vector>

#include <tactus/session/congestion.h>
#include <tactus/session/fragments.h>
#include <tactus/session/timing.h>
#include "tests/property/allocated.h"

namespace tactus {
namespace {

// ==== session congestion ====

constexpr std::uint64_t kPeriod = 500'000;  // [us]

/// A server's ticks, one each millisecond, and the answers of a client each 20 ms.
struct Ticks {
  explicit Ticks(double most = 8) : congestion(most) { congestion.begin(now); }
  /// in   wait  [ticks] each of `waits` rows of held ticks in each period, which begin evenly;  shapes  one each 20 ticks
  void periods(unsigned count, unsigned waits, unsigned wait, bool shapes = false) {
    const unsigned every = waits == 0 ? 500 : 500 / waits;
    for (unsigned i = 0; i < count; ++i)
      for (unsigned tick = 0; tick < 500; ++tick) {
        now += 1000;
        if (tick % 20 == 0) congestion.answered();
        const bool held = waits > 0 && tick % every < wait;
        if (congestion.tick(held, shapes && tick % 20 == 0, now)) ++changes;
      }
  }

  Congestion congestion;
  std::uint64_t now = 7 * kPeriod;
  int changes = 0;
};

TEST(Congestion, AFreeLinkScalesNothing) {
  Ticks run;
  run.periods(100, 0, 0);
  EXPECT_FALSE(run.congestion.waits());
  run.periods(100, 2, 25);
  EXPECT_FALSE(run.congestion.waits()) << "a tenth is not more than a tenth";
  EXPECT_EQ(run.congestion.bound_scale(), 1);
  EXPECT_EQ(run.congestion.so_far().time, 0u);
  EXPECT_EQ(run.congestion.so_far().largest, 1);
  EXPECT_EQ(run.changes, 0);
}

TEST(Congestion, WhatWaitsBrieflyTakesOthersAlong) {
  Ticks run;
  run.periods(100, 25, 19);  // of each 20 ticks
  EXPECT_TRUE(run.congestion.waits());
  EXPECT_EQ(run.congestion.bound_scale(), 1) << "nothing waits for long";
  run.periods(100, 5, 99);
  EXPECT_EQ(run.congestion.bound_scale(), 1);
  run.periods(1, 4, 124);
  EXPECT_EQ(run.congestion.bound_scale(), std::sqrt(2.0));
}

TEST(Congestion, AShapeThatWaitsIsNeverShown) {
  Ticks run;
  run.periods(4, 50, 1, true);  // of 10 ticks one: every second shape
  EXPECT_EQ(run.congestion.bound_scale(), 4);
  run.periods(1, 2, 1, true);  // two of 25
  EXPECT_EQ(run.congestion.bound_scale(), 4) << "neither calm nor congested";
  run.periods(1, 1, 0, true);
  EXPECT_EQ(run.congestion.bound_scale(), 2 * std::sqrt(2.0));
}

TEST(Congestion, SilenceSaysNothing) {
  Ticks run;
  run.periods(6, 1, 500);
  const double largest = run.congestion.bound_scale();
  EXPECT_GT(largest, 7);
  run.periods(1, 1, 0);
  for (unsigned tick = 0; tick < 60'000; ++tick) run.congestion.tick(false, false, run.now += 1000);
  const double silent = run.congestion.bound_scale();
  EXPECT_GT(silent, largest / 1.5) << "no answer came but in the first period";
  run.periods(6, 0, 0);
  EXPECT_LT(run.congestion.bound_scale(), silent);
}

TEST(Congestion, ScalesByStepsToItsLimit) {
  for (const double most : {1.0, 1.4, 2.0, 8.0, 64.0}) {
    Ticks run(most);
    run.periods(1, 1, 101);
    EXPECT_EQ(run.congestion.bound_scale(), most < 1.5 ? 1 : std::sqrt(2.0)) << most;
    run.periods(30, 1, 500);
    EXPECT_EQ(run.congestion.bound_scale(), most < 1.5 ? 1 : most);
    EXPECT_EQ(run.congestion.so_far().largest, run.congestion.bound_scale());
  }
}

TEST(Congestion, NarrowsAfterEachCalmPeriod) {
  Ticks run;
  run.periods(2, 1, 500);
  EXPECT_EQ(run.congestion.bound_scale(), 2);
  run.periods(1, 0, 0);
  EXPECT_EQ(run.congestion.bound_scale(), std::sqrt(2.0));
  run.periods(8, 5, 60);  // neither calm nor congested
  EXPECT_EQ(run.congestion.bound_scale(), std::sqrt(2.0));
  run.periods(1, 5, 50);
  EXPECT_EQ(run.congestion.bound_scale(), 1);
  EXPECT_EQ(run.changes, 4);
  EXPECT_EQ(run.congestion.so_far().largest, 2);
  EXPECT_EQ(run.congestion.so_far().time, (1 + 10) * kPeriod);
}

/// How many calm periods pass until a step narrower.
unsigned calm_needed(Ticks& run) {
  const double before = run.congestion.bound_scale();
  unsigned out = 0;
  for (; run.congestion.bound_scale() == before && out < 1000; ++out) run.periods(1, 0, 0);
  return out;
}

TEST(Congestion, AStepThatWasTooEarlyMakesItWaitLonger) {
  Ticks run;
  run.periods(4, 1, 500);
  for (const unsigned expected : {1u, 2u, 4u, 8u, 16u, 32u, 64u, 64u}) {
    EXPECT_EQ(calm_needed(run), expected);
    run.periods(1, 1, 500);
  }
  EXPECT_EQ(calm_needed(run), 64u);
  EXPECT_EQ(calm_needed(run), 64u) << "the one before still counts";
  EXPECT_EQ(calm_needed(run), 1u) << "it was not too early";
}

TEST(Congestion, ANewEpochBeginsAtItsBounds) {
  Ticks run;
  run.periods(4, 1, 500);
  const std::uint64_t before = run.congestion.so_far().time;
  EXPECT_EQ(before, 3 * kPeriod);
  run.congestion.begin(run.now);
  EXPECT_EQ(run.congestion.bound_scale(), 1);
  run.periods(4, 0, 0);
  EXPECT_EQ(run.congestion.so_far().time, before);
  EXPECT_EQ(run.congestion.so_far().largest, 4);
}

// ==== session loss bursts ====

constexpr std::uint64_t kEvery = 10'000;  // [us] from number to number; 10 ticks

/// Numbers 1 to `count` but those that are lost.
LossBursts with(std::uint64_t count, const std::set<std::uint64_t>& lost, std::uint64_t start = 0) {
  LossBursts out;
  for (std::uint64_t n = 1; n <= count; ++n)
    if (!lost.contains(n)) out.heard(start + n, static_cast<std::int64_t>(10 * n), kEvery * n);
  return out;
}

TEST(LossBursts, ABurstIsAsLongAsFromTheStateBeforeToTheStateAfter) {
  EXPECT_EQ(with(100, {40, 41, 42}).bridge(150, 100 * kEvery), 40);
  EXPECT_EQ(with(100, {40, 41, 42, 43, 44}).bridge(150, 100 * kEvery), 60);
  EXPECT_EQ(with(100, {40, 41, 42}, 10'000).bridge(150, 100 * kEvery), 40) << "what came before the first is not lost";
}

TEST(LossBursts, SingleLossesAreNone) {
  EXPECT_EQ(with(100, {}).bridge(150, 100 * kEvery), 0);
  EXPECT_EQ(with(100, {10, 11, 20, 30, 31}).bridge(150, 100 * kEvery), 0);
  EXPECT_EQ(with(100, {10, 11, 20, 40, 41, 42}).bridge(150, 100 * kEvery), 0) << "half are not most";
  EXPECT_EQ(with(100, {10, 11, 40, 41, 42}).bridge(150, 100 * kEvery), 40);
}

TEST(LossBursts, TwoThirdsOfThemAreBridged) {
  std::set<std::uint64_t> lost;
  for (std::uint64_t burst = 0; burst < 10; ++burst)
    for (std::uint64_t n = 0; n < 3 + burst; ++n) lost.insert(20 * burst + 10 + n);
  EXPECT_EQ(with(300, lost).bridge(1000, 300 * kEvery), 100);
}

TEST(LossBursts, OutagesAreNotBridged) {
  std::set<std::uint64_t> lost{10, 11, 12, 13};
  for (std::uint64_t n = 50; n < 70; ++n) lost.insert({n, n + 30});
  EXPECT_EQ(with(200, lost).bridge(150, 200 * kEvery), 50);
  EXPECT_EQ(with(200, lost).bridge(210, 200 * kEvery), 210);
  EXPECT_EQ(with(200, lost).bridge(40, 200 * kEvery), 0);
}

TEST(LossBursts, WhatIsOnlyLateIsNotLost) {
  LossBursts bursts = with(20, {17, 18, 19});
  EXPECT_EQ(bursts.bridge(150, 20 * kEvery + 99'999), 0);
  LossBursts same = bursts;
  EXPECT_EQ(bursts.bridge(150, 20 * kEvery + 100'000), 40);
  for (std::uint64_t n = 17; n < 20; ++n) same.heard(n, static_cast<std::int64_t>(10 * n), 20 * kEvery + 50'000);
  EXPECT_EQ(same.bridge(150, 20 * kEvery + 100'000), 0);
}

TEST(LossBursts, DatagramsWithoutPacketsAreNoStates) {
  LossBursts bursts;
  for (std::uint64_t n = 1; n <= 100; ++n) {
    const bool has_packets = n < 38 || n > 45;
    if (n < 40 || n > 42) bursts.heard(n, has_packets ? std::optional<std::int64_t>(10 * n) : std::nullopt, kEvery * n);
  }
  EXPECT_EQ(bursts.bridge(150, 100 * kEvery), 90);
}

TEST(LossBursts, OnlyTheNewestThousandNumbersCount) {
  EXPECT_EQ(with(1100, {40, 41, 42}).bridge(150, 1100 * kEvery), 0);
  EXPECT_EQ(with(1060, {40, 41, 42}).bridge(150, 1060 * kEvery), 40);
  LossBursts bursts = with(1100, {});
  bursts.heard(76, 5, 1100 * kEvery);  // too old: another stands in its place
  EXPECT_EQ(bursts.bridge(150, 1100 * kEvery), 0);
}

TEST(LossBursts, WhateverComesItIsWithinItsLimit) {
  std::mt19937_64 random(3);
  LossBursts bursts;
  std::uint64_t now = 0, number = 10;
  int bridged = 0;
  for (int i = 0; i < 20'000; ++i) {
    now += random() % 50'000;
    const auto tick = static_cast<std::int64_t>(random() >> (1 + random() % 63));
    number += random() % 8 == 0 ? random() % 40 : 1;
    bursts.heard(number - random() % 3, random() % 4 ? std::optional(tick % (i + 200)) : std::nullopt, now);
    if (i % 100 > 0) continue;
    const std::int64_t bridge = bursts.bridge(150, now);
    EXPECT_GE(bridge, 0);
    EXPECT_LE(bridge, 150);
    bridged += bridge > 0 ? 1 : 0;
  }
  EXPECT_GT(bridged, 20);
}

// ==== session resends ====

constexpr std::uint64_t kMillisecond = 1000;                                                                   // [us]
constexpr Resends::Latest kShapes{.chained = 400'000, .rigid = 120'000, .shape = 120'000, .one_way = 20'000};  // [us]

struct Sent {
  explicit Sent(std::size_t size = 40, std::size_t of = 2) : bytes(size, 7), substream(of) {}
  Packet packet(std::uint64_t number) const { return {.bytes = bytes, .substream = substream, .number = number}; }
  std::uint16_t keep(Resends& in, std::uint64_t datagram, std::uint64_t number, std::uint64_t now) const {
    return in.keep(datagram, packet(number), {.bytes = bytes}, now, substream == 0);
  }
  std::vector<std::uint8_t> bytes;
  std::size_t substream;
};

TEST(Resends, WhatIsLostGoesAgainOnce) {
  Resends resends(0);
  const Sent sent;
  std::vector<std::uint16_t> slots{Resends::kNone};
  for (std::uint64_t n = 1; n <= 5; ++n) slots.push_back(sent.keep(resends, n + 100, n, n * kMillisecond));
  EXPECT_EQ(resends.next(10 * kMillisecond, kShapes), nullptr);
  EXPECT_FALSE(resends.due());
  resends.lost(slots[3], 103, 50 * kMillisecond, 1);
  resends.lost(slots[4], 999, 50 * kMillisecond, 1);  // another datagram had this slot before
  resends.lost(Resends::kNone, 101, 50 * kMillisecond, 1);
  EXPECT_EQ(resends.due(), 50 * kMillisecond);
  const auto* copy = resends.next(50 * kMillisecond, kShapes);
  ASSERT_NE(copy, nullptr);
  EXPECT_EQ(copy->number, 3u);
  EXPECT_EQ(copy->substream, 2u);
  EXPECT_TRUE(std::ranges::equal(resends.bytes(*copy), sent.bytes));
  resends.sent(*copy, 106, 50 * kMillisecond);
  EXPECT_EQ(resends.next(51 * kMillisecond, kShapes), nullptr);
  EXPECT_FALSE(resends.due());
}

TEST(Resends, TheSecondCopyGoesTenMillisecondsLater) {
  Resends resends(0);
  const std::uint16_t slot = Sent().keep(resends, 1, 1, 0);
  resends.lost(slot, 1, 50 * kMillisecond, 2);
  resends.sent(*resends.next(52 * kMillisecond, kShapes), 2, 52 * kMillisecond);
  EXPECT_EQ(resends.next(62 * kMillisecond - 1, kShapes), nullptr);
  EXPECT_EQ(resends.due(), 62 * kMillisecond);
  resends.sent(*resends.next(62 * kMillisecond, kShapes), 3, 62 * kMillisecond);
  EXPECT_EQ(resends.next(90 * kMillisecond, kShapes), nullptr);
}

/// A lost copy goes again; one that arrives ends it, whichever of the datagrams that brought it.
TEST(Resends, TheDatagramOfTheLastCopyTakesOver) {
  Resends resends(0);
  const std::uint16_t slot = Sent().keep(resends, 1, 1, 0);
  resends.lost(slot, 1, 20 * kMillisecond, 2);
  EXPECT_EQ(resends.sent(*resends.next(20 * kMillisecond, kShapes), 2, 20 * kMillisecond), slot);
  resends.sent(*resends.next(30 * kMillisecond, kShapes), 3, 30 * kMillisecond);
  resends.lost(slot, 2, 40 * kMillisecond, 2);  // the other one is still on its way
  EXPECT_EQ(resends.next(40 * kMillisecond, kShapes), nullptr);
  resends.lost(slot, 3, 50 * kMillisecond, 2);
  ASSERT_NE(resends.next(50 * kMillisecond, kShapes), nullptr);
  resends.sent(*resends.next(50 * kMillisecond, kShapes), 4, 50 * kMillisecond);
  resends.arrived(slot, 2);  // late, not lost
  EXPECT_EQ(resends.next(60 * kMillisecond, kShapes), nullptr);
  resends.lost(slot, 4, 70 * kMillisecond, 2);
  EXPECT_EQ(resends.next(70 * kMillisecond, kShapes), nullptr);
  EXPECT_FALSE(resends.due());
}

TEST(Resends, OldPacketsDoNotGo) {
  Resends resends(0);
  const std::uint16_t slot = Sent().keep(resends, 1, 1, 0);
  resends.lost(slot, 1, 50 * kMillisecond, 2);
  Resends late = resends;
  EXPECT_NE(resends.next(100 * kMillisecond, kShapes), nullptr) << "it arrives 120 ms after the first";
  EXPECT_EQ(late.next(100 * kMillisecond + 1, kShapes), nullptr);
  EXPECT_FALSE(late.due());
  EXPECT_FALSE(late.poll_broken()) << "no other shape waits for it";
}

/// A chained packet that comes no more breaks the chain, unless a key packet has made it old.
TEST(Resends, KnowWhenAChainMustBeginAnew) {
  Resends resends(0);
  const Sent rigid(40, 0);
  const std::uint16_t slot = rigid.keep(resends, 1, 1, 0);
  resends.lost(slot, 1, 300 * kMillisecond, 2);
  Resends late = resends, renewed = resends;
  EXPECT_NE(resends.next(380 * kMillisecond, kShapes), nullptr);
  EXPECT_FALSE(resends.poll_broken());
  EXPECT_EQ(late.next(380 * kMillisecond + 1, kShapes), nullptr);
  EXPECT_EQ(late.poll_broken(), 0u);
  EXPECT_FALSE(late.poll_broken()) << "it says so once";
  renewed.settle_chain(0, 2);
  EXPECT_EQ(renewed.next(390 * kMillisecond, kShapes), nullptr);
  EXPECT_FALSE(renewed.poll_broken());
}

/// What finds no room may still arrive: the chain breaks when it is known to be lost, unless it has begun anew since.
TEST(Resends, ForgetWhatIsInFlightWithoutBreakingItsChain) {
  Resends full(0);  // 64 KiB
  std::vector<std::uint16_t> slots{Resends::kNone};
  for (std::uint64_t n = 1; n <= 66; ++n) slots.push_back(Sent(1000, 0).keep(full, n, n, 0));
  EXPECT_FALSE(full.poll_broken());
  EXPECT_FALSE(full.keeps(slots[1], 1));
  EXPECT_TRUE(full.keeps(slots[2], 2));
  full.miss(0, 1);
  EXPECT_EQ(full.poll_broken(), 0u);
  full.settle_chain(0, 60);  // a key packet
  full.miss(0, 59);
  EXPECT_FALSE(full.poll_broken());
  full.miss(0, 60);
  EXPECT_EQ(full.poll_broken(), 0u);
}

TEST(Resends, AllPacketsOfADatagramGoTheOldestFirst) {
  Resends resends(0);
  const Sent sent;
  const std::array slots{sent.keep(resends, 9, 12, 0), sent.keep(resends, 9, 11, 0), sent.keep(resends, 8, 10, 0)};
  for (const std::uint16_t slot : slots) resends.lost(slot, 9, kMillisecond, 1);
  for (const std::uint64_t number : {11u, 12u}) {
    const auto* copy = resends.next(kMillisecond, kShapes);
    ASSERT_NE(copy, nullptr);
    EXPECT_EQ(copy->number, number);
    resends.sent(*copy, 20, kMillisecond);
  }
  EXPECT_EQ(resends.next(kMillisecond, kShapes), nullptr);
}

TEST(Resends, FragmentsGoByThemselves) {
  Resends resends(5 * 1150);
  const Sent sent(2 * 1150 + 7);
  std::uint16_t last = 0;
  for (std::size_t i = 0; i < 3; ++i)
    last = resends.keep(20 + i, sent.packet(4), {i, 3, std::span(sent.bytes).subspan(i * 1150, i < 2 ? 1150 : 7)}, 0, false);
  resends.lost(last, 22, kMillisecond, 1);
  const auto* copy = resends.next(kMillisecond, kShapes);
  ASSERT_NE(copy, nullptr);
  EXPECT_EQ(copy->number, 4u);
  EXPECT_EQ(copy->index, 2u);
  EXPECT_EQ(copy->count, 3u);
  EXPECT_TRUE(std::ranges::equal(resends.bytes(*copy), std::vector<std::uint8_t>(7, 7)));
  resends.sent(*copy, 23, kMillisecond);
  EXPECT_EQ(resends.next(kMillisecond, kShapes), nullptr);
}

/// Nothing is allocated, what is dropped never goes, and bytes are those of their packets.
TEST(Resends, ForgetsTheOldestAndAllocatesNothing) {
  Resends resends(0);
  std::mt19937_64 random(1);
  Sent large(1150);
  const std::uint64_t before = testing::allocated_bytes();
  std::uint64_t number = 0, now = 0, copies = 0;
  std::array<std::uint16_t, 100> slots{};
  for (int i = 0; i < 20'000; ++i) {
    now += random() % 5'000;
    ++number;
    std::ranges::fill(large.bytes, static_cast<std::uint8_t>(number));
    slots[number % 100] = large.keep(resends, number, number, now);
    if (random() % 2) {
      const std::uint64_t lost = number - std::min<std::uint64_t>(number - 1, random() % 100);
      resends.lost(slots[lost % 100], lost, now, 1 + random() % 2);
    }
    while (const auto* copy = random() % 4 ? resends.next(now, kShapes) : nullptr) {
      ASSERT_GT(copy->number + 57, number) << "56 have room";
      ASSERT_LE(now + kShapes.one_way, copy->time + 120'000);
      ASSERT_TRUE(
          std::ranges::all_of(resends.bytes(*copy), [&](auto b) { return b == static_cast<std::uint8_t>(copy->number); }));
      resends.sent(*copy, number, now);
      ++copies;
    }
  }
  EXPECT_GT(copies, 1'000u);
  EXPECT_EQ(testing::allocated_bytes(), before);
  now += 1'000'000;
  EXPECT_EQ(resends.next(now, kShapes), nullptr);
  EXPECT_FALSE(resends.due()) << "none of those that waited is left";
}

// ==== session held packets ====

TEST(HeldPackets, AreInOrderOfTheirNumbers) {
  HeldPackets held(100);
  EXPECT_FALSE(held.waits_since(100));
  for (const std::uint64_t number : {7u, 3u, 9u, 3u}) {
    const std::vector<std::uint8_t> bytes(static_cast<std::size_t>(number), static_cast<std::uint8_t>(number));
    EXPECT_TRUE(held.hold(number, 0, bytes, 100 - number));
  }
  ASSERT_EQ(held.size(), 3u) << "a repeated one is held once";
  for (std::size_t i = 0; const std::uint64_t number : {3u, 7u, 9u}) {
    EXPECT_EQ(held[i].number, number);
    EXPECT_EQ(held.bytes(held[i]).size(), number);
    EXPECT_EQ(held.bytes(held[i++]).front(), number);
  }
  EXPECT_EQ(held.waits_since(100), 91u);
  held.remove_if([](const HeldPackets::Held& one) { return one.number == 9; });
  EXPECT_EQ(held.waits_since(100), 93u);
  held.remove_if([](const HeldPackets::Held&) { return true; });
  EXPECT_TRUE(held.empty());
}

/// Who makes a client hold packets gets no more than 1024 and 64 KiB, and no allocation; gaps are used again.
TEST(HeldPackets, AreBounded) {
  HeldPackets small(100), large(100'000), held(1);
  const std::uint64_t before = testing::allocated_bytes();
  const std::array<std::uint8_t, 1000> bytes{};
  for (std::uint64_t n = 1; n <= 1024; ++n) EXPECT_TRUE(small.hold(n, 0, std::span(bytes).first(1), 0)) << n;
  EXPECT_FALSE(small.hold(1025, 0, std::span(bytes).first(1), 0));
  for (std::uint64_t n = 1; n <= 100; ++n) EXPECT_TRUE(large.hold(n, 0, bytes, 0)) << n;
  EXPECT_FALSE(large.hold(101, 0, bytes, 0));
  std::mt19937_64 random(2);
  std::array<std::uint8_t, 600> sized{};
  std::uint64_t kept = 0;
  for (std::uint64_t n = 1; n <= 20'000; ++n) {
    const std::size_t size = 1 + random() % sized.size();
    std::ranges::fill(sized, static_cast<std::uint8_t>(n));
    const std::size_t all = held.size();
    if (held.hold(n, 0, std::span(sized).first(size), n)) ++kept;
    else EXPECT_GT(all * 600 + 600, HeldPackets::kBytes);
    if (random() % 3 == 0) held.remove_if([&](const HeldPackets::Held& one) { return one.number % 7 == random() % 7; });
    for (std::size_t i = 0; i < held.size(); i += 17)
      for (const std::uint8_t byte : held.bytes(held[i])) ASSERT_EQ(byte, static_cast<std::uint8_t>(held[i].number));
  }
  EXPECT_GT(kept, 10'000u);
  EXPECT_EQ(testing::allocated_bytes(), before);
}

}  // namespace
}  // namespace tactus
