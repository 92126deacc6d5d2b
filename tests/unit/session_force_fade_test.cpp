// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/timing.h>

#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

namespace tactus {
namespace {

constexpr std::uint64_t kStart = 10'000'000, kMillisecond = 1000;

/// A fade that was looked at each millisecond while news came each millisecond, until all is permitted.
ForceFade risen() {
  ForceFade fade;
  EXPECT_EQ(fade.share(kStart - 600 * kMillisecond, 0), 0);
  for (std::uint64_t t = kStart - 599 * kMillisecond; t <= kStart; t += kMillisecond) fade.share(t, t);
  return fade;
}

TEST(ForceFade, FallsFrom70To100MillisecondsWithoutNews) {
  ForceFade fade = risen();
  for (std::uint64_t age = 0; age <= 70; ++age)
    EXPECT_EQ(fade.share(kStart + age * kMillisecond, kStart), ForceFade::kAll) << age;
  EXPECT_EQ(fade.share(kStart + 85 * kMillisecond, kStart), ForceFade::kAll / 2);
  EXPECT_EQ(fade.share(kStart + 100 * kMillisecond, kStart), 0);
  for (const std::uint64_t age : {101u, 1000u, 1'000'000u}) EXPECT_EQ(fade.share(kStart + age * kMillisecond, kStart), 0);
}

/// A client that works out what its device does waits longer for news.
TEST(ForceFade, FallsFrom300To400MillisecondsInADrivenScene) {
  ForceFade fade = risen();
  fade.set_limits(ForceFade::kDriven);
  EXPECT_EQ(fade.share(kStart + 300 * kMillisecond, kStart), ForceFade::kAll);
  EXPECT_EQ(fade.share(kStart + 350 * kMillisecond, kStart), ForceFade::kAll / 2);
  EXPECT_EQ(fade.share(kStart + 400 * kMillisecond, kStart), 0);
}

TEST(ForceFade, ReturnsOverHalfASecond) {
  for (const std::uint64_t step : {100u, 1000u, 10'000u}) {  // however often one looks
    ForceFade fade = risen();
    const std::uint64_t back = kStart + 3'000'000;
    for (std::uint64_t t = kStart; t <= back; t += step) fade.share(t, kStart);
    for (std::uint64_t t = back + step; t <= back + 500'000; t += step) {
      const double share = static_cast<double>(fade.share(t, t)) / ForceFade::kAll;
      EXPECT_NEAR(share, static_cast<double>(t - back) / 500'000, 0.01) << step;
    }
    EXPECT_NEAR(static_cast<double>(fade.share(back + 500'000, back + 500'000)), ForceFade::kAll, 0.01 * ForceFade::kAll);
  }
}

TEST(ForceFade, NeverJumps) {
  ForceFade fade = risen();
  std::mt19937_64 random(1);
  std::int64_t before = ForceFade::kAll;
  std::uint64_t heard = kStart, next = kStart;
  for (std::uint64_t now = kStart; now < kStart + 60'000'000; now += kMillisecond) {
    if (now >= next) {
      heard = now;
      next = now + random() % 200'000;
    }
    const std::int64_t share = fade.share(now, heard);
    EXPECT_LE(share - before, ForceFade::kAll / 500 + 1);
    EXPECT_LE(before - share, ForceFade::kAll / 30 + 1);
    EXPECT_TRUE(share >= 0 && share <= ForceFade::kAll);
    before = share;
  }
}

TEST(ForceFade, StartsWithNothing) {
  ForceFade fade;
  EXPECT_EQ(fade.share(kStart, 0), 0);
  EXPECT_LT(fade.share(kStart + kMillisecond, kStart + kMillisecond), ForceFade::kAll / 100);
}

/// A session that begins or comes back while something is touched: nobody looked for a while.
TEST(ForceFade, RisesSlowlyAfterAPauseToo) {
  ForceFade first;
  EXPECT_LT(first.share(kStart, kStart), ForceFade::kAll / 100);
  ForceFade fade = risen();
  const std::uint64_t later = kStart + 60'000'000;
  EXPECT_LT(fade.share(later, later), ForceFade::kAll / 100);
  EXPECT_NEAR(static_cast<double>(fade.share(later + 50'000, later + 50'000)), ForceFade::kAll / 10, ForceFade::kAll / 100);
}

TEST(ForceFade, ANewContactNeedNotRise) {
  ForceFade fade;
  fade.release(kStart);
  EXPECT_EQ(fade.share(kStart + kMillisecond, kStart + kMillisecond), ForceFade::kAll);
  fade.release(kStart + 200 * kMillisecond);
  EXPECT_EQ(fade.share(kStart + 200 * kMillisecond, kStart), 0) << "but not on old news";
}

}  // namespace
}  // namespace tactus
