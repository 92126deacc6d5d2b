// SPDX-License-Identifier: Apache-2.0
/// Numbers of packets: what an end sent and what it received.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <vector>

#include <tactus/session/fragments.h>
#include <tactus/session/numbers.h>

namespace tactus {
namespace {

// ==== session sent numbers ====

struct Report {
  std::vector<std::uint64_t> arrived, lost;
};

Report report(SentNumbers& sent, const Acknowledgement& ack, std::uint64_t now) {
  Report out;
  EXPECT_TRUE(sent.acknowledge(
      ack, now, [&](std::uint64_t n) { out.arrived.push_back(n); }, [&](std::uint64_t n) { out.lost.push_back(n); }));
  return out;
}

constexpr std::uint64_t kAllMissing = ~std::uint64_t{0};

TEST(SentNumbers, EachIsAcknowledgedOnce) {
  SentNumbers sent;
  for (std::uint64_t i = 0; i < 5; ++i) sent.send(1000 * i);
  EXPECT_EQ(sent.next(), 6u);
  EXPECT_EQ(report(sent, {3, 0, ~std::uint64_t{0b10}}, 50000).arrived, (std::vector<std::uint64_t>{3, 1}));
  EXPECT_EQ(report(sent, {3, 0, ~std::uint64_t{0b10}}, 51000).arrived, (std::vector<std::uint64_t>{}));
  EXPECT_EQ(report(sent, {5, 0, ~std::uint64_t{0b1001}}, 51000).arrived, (std::vector<std::uint64_t>{5, 4}));
  EXPECT_EQ(sent.highest_acknowledged(), 5u);
}

TEST(SentNumbers, WhatWasNeverSentIsRefused) {
  SentNumbers sent;
  const auto nothing = [](std::uint64_t) { FAIL(); };
  EXPECT_FALSE(sent.acknowledge({1, 0, kAllMissing}, 1, nothing, nothing));
  sent.send(0);
  for (const int newest : {0, 2, 3, 30000, 65535}) {
    const auto done = sent.acknowledge({static_cast<std::uint16_t>(newest), 0, kAllMissing}, 1, nothing, nothing);
    ASSERT_FALSE(done) << newest;
    EXPECT_STREQ(done.error().rule, "R-SES-6");
  }
  EXPECT_EQ(report(sent, {1, 0, 0}, 1).arrived.size(), 1u) << "what lies below 1 does not count";
}

TEST(SentNumbers, NoMoreThan4096WaitForAnAnswer) {
  SentNumbers sent;
  std::uint64_t now = 0;
  while (sent.next()) sent.send(++now);
  EXPECT_EQ(now, 4096u);
  report(sent, {3000, 0, kAllMissing}, now);
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
    report(sent, {i, held, 0}, 10000ull * (i - 1) + 40000 + 16ull * held);
    EXPECT_EQ(sent.sample(), 40000);
  }
  EXPECT_EQ(sent.round_trip()->smoothed, 40000);
  EXPECT_EQ(sent.round_trip()->least, 40000);
  EXPECT_LT(sent.round_trip()->variation, 10) << "it began at half the first sample";
  report(sent, {91, Acknowledgement::kNoTiming, 0}, 5000000);
  EXPECT_EQ(sent.sample(), std::nullopt);
  EXPECT_EQ(sent.round_trip()->smoothed, 40000) << "without timing nothing is measured";
  report(sent, {91, 0, 0}, 9000000);
  EXPECT_EQ(sent.sample(), std::nullopt) << "nor by what was acknowledged before";
}

/// Both ends over a link that loses and delays: what is reported lost was, and the fraction is right.
TEST(SentNumbers, LossIsFoundOut) {
  SentNumbers sent;
  ReceivedNumbers received;
  std::mt19937_64 random(5);
  std::multimap<std::uint64_t, std::uint64_t> in_flight;
  std::multimap<std::uint64_t, Acknowledgement> back;
  std::set<std::uint64_t> dropped, reported_lost;
  std::size_t arrived = 0, wrong = 0;
  for (std::uint64_t now = 0; now < 60'000'000; now += 1000) {
    if (now % 5000 == 0) {
      const std::uint64_t number = sent.next().value();
      sent.send(now);
      if (random() % 10 == 0) dropped.insert(number);
      else in_flight.emplace(now + 20000 + random() % 5000, number);
    }
    for (; !in_flight.empty() && in_flight.begin()->first <= now; in_flight.erase(in_flight.begin())) {
      const std::uint64_t number = received.extend(static_cast<std::uint16_t>(in_flight.begin()->second)).value();
      ASSERT_EQ(number, in_flight.begin()->second);
      received.receive(number);
      received.accept(number, in_flight.begin()->first, AckTiming::soon, {10'000, 10'000});
    }
    if (received.due().value_or(now + 1) <= now) back.emplace(now + 20000, received.acknowledge(now));
    for (; !back.empty() && back.begin()->first <= now; back.erase(back.begin())) {
      const Report reported = report(sent, back.begin()->second, now);
      arrived += reported.arrived.size();
      for (const std::uint64_t number : reported.lost) {
        reported_lost.insert(number);
        wrong += dropped.contains(number) ? 0u : 1u;
      }
    }
  }
  EXPECT_NEAR(static_cast<double>(sent.loss()) / 65536, 0.1, 0.06);
  EXPECT_EQ(wrong, 0u);
  EXPECT_GT(reported_lost.size() + 30, dropped.size());
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
  report(sent, {5, 0, 0}, 41'000);
  report(sent, {10, Acknowledgement::kNoTiming, 0b1}, 500'000);
  EXPECT_EQ(sent.loss(), 65536 / 128);
}

// ==== session received numbers ====

constexpr ReceivedNumbers::AckDelay kAckDelay{10'000, 10'000};

TEST(ReceivedNumbers, FourteenBitsStandForOneNumber) {
  ReceivedNumbers received;
  EXPECT_EQ(received.extend(1).value(), 1u);
  EXPECT_EQ(received.extend(4096).value(), 4096u);
  EXPECT_FALSE(received.extend(0)) << "numbers count from 1";
  EXPECT_FALSE(received.extend(4097)) << "below 1";
  std::uint64_t number = 0;
  for (const std::uint64_t step : {1u, 1u, 4096u, 4096u, 4000u, 5u, 3000u}) {
    number += step;
    ASSERT_EQ(received.extend(static_cast<std::uint16_t>(number % kNumbers)).value(), number);
    received.receive(number);
    EXPECT_FALSE(received.extend(static_cast<std::uint16_t>(number % kNumbers))) << "twice";
    if (number > 1024) {
      EXPECT_STREQ(received.extend(static_cast<std::uint16_t>((number - 1024) % kNumbers)).error().rule, "R-SES-4");
    }
  }
}

TEST(ReceivedNumbers, EachIsTakenOnceInAnyOrder) {
  std::mt19937_64 random(3);
  ReceivedNumbers received;
  std::set<std::uint64_t> taken;
  std::uint64_t newest = 0;
  for (int i = 0; i < 50000; ++i) {
    const std::uint64_t at = newest + 1 + random() % 20;
    const std::uint64_t number = random() % 3 == 0 ? at : at > 1100 ? at - random() % 1100 : 1 + random() % at;
    const bool fresh = !taken.contains(number) && number + 1024 > newest;
    const auto read = received.extend(static_cast<std::uint16_t>(number % kNumbers));
    ASSERT_EQ(read.has_value(), fresh) << number << " after " << newest;
    if (!read) continue;
    ASSERT_EQ(*read, number);
    received.receive(number);
    taken.insert(number);
    newest = std::max(newest, number);
  }
  EXPECT_GT(newest, 100000u);
}

TEST(ReceivedNumbers, AcknowledgementsReportWhatWasAccepted) {
  ReceivedNumbers received;
  EXPECT_FALSE(received.can_acknowledge());
  EXPECT_FALSE(received.due());
  received.accept(1, 1000, AckTiming::soon, kAckDelay);
  received.accept(2, 2000, AckTiming::soon, kAckDelay);
  received.accept(5, 5000, AckTiming::never, kAckDelay);
  received.accept(4, 6000, AckTiming::soon, kAckDelay);
  EXPECT_EQ(received.due(), 11000u) << "10 ms after the first";
  const Acknowledgement ack = received.acknowledge(7616);
  EXPECT_EQ(ack.newest, 5);
  EXPECT_EQ(ack.held, 163) << "2616 us since 5 came, in units of 16";
  EXPECT_EQ(ack.missing, 0b0010u) << "4, 2 and 1 were accepted, 3 was not, and there is none below 1";
  EXPECT_FALSE(received.due());
  received.accept(6, 8000, AckTiming::never, kAckDelay);
  EXPECT_FALSE(received.due()) << "an acknowledgement is not ack-eliciting";
  received.accept(7, 8000, AckTiming::now, kAckDelay);
  EXPECT_EQ(received.due(), 8000u);
  EXPECT_EQ(received.acknowledge(8000 + 2'000'000).held, Acknowledgement::kNoTiming);
  EXPECT_EQ(received.acknowledge(8000 + 16 * 65534).held, 65534);
}

TEST(ReceivedNumbers, WhatIsNotAcceptedIsMissing) {
  ReceivedNumbers received;
  for (std::uint64_t number = 1; number <= 200; ++number) {
    received.receive(number);
    if (number % 5 != 0) received.accept(number, 1, AckTiming::soon, kAckDelay);
  }
  const Acknowledgement ack = received.acknowledge(1);
  EXPECT_EQ(ack.newest, 199);
  for (std::uint64_t i = 0; i < 64; ++i) EXPECT_EQ(ack.missing >> i & 1u, (199 - 1 - i) % 5 == 0 ? 1u : 0u);
}

/// So that each number is reported in two acknowledgements at least, though one reports 65.
TEST(ReceivedNumbers, AfterThirtyTwoTheAcknowledgementIsDueAtOnce) {
  ReceivedNumbers numbers;
  for (std::uint64_t n = 1; n <= 31; ++n) {
    numbers.receive(n);
    numbers.accept(n, 100 * n, AckTiming::soon, kAckDelay);
  }
  EXPECT_EQ(numbers.due(), 100 + 10'000);
  numbers.accept(32, 3200, AckTiming::never, kAckDelay);
  EXPECT_EQ(numbers.due(), 3200) << "though it is not ack-eliciting: nobody else reports it";
  numbers.acknowledge(3400);
  numbers.accept(33, 3500, AckTiming::soon, kAckDelay);
  EXPECT_EQ(numbers.due(), 3500 + 10'000);
}

/// What is not as the other end may believe is reported soon.
TEST(ReceivedNumbers, WhileAllIsWellAnAcknowledgementMayWait) {
  constexpr ReceivedNumbers::AckDelay delay{10'000, 100'000};
  ReceivedNumbers numbers;
  const auto accept = [&](std::uint64_t number, std::uint64_t now) { numbers.accept(number, now, AckTiming::soon, delay); };
  accept(1, 1000);
  accept(2, 5000);
  EXPECT_EQ(numbers.due(), 101'000);
  accept(4, 20'000);
  EXPECT_EQ(numbers.due(), 30'000) << "3 is missing";
  accept(5, 25'000);
  EXPECT_EQ(numbers.due(), 30'000);
  accept(3, 27'000);
  EXPECT_EQ(numbers.due(), 101'000) << "it was only reordered";
  accept(7, 28'000);
  numbers.acknowledge(38'000);
  accept(8, 40'000);
  EXPECT_EQ(numbers.due(), 140'000) << "that 6 is missing was reported";
  accept(6, 50'000);
  EXPECT_EQ(numbers.due(), 60'000) << "it was reported missing, and is not";
}

// ==== session sent fragments ====

Packet packet(std::uint64_t number, std::size_t substream = 1) {
  Packet out;
  out.number = number;
  out.substream = substream;
  return out;
}

TEST(SentFragments, APacketHasArrivedOnceWhenAllHave) {
  SentFragments sent;
  sent.send(packet(7), 3);
  sent.send(packet(7, 2), 2);
  EXPECT_FALSE(sent.arrived(7, 1, 2));
  EXPECT_FALSE(sent.arrived(7, 1, 2)) << "twice the same";
  EXPECT_FALSE(sent.arrived(7, 1, 0));
  EXPECT_FALSE(sent.arrived(7, 2, 0));
  EXPECT_TRUE(sent.arrived(7, 1, 1));
  EXPECT_FALSE(sent.arrived(7, 1, 1)) << "once";
  EXPECT_TRUE(sent.arrived(7, 2, 1));
  EXPECT_FALSE(sent.arrived(8, 1, 0)) << "it was never sent";
}

TEST(SentFragments, TheLargestPacketOfAll) {
  SentFragments sent;
  sent.send(packet(1), kMostFragments);
  for (std::size_t i = kMostFragments; i-- > 1;) ASSERT_FALSE(sent.arrived(1, 1, i));
  EXPECT_TRUE(sent.arrived(1, 1, 0));
}

TEST(SentFragments, TheOldestIsForgotten) {
  SentFragments sent;
  for (std::uint64_t n = 1; n <= SentFragments::kMost + 1; ++n) sent.send(packet(n), 2);
  for (std::uint64_t n = 1; n <= SentFragments::kMost + 1; ++n) {
    EXPECT_FALSE(sent.arrived(n, 1, 0));
    EXPECT_EQ(sent.arrived(n, 1, 1), n > 1) << n;
  }
}

}  // namespace
}  // namespace tactus
