// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/numbers.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <vector>

namespace tactus {
namespace {

constexpr ReceivedNumbers::Patience kPatience{10'000, 10'000};

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

TEST(ReceivedNumbers, AcknowledgementsTellOfWhatWasAccepted) {
  ReceivedNumbers received;
  EXPECT_FALSE(received.can_acknowledge());
  EXPECT_FALSE(received.due());
  received.accept(1, 1000, Asks::soon, kPatience);
  received.accept(2, 2000, Asks::soon, kPatience);
  received.accept(5, 5000, Asks::never, kPatience);
  received.accept(4, 6000, Asks::soon, kPatience);
  EXPECT_EQ(received.due(), 11000u) << "10 ms after the first";
  const Acknowledgement said = received.acknowledge(7616);
  EXPECT_EQ(said.newest, 5);
  EXPECT_EQ(said.held, 163) << "2616 us since 5 came, in units of 16";
  EXPECT_EQ(said.missing, 0b0010u) << "4, 2 and 1 were accepted, 3 was not, and there is none below 1";
  EXPECT_FALSE(received.due());
  received.accept(6, 8000, Asks::never, kPatience);
  EXPECT_FALSE(received.due()) << "an acknowledgement asks for none";
  received.accept(7, 8000, Asks::now, kPatience);
  EXPECT_EQ(received.due(), 8000u);
  EXPECT_EQ(received.acknowledge(8000 + 2'000'000).held, Acknowledgement::kNoTiming);
  EXPECT_EQ(received.acknowledge(8000 + 16 * 65534).held, 65534);
}

TEST(ReceivedNumbers, WhatIsNotAcceptedIsMissing) {
  ReceivedNumbers received;
  for (std::uint64_t number = 1; number <= 200; ++number) {
    received.receive(number);
    if (number % 5 != 0) received.accept(number, 1, Asks::soon, kPatience);
  }
  const Acknowledgement said = received.acknowledge(1);
  EXPECT_EQ(said.newest, 199);
  for (std::uint64_t i = 0; i < 64; ++i) EXPECT_EQ(said.missing >> i & 1u, (199 - 1 - i) % 5 == 0 ? 1u : 0u);
}

/// So that each number is told in two acknowledgements at least, though one tells of 65.
TEST(ReceivedNumbers, AfterThirtyTwoTheAcknowledgementIsDueAtOnce) {
  ReceivedNumbers numbers;
  for (std::uint64_t n = 1; n <= 31; ++n) {
    numbers.receive(n);
    numbers.accept(n, 100 * n, Asks::soon, kPatience);
  }
  EXPECT_EQ(numbers.due(), 100 + 10'000);
  numbers.accept(32, 3200, Asks::never, kPatience);
  EXPECT_EQ(numbers.due(), 3200) << "though it does not ask: nobody else tells of it";
  numbers.acknowledge(3400);
  numbers.accept(33, 3500, Asks::soon, kPatience);
  EXPECT_EQ(numbers.due(), 3500 + 10'000);
}

/// What is not as the other end may believe is told soon.
TEST(ReceivedNumbers, WhileAllIsWellAnAcknowledgementMayWait) {
  constexpr ReceivedNumbers::Patience patience{10'000, 100'000};
  ReceivedNumbers numbers;
  const auto accept = [&](std::uint64_t number, std::uint64_t now) { numbers.accept(number, now, Asks::soon, patience); };
  accept(1, 1000);
  accept(2, 5000);
  EXPECT_EQ(numbers.due(), 101'000);
  accept(4, 20'000);
  EXPECT_EQ(numbers.due(), 30'000) << "3 is missing";
  accept(5, 25'000);
  EXPECT_EQ(numbers.due(), 30'000);
  accept(3, 27'000);
  EXPECT_EQ(numbers.due(), 101'000) << "it was only overtaken";
  accept(7, 28'000);
  numbers.acknowledge(38'000);
  accept(8, 40'000);
  EXPECT_EQ(numbers.due(), 140'000) << "that 6 is missing was told";
  accept(6, 50'000);
  EXPECT_EQ(numbers.due(), 60'000) << "it was told to be missing, and is not";
}

}  // namespace
}  // namespace tactus
