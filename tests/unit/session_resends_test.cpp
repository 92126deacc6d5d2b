// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/fragments.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "tests/property/allocated.h"

namespace tactus {
namespace {

constexpr std::uint64_t kMillisecond = 1000, kWay = 20'000;  // [us]

struct Sent {
  explicit Sent(std::size_t size = 40) : bytes(size, 7) {}
  Packet packet(std::uint64_t number) const {
    return {.bytes = bytes, .substream = 2, .sequence = static_cast<std::uint16_t>(number), .number = number};
  }
  void keep(Resends& in, std::uint64_t datagram, std::uint64_t number, std::uint64_t now) const {
    in.keep(datagram, packet(number), {.bytes = bytes}, now);
  }
  std::vector<std::uint8_t> bytes;
};

TEST(Resends, WhatIsLostGoesAgainOnce) {
  Resends resends(0);
  const Sent sent;
  for (std::uint64_t n = 1; n <= 5; ++n) sent.keep(resends, n + 100, n, n * kMillisecond);
  EXPECT_EQ(resends.next(10 * kMillisecond, kWay), nullptr);
  EXPECT_FALSE(resends.due());
  resends.lost(103, 50 * kMillisecond, 1);
  resends.lost(999, 50 * kMillisecond, 1);
  EXPECT_EQ(resends.due(), 50 * kMillisecond);
  const auto* copy = resends.next(50 * kMillisecond, kWay);
  ASSERT_NE(copy, nullptr);
  EXPECT_EQ(copy->number, 3u);
  EXPECT_EQ(copy->substream, 2u);
  EXPECT_EQ(copy->sequence, 3u);
  EXPECT_EQ(copy->bytes, sent.bytes);
  resends.sent(*copy, 50 * kMillisecond);
  EXPECT_EQ(resends.next(51 * kMillisecond, kWay), nullptr);
  EXPECT_FALSE(resends.due());
}

TEST(Resends, TheSecondCopyGoesTenMillisecondsLater) {
  Resends resends(0);
  const Sent sent;
  sent.keep(resends, 1, 1, 0);
  resends.lost(1, 50 * kMillisecond, 2);
  resends.sent(*resends.next(52 * kMillisecond, kWay), 52 * kMillisecond);
  EXPECT_EQ(resends.next(62 * kMillisecond - 1, kWay), nullptr);
  EXPECT_EQ(resends.due(), 62 * kMillisecond);
  resends.sent(*resends.next(62 * kMillisecond, kWay), 62 * kMillisecond);
  EXPECT_EQ(resends.next(90 * kMillisecond, kWay), nullptr);
}

TEST(Resends, OldPacketsDoNotGo) {
  Resends resends(0);
  const Sent sent;
  sent.keep(resends, 1, 1, 0);
  resends.lost(1, 50 * kMillisecond, 2);
  Resends late = resends;
  EXPECT_NE(resends.next(100 * kMillisecond, kWay), nullptr) << "it arrives 120 ms after the first";
  EXPECT_EQ(late.next(100 * kMillisecond + 1, kWay), nullptr);
  EXPECT_FALSE(late.due());
}

TEST(Resends, AllPacketsOfADatagramGoTheOldestFirst) {
  Resends resends(0);
  const Sent sent;
  sent.keep(resends, 9, 12, 0);
  sent.keep(resends, 9, 11, 0);
  sent.keep(resends, 8, 10, 0);
  resends.lost(9, kMillisecond, 1);
  for (const std::uint64_t number : {11u, 12u}) {
    const auto* copy = resends.next(kMillisecond, kWay);
    ASSERT_NE(copy, nullptr);
    EXPECT_EQ(copy->number, number);
    resends.sent(*copy, kMillisecond);
  }
  EXPECT_EQ(resends.next(kMillisecond, kWay), nullptr);
}

TEST(Resends, FragmentsGoByThemselves) {
  Resends resends(5 * 1150);
  const Sent sent(2 * 1150 + 7);
  for (std::size_t i = 0; i < 3; ++i)
    resends.keep(20 + i, sent.packet(4), {i, 3, std::span(sent.bytes).subspan(i * 1150, i < 2 ? 1150 : 7)}, 0);
  resends.lost(22, kMillisecond, 1);
  const auto* copy = resends.next(kMillisecond, kWay);
  ASSERT_NE(copy, nullptr);
  EXPECT_EQ(copy->number, 4u);
  EXPECT_EQ(copy->index, 2u);
  EXPECT_EQ(copy->count, 3u);
  EXPECT_EQ(copy->bytes, std::vector<std::uint8_t>(7, 7));
  resends.sent(*copy, kMillisecond);
  EXPECT_EQ(resends.next(kMillisecond, kWay), nullptr);
  const Sent small;
  for (std::uint64_t n = 0; n < 64; ++n) small.keep(resends, 100 + n, 50 + n, kMillisecond);
  resends.lost(22, 2 * kMillisecond, 1);
  EXPECT_NE(resends.next(2 * kMillisecond, kWay), nullptr) << "a packet in fragments costs the others no place";
}

/// Against a list of what should go; nothing is allocated.
TEST(Resends, ForgetsTheOldestAndAllocatesNothing) {
  Resends resends(0);
  std::mt19937_64 random(1);
  const Sent large(1150);
  const std::uint64_t before = testing::allocated_bytes();
  std::uint64_t number = 0, now = 0, copies = 0;
  for (int i = 0; i < 20'000; ++i) {
    now += random() % 5'000;
    ++number;
    large.keep(resends, number, number, now);
    if (random() % 2) resends.lost(number - std::min<std::uint64_t>(number - 1, random() % 100), now, 1 + random() % 2);
    while (const auto* copy = random() % 4 ? resends.next(now, kWay) : nullptr) {
      ASSERT_GT(copy->number + 64, number);
      ASSERT_LE(now + kWay, copy->time + 120'000);
      resends.sent(*copy, now);
      ++copies;
    }
  }
  EXPECT_GT(copies, 1'000u);
  EXPECT_EQ(testing::allocated_bytes(), before);
  now += 1'000'000;
  EXPECT_EQ(resends.next(now, kWay), nullptr);
  EXPECT_FALSE(resends.due()) << "the count of those that wait is right";
}

}  // namespace
}  // namespace tactus
