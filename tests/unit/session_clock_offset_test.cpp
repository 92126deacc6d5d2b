// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/timing.h>

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

/// in   there, back  [us] on the way;  offset  [us] of the other clock
void exchange(ClockOffset& of, std::uint64_t now, std::int64_t there, std::int64_t back, std::int64_t offset) {
  of.add(static_cast<std::uint64_t>(static_cast<std::int64_t>(now) - back + offset), there + back, now);
}

TEST(ClockOffset, TheFastestOfEachWayInTenSecondsCounts) {
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

}  // namespace
}  // namespace tactus
