// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/congestion.h>

#include <gtest/gtest.h>

namespace tactus {
namespace {

/// Bits that pass in ten seconds if a datagram of this size is offered each `every` microseconds.
std::int64_t passed(std::uint64_t rate, std::int64_t bits, std::uint64_t every) {
  TokenBucket bucket(rate);
  std::int64_t out = 0;
  for (std::uint64_t now = 1'000'000; now < 11'000'000; now += every) {
    if (!bucket.is_open(now)) continue;
    bucket.take(bits);
    out += bits;
  }
  return out;
}

TEST(TokenBucket, LetsItsRatePass) {
  for (const std::uint64_t rate : {6'000u, 200'000u, 10'000'000u}) {
    const std::int64_t ten_seconds = 10 * static_cast<std::int64_t>(rate), burst = ten_seconds / 200;
    const std::int64_t bits = 8 * 300;
    EXPECT_LE(passed(rate, bits, 100), ten_seconds + burst + bits) << "what it holds, and one datagram too many";
    EXPECT_GE(passed(rate, bits, 100), ten_seconds - bits);
  }
  EXPECT_EQ(passed(200'000, 800, 10'000), 1000 * 800) << "what is less passes at once";
}

TEST(TokenBucket, HoldsWhat50MillisecondsBring) {
  TokenBucket bucket(1'000'000);
  ASSERT_TRUE(bucket.is_open(3'600'000'000));
  std::int64_t burst = 0;
  for (; bucket.is_open(3'600'000'000); burst += 1000) bucket.take(1000);
  EXPECT_EQ(burst, 50'000);
  EXPECT_FALSE(bucket.is_open(3'600'000'000));
  EXPECT_TRUE(bucket.is_open(3'600'000'001));
}

TEST(TokenBucket, ADebtIsPaid) {
  TokenBucket bucket(1'000'000);
  bucket.take(60'000);
  EXPECT_FALSE(bucket.is_open(10'000));
  EXPECT_TRUE(bucket.is_open(10'001));
}

TEST(TokenBucket, WithoutARateAllPasses) {
  TokenBucket bucket(0);
  for (std::uint64_t now = 0; now < 1000; ++now) {
    ASSERT_TRUE(bucket.is_open(now));
    bucket.take(std::int64_t{1} << 40);
  }
}

TEST(TokenBucket, TheLargestRateDoesNotOverflow) {
  TokenBucket bucket(1'000'000'000'000);
  for (std::uint64_t now = 0; now < 10'000'000; now += 49'999) {
    ASSERT_TRUE(bucket.is_open(now));
    bucket.take(9600);
  }
}

}  // namespace
}  // namespace tactus
