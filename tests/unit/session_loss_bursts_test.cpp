// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/timing.h>

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace tactus {
namespace {

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

}  // namespace
}  // namespace tactus
