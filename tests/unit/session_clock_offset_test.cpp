// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/clock_offset.h>

#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

namespace tactus {
namespace {

TEST(ClockOffset, OfASymmetricWayIsExact) {
  ClockOffset offset;
  EXPECT_EQ(offset.value(), std::nullopt);
  offset.add(5'000'000, 40'000, 1'000'000);
  EXPECT_EQ(offset.value(), 4'020'000) << "the other clock said 5 s, 20 ms ago";
  ClockOffset behind;
  behind.add(1'000'000, 40'000, 5'000'000);
  EXPECT_EQ(behind.value(), -3'980'000);
}

TEST(ClockOffset, TheShortestRoundTripOfTenSecondsCounts) {
  ClockOffset offset;
  offset.add(1'100'000, 10'000, 1'000'000);
  offset.add(3'300'000, 80'000, 3'000'000);
  EXPECT_EQ(offset.value(), 105'000);
  offset.add(10'900'000, 90'000, 10'500'000);
  EXPECT_EQ(offset.value(), 105'000) << "9.5 s ago";
  offset.add(12'400'000, 95'000, 12'000'000);
  EXPECT_EQ(offset.value(), 340'000) << "the short one is over 10 s ago: the shorter of the others counts";
  offset.add(12'500'000, 9'000, 12'400'000);
  EXPECT_EQ(offset.value(), 104'500);
  offset.add(900'000'000, 70'000, 800'000'000);
  EXPECT_EQ(offset.value(), 100'035'000) << "long after all others";
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
    EXPECT_LT(std::abs(*offset.value() - truth), 10'000) << sent;
  }
}

}  // namespace
}  // namespace tactus
