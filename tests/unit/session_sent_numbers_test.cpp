// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/numbers.h>

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>
#include <vector>

namespace tactus {
namespace {

struct Told {
  std::vector<std::uint64_t> arrived, lost;
};

Told tell(SentNumbers& sent, const Acknowledgement& said, std::uint64_t now) {
  Told out;
  EXPECT_TRUE(sent.acknowledge(
      said, now, [&](std::uint64_t n) { out.arrived.push_back(n); }, [&](std::uint64_t n) { out.lost.push_back(n); }));
  return out;
}

constexpr std::uint64_t kAllMissing = ~std::uint64_t{0};

TEST(SentNumbers, EachIsAcknowledgedOnce) {
  SentNumbers sent;
  for (std::uint64_t i = 0; i < 5; ++i) sent.send(1000 * i);
  EXPECT_EQ(sent.next(), 6u);
  EXPECT_EQ(tell(sent, {3, 0, ~std::uint64_t{0b10}}, 50000).arrived, (std::vector<std::uint64_t>{3, 1}));
  EXPECT_EQ(tell(sent, {3, 0, ~std::uint64_t{0b10}}, 51000).arrived, (std::vector<std::uint64_t>{}));
  EXPECT_EQ(tell(sent, {5, 0, ~std::uint64_t{0b1001}}, 51000).arrived, (std::vector<std::uint64_t>{5, 4}));
  EXPECT_EQ(sent.highest_acknowledged(), 5u);
}

TEST(SentNumbers, WhatWasNeverSentIsRefused) {
  SentNumbers sent;
  const auto nothing = [](std::uint64_t) { FAIL(); };
  EXPECT_FALSE(sent.acknowledge({1, 0, kAllMissing}, 1, nothing, nothing));
  sent.send(0);
  for (const int newest : {0, 2, 3, 30000, 65535}) {
    const auto said = sent.acknowledge({static_cast<std::uint16_t>(newest), 0, kAllMissing}, 1, nothing, nothing);
    ASSERT_FALSE(said) << newest;
    EXPECT_STREQ(said.error().rule, "R-SES-6");
  }
  EXPECT_EQ(tell(sent, {1, 0, 0}, 1).arrived.size(), 1u) << "what lies below 1 does not count";
}

TEST(SentNumbers, NoMoreThan4096WaitForAnAnswer) {
  SentNumbers sent;
  std::uint64_t now = 0;
  while (sent.next()) sent.send(++now);
  EXPECT_EQ(now, 4096u);
  tell(sent, {3000, 0, kAllMissing}, now);
  EXPECT_EQ(sent.next(), 4097u);
  while (sent.next()) sent.send(++now);
  EXPECT_EQ(now, 7096u);
}

TEST(SentNumbers, TheRoundTripLeavesOutWhatTheOtherEndHeld) {
  SentNumbers sent;
  EXPECT_FALSE(sent.round_trip());
  for (int i = 0; i < 100; ++i) sent.send(static_cast<std::uint64_t>(10000 * i));
  for (std::uint16_t i = 1; i <= 90; ++i) {
    const std::uint16_t held = static_cast<std::uint16_t>(i % 7 * 50);
    tell(sent, {i, held, 0}, 10000ull * (i - 1) + 40000 + 16ull * held);
    EXPECT_EQ(sent.sample(), 40000);
  }
  EXPECT_EQ(sent.round_trip()->smoothed, 40000);
  EXPECT_EQ(sent.round_trip()->least, 40000);
  EXPECT_LT(sent.round_trip()->variation, 10) << "it began at half the first sample";
  tell(sent, {91, Acknowledgement::kNoTiming, 0}, 5000000);
  EXPECT_EQ(sent.sample(), std::nullopt);
  EXPECT_EQ(sent.round_trip()->smoothed, 40000) << "without timing nothing is measured";
  tell(sent, {91, 0, 0}, 9000000);
  EXPECT_EQ(sent.sample(), std::nullopt) << "nor by what was acknowledged before";
}

/// Both ends over a way that loses and delays: what is said to be lost was, and the share is right.
TEST(SentNumbers, LossIsFoundOut) {
  SentNumbers sent;
  ReceivedNumbers received;
  std::mt19937_64 random(5);
  std::multimap<std::uint64_t, std::uint64_t> on_the_way;
  std::multimap<std::uint64_t, Acknowledgement> back;
  std::set<std::uint64_t> dropped, said_lost;
  std::size_t arrived = 0, wrong = 0;
  for (std::uint64_t now = 0; now < 60'000'000; now += 1000) {
    if (now % 5000 == 0) {
      const std::uint64_t number = sent.next().value();
      sent.send(now);
      if (random() % 10 == 0) dropped.insert(number);
      else on_the_way.emplace(now + 20000 + random() % 5000, number);
    }
    for (; !on_the_way.empty() && on_the_way.begin()->first <= now; on_the_way.erase(on_the_way.begin())) {
      const std::uint64_t number = received.extend(static_cast<std::uint16_t>(on_the_way.begin()->second)).value();
      ASSERT_EQ(number, on_the_way.begin()->second);
      received.receive(number);
      received.accept(number, on_the_way.begin()->first, Asks::soon, {10'000, 10'000});
    }
    if (received.due().value_or(now + 1) <= now) back.emplace(now + 20000, received.acknowledge(now));
    for (; !back.empty() && back.begin()->first <= now; back.erase(back.begin())) {
      const Told told = tell(sent, back.begin()->second, now);
      arrived += told.arrived.size();
      for (const std::uint64_t number : told.lost) {
        said_lost.insert(number);
        wrong += dropped.contains(number) ? 0u : 1u;
      }
    }
  }
  EXPECT_NEAR(static_cast<double>(sent.loss()) / 65536, 0.1, 0.06);
  EXPECT_EQ(wrong, 0u);
  EXPECT_GT(said_lost.size() + 30, dropped.size());
  EXPECT_GT(arrived, 10000u);
  EXPECT_NEAR(static_cast<double>(sent.round_trip()->smoothed), 42500, 2500);
}

TEST(WindowedMinimum, ForgetsWhatIsOld) {
  WindowedMinimum least(1000);
  EXPECT_EQ(least.value(), std::nullopt);
  EXPECT_TRUE(least.add(50, 0));
  EXPECT_FALSE(least.add(70, 500));
  EXPECT_TRUE(least.add(40, 600));
  EXPECT_EQ(least.value(), 40);
  least.add(90, 1500);
  EXPECT_EQ(least.value(), 40);
  least.add(95, 1700);
  EXPECT_EQ(least.value(), 90);
  least.add(20, 900000);
  EXPECT_EQ(least.value(), 20);
}

/// One of the first few that is lost is no loss of ten per cent.
TEST(SentNumbers, FewNumbersSayLittleOfLosses) {
  SentNumbers sent;
  for (int i = 0; i < 10; ++i) sent.send(1000);
  tell(sent, {5, 0, 0}, 41'000);
  tell(sent, {10, Acknowledgement::kNoTiming, 0b1}, 500'000);
  EXPECT_EQ(sent.loss(), 65536 / 128);
}

}  // namespace
}  // namespace tactus
