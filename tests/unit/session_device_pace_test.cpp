// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/timing.h>

#include <gtest/gtest.h>

#include <vector>

namespace tactus {
namespace {

std::vector<PacePart> told(DevicePace& pace, std::uint64_t number) {
  DatagramWriter writer(Direction::down);
  writer.begin(number);
  pace.tell(writer, number);
  if (writer.empty()) return {};
  const auto bytes = writer.finish(7);
  const auto read = read_datagram(bytes, Direction::down).value();
  PartReader parts = std::get<Numbered>(read).parts(Direction::down);
  std::vector<PacePart> out;
  while (const auto part = parts.next().value()) out.push_back(std::get<PacePart>(*part));
  return out;
}

TEST(DevicePace, TheFastestPacketActsTwoMillisecondsAfterItCame) {
  DevicePace pace(1000);
  const auto first = pace.step(500, 430);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->from, 500);
  EXPECT_EQ(first->offset, 72);
  EXPECT_FALSE(pace.step(501, 431));
}

TEST(DevicePace, WhatIsLateSlowsItDownAtOnce) {
  DevicePace pace(1000);
  pace.step(500, 430);
  pace.heard(500 - 72 + 3);
  EXPECT_FALSE(pace.step(501, 431));
  pace.heard(501 - 72 - 4);
  pace.heard(501 - 72);
  const auto slower = pace.step(502, 432);
  ASSERT_TRUE(slower);
  EXPECT_EQ(slower->offset, 72 + 5);
  EXPECT_FALSE(pace.step(503, 433)) << "once";
}

/// The way gets longer by 100 ms, with a packet every 10 ms: until the device's tick goes on, all are too late to act, and the pace does not
/// get slower for it.
TEST(DevicePace, AJumpOfTheDelaySlowsItDownByAsMuch) {
  DevicePace pace(1000);
  std::int64_t offset = pace.step(0, -5)->offset;
  for (std::int64_t tick = 1; tick < 2000; ++tick) {
    if (tick % 10 == 0) pace.heard(tick - (tick < 500 ? 5 : 105));
    if (const auto change = pace.step(tick, tick - 5)) offset = change->offset;
  }
  EXPECT_GE(offset, 105);
  EXPECT_LE(offset, 108);
}

TEST(DevicePace, ItGetsFasterWhereAllComeEarly) {
  DevicePace pace(1000);
  pace.step(0, -50);
  std::int64_t offset = 52, faster = 0;
  for (std::int64_t tick = 1; tick <= 10'000; ++tick) {
    pace.heard(tick - 1 - 47);  // of a way that always takes as long
    if (const auto change = pace.step(tick, tick - 50)) {
      EXPECT_EQ(change->offset, offset - 1) << "a tick at a time";
      offset = change->offset;
      ++faster;
    }
  }
  EXPECT_EQ(faster, 3) << "until they come 2 ms before they act";
}

TEST(DevicePace, WithoutPacketsItStays) {
  DevicePace pace(1000);
  pace.step(0, -50);
  for (std::int64_t tick = 1; tick <= 10'000; ++tick) EXPECT_FALSE(pace.step(tick, tick - 50));
}

TEST(DevicePace, ChangesAreToldUntilTheyAreAcknowledged) {
  DevicePace pace(1000);
  EXPECT_FALSE(pace.waits());
  pace.step(500, 430);
  EXPECT_TRUE(pace.waits());
  EXPECT_EQ(told(pace, 10).size(), 1u);
  pace.heard(427);
  pace.step(600, 530);
  const auto both = told(pace, 11);
  ASSERT_EQ(both.size(), 2u);
  EXPECT_EQ(both[0].from, 500);
  EXPECT_EQ(both[1].from, 600);
  pace.acknowledged(9);
  EXPECT_EQ(told(pace, 12).size(), 2u);
  pace.acknowledged(10);
  EXPECT_EQ(told(pace, 13).size(), 1u);
  pace.acknowledged(11);
  EXPECT_FALSE(pace.waits());
  EXPECT_TRUE(told(pace, 14).empty());
}

/// More changes than are kept: the newest are told.
TEST(DevicePace, TheNewestChangesAreTold) {
  DevicePace pace(1000);
  pace.step(0, 0);
  for (std::int64_t tick = 1; tick < 20; ++tick) {
    pace.heard(-100 * tick);
    pace.step(tick, tick);
  }
  const auto all = told(pace, 3);
  ASSERT_EQ(all.size(), 8u);
  EXPECT_EQ(all.back().from, 19);
  EXPECT_EQ(all.front().from, 12);
}

}  // namespace
}  // namespace tactus
