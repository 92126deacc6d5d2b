// SPDX-License-Identifier: Apache-2.0
/// What senders may make a server do: floods are cut off, honest clients never.
#include <tactus/net/rate_limit.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace tactus::net {
namespace {

constexpr std::uint64_t kSecond = 1'000'000;

Address at(const std::string& text) { return Address::parse(text).value(); }
Address host(unsigned number) {
  return at("198." + std::to_string(number / 65536 % 256) + '.' + std::to_string(number / 256 % 256) + '.' +
            std::to_string(number % 256) + ":4000");
}

/// How many of `count` datagrams are taken that come evenly in `time`.
std::uint64_t taken(RateLimit& limit, std::uint64_t begin, std::uint64_t time, std::uint64_t count, std::size_t bytes,
                    const Rate& rate) {
  std::uint64_t out = 0;
  for (std::uint64_t i = 0; i < count; ++i) out += limit.take(begin + i * time / count, bytes, rate) ? 1u : 0u;
  return out;
}

TEST(RateLimit, PermitsTheRateAndWhatWasSavedUpInASecond) {
  constexpr Rate kRate{1000, 1'000'000};
  RateLimit limit;
  EXPECT_EQ(taken(limit, 5 * kSecond, 10 * kSecond, 10'000, 100, kRate), 10'000u) << "the rate, for ever";
  EXPECT_EQ(taken(limit, 20 * kSecond, 1, 5000, 100, kRate), 1000u) << "at once";
  EXPECT_EQ(taken(limit, 20 * kSecond, 10 * kSecond, 100'000, 100, kRate), 9999u) << "then the rate";
  EXPECT_EQ(taken(limit, 30 * kSecond + kSecond / 2, 1, 5000, 100, kRate), 501u) << "half a second saves up half of it";
}

TEST(RateLimit, CountsBytesToo) {
  constexpr Rate kRate{1000, 100'000};
  RateLimit limit;
  EXPECT_EQ(taken(limit, kSecond, 1, 1000, 1000, kRate), 100u);
  EXPECT_EQ(taken(limit, kSecond, 10 * kSecond, 10'000, 1000, kRate), 999u);
  EXPECT_EQ(taken(limit, 20 * kSecond, 1, 1, 100'001, kRate), 0u);
  EXPECT_EQ(taken(limit, 20 * kSecond, 1, 1, 100'000, kRate), 1u) << "what was left out cost nothing";
}

/// A device at 1 kHz whose every packet goes twice, beside 1000 acknowledgements, of 200 bytes each; and a network that held back a second.
TEST(RateLimit, NeverTouchesAClient) {
  RateLimit limit;
  EXPECT_EQ(taken(limit, kSecond, 60 * kSecond, 60 * 3000, 200, kClientRate), 60u * 3000);
  EXPECT_EQ(taken(limit, 62 * kSecond, 1, 3000, 200, kClientRate), 3000u);
  EXPECT_EQ(taken(limit, 62 * kSecond + 1, 10 * kSecond, 10 * 3000, 200, kClientRate), 10u * 3000);
  RateLimit large;
  EXPECT_EQ(taken(large, kSecond, 10 * kSecond, 10 * 3000, 1229, kClientRate), 10u * 3000) << "the largest datagrams there are";
}

TEST(StrangersLimit, AHostThatFloodsKeepsOutOneIn256Others) {
  StrangersLimit limit(0x0123456789ABCDEF);
  const Address flooding = at("192.0.2.1:1");
  std::uint64_t flooded = 0, others = 0;
  for (std::uint64_t i = 0; i < 100'000; ++i) {
    flooded += limit.take(10 * kSecond + 10 * i, flooding, 100) ? 1u : 0u;  // 100 000 per second
    if (i % 100 == 0) others += limit.take(10 * kSecond + 10 * i, host(static_cast<unsigned>(i)), 100) ? 1u : 0u;
  }
  EXPECT_NEAR(static_cast<double>(flooded), 2000, 20) << "what it saved up, and its rate for a second";
  EXPECT_GE(others, 985u);
}

TEST(StrangersLimit, PortsOfAHostShareItsRate) {
  StrangersLimit limit(7);
  std::uint64_t passed = 0;
  for (unsigned port = 1; port <= 50'000; ++port)
    passed += limit.take(kSecond, at("192.0.2.1:" + std::to_string(port)), 10) ? 1u : 0u;
  EXPECT_EQ(passed, kHostRate.datagrams);
  StrangersLimit six(7);
  passed = 0;
  for (unsigned i = 1; i < 3000; ++i) {
    char text[64];
    std::snprintf(text, sizeof text, "[2001:db8:1:2::%x]:%u", i, i);
    passed += six.take(kSecond, at(text), 10) ? 1u : 0u;
  }
  EXPECT_EQ(passed, kHostRate.datagrams) << "a host has 2^64 addresses";
}

TEST(StrangersLimit, AllTogetherHaveALimit) {
  StrangersLimit limit(42);
  std::uint64_t passed = 0;
  for (unsigned i = 0; i < 200'000; ++i) passed += limit.take(kSecond, host(i), 10) ? 1u : 0u;
  EXPECT_EQ(passed, kStrangersRate.datagrams);
  for (unsigned i = 0; i < 200'000; ++i) passed += limit.take(kSecond + 5ull * i, host(i), 10) ? 1u : 0u;  // 200 000 per second
  EXPECT_NEAR(static_cast<double>(passed), 2.0 * kStrangersRate.datagrams, 10);
}

/// Which hosts share a limit follows from the secret.
TEST(StrangersLimit, WhoSharesCannotBeForeseen) {
  const auto meets = [](std::uint64_t secret) {
    StrangersLimit limit(secret);
    while (limit.take(kSecond, host(0), 10)) continue;
    unsigned met = 0;
    for (unsigned i = 1; i <= 512; ++i) met += limit.take(kSecond, host(i), 10) ? 0u : 1u << i % 31;
    return met;
  };
  EXPECT_NE(meets(1), meets(2));
  EXPECT_EQ(meets(1), meets(1));
}

TEST(AddressHost, IsWithoutThePort) {
  const auto same = [](const char* a, const char* b) {
    const Address one = at(a), other = at(b);
    return std::equal(one.host().begin(), one.host().end(), other.host().begin(), other.host().end());
  };
  EXPECT_TRUE(same("192.0.2.1:1", "192.0.2.1:2"));
  EXPECT_FALSE(same("192.0.2.1:1", "192.0.2.2:1"));
  EXPECT_TRUE(same("192.0.2.1:1", "[::ffff:192.0.2.1]:1"));
  EXPECT_TRUE(same("[2001:db8:1:2::1]:1", "[2001:db8:1:2:3:4:5:6]:9"));
  EXPECT_FALSE(same("[2001:db8:1:2::1]:1", "[2001:db8:1:3::1]:1"));
  EXPECT_TRUE(Address().host().empty());
}

}  // namespace
}  // namespace tactus::net
