// SPDX-License-Identifier: Apache-2.0
/// A scene declaration in pieces: which go, how fast, and what a client takes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <vector>

#include <tactus/base/bytes.h>
#include <tactus/session/fragments.h>
#include "tests/property/allocated.h"

namespace tactus {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes random_bytes(std::size_t size, std::uint64_t seed = 3) {
  std::mt19937_64 random(seed);
  Bytes out(size);
  for (auto& b : out) b = static_cast<std::uint8_t>(random());
  return out;
}
std::uint64_t hash_of(const Bytes& bytes) {
  Fnv1a hash;
  for (const std::uint8_t b : bytes) hash.add_byte(b);
  return hash.value();
}
PieceSender sender_of(const Bytes& bytes) { return PieceSender(std::make_shared<const Bytes>(bytes)); }
std::string rule_of(const Result<void>& result) { return result ? "" : result.error().rule; }

/// Sends all that may go now, and returns how many those are.
std::uint64_t send_all(PieceSender& sender) {
  std::uint64_t count = 0;
  for (; const auto index = sender.next(); ++count) sender.sent(*index);
  return count;
}

/// As many in flight as LinePacer permits, and none beyond what the client takes.
TEST(PieceSender, SendsAWindowAndThenWaits) {
  PieceSender sender = sender_of(Bytes(400 * 1024));
  EXPECT_EQ(send_all(sender), 16u);
  sender.arrived(3);
  EXPECT_EQ(send_all(sender), 1u);
  sender.arrived(3);
  EXPECT_EQ(send_all(sender), 0u) << "it has arrived before";
  for (std::uint64_t i = 1; i < 200; ++i) {
    sender.arrived(i);
    send_all(sender);
  }
  EXPECT_EQ(sender.next(), std::nullopt);
  EXPECT_EQ(sender.in_flight(), 16u) << "the first and 15 new ones";
}

/// What the client does not take without the first piece does not go: 64 pieces, and 16 more for each that has come.
TEST(PieceSender, TheClientsWindowEndsWhatGoes) {
  PieceSender sender = sender_of(Bytes(std::size_t{3000} * 1024));
  std::uint64_t highest = 0;
  const auto send = [&] {
    while (const auto index = sender.next()) {
      highest = std::max(highest, *index);
      sender.sent(*index);
    }
  };
  send();
  for (std::uint64_t i = 1; i < 2000 && i <= highest; ++i) {
    sender.arrived(i);
    send();
    ASSERT_LT(highest, 64 + 16 * i);
  }
  EXPECT_EQ(highest, 1023u) << "the window is no larger than this";
  sender.arrived(0);
  send();
  EXPECT_EQ(highest, 1024u + 15) << "all others have come";
}

TEST(PieceSender, WhatIsLostGoesAgainAndFirst) {
  PieceSender sender = sender_of(Bytes(std::size_t{100} * 1024));
  EXPECT_EQ(send_all(sender), 16u);
  sender.lost(7);
  sender.lost(3);
  EXPECT_EQ(sender.next(), 3u);
  sender.sent(3);
  EXPECT_EQ(sender.next(), 7u);
  sender.arrived(7);
  EXPECT_EQ(sender.next(), 16u) << "it was late, not lost";
  sender.sent(16);
  sender.lost(7);
  EXPECT_EQ(sender.next(), std::nullopt) << "nor is it lost now";
}

TEST(PieceSender, IsDoneWhenAllHaveArrived) {
  PieceSender sender = sender_of(Bytes(std::size_t{2} * 1024 + 1));
  EXPECT_EQ(send_all(sender), 3u);
  for (const std::uint64_t index : {2u, 0u}) sender.arrived(index);
  EXPECT_FALSE(sender.is_done());
  sender.arrived(1);
  EXPECT_TRUE(sender.is_done());
  EXPECT_EQ(sender.next(), std::nullopt);
  EXPECT_EQ(sender.in_flight(), 0u);
}

TEST(PieceSender, PiecesAreTheDeclaration) {
  for (const std::size_t size : {0u, 1u, 1023u, 1024u, 1025u, 5000u}) {
    const Bytes bytes = random_bytes(size);
    PieceSender sender = sender_of(bytes);
    EXPECT_EQ(sender.is_done(), size == 0);
    Bytes joined;
    while (const auto index = sender.next()) {
      const auto piece = sender.bytes(*index);
      EXPECT_FALSE(piece.empty());
      EXPECT_LE(piece.size(), kPieceSize);
      joined.insert(joined.end(), piece.begin(), piece.end());
      sender.sent(*index);
    }
    EXPECT_EQ(joined, bytes);
  }
}

// ==== line pacer ====

/// Datagrams over a line that brings one each `line` us, without a queue of others, and answers each 10 ms; what comes when the queue is
/// full is lost.
struct PacedLine {
  PacedLine(std::uint64_t line_us, std::uint64_t delay_us, std::uint64_t queue_us, std::uint64_t least_gap = 0)
      : pacer(least_gap), line(line_us), queue(queue_us), delay(delay_us) {}

  void run(std::uint64_t until) {
    for (; now < until; now += 50) {
      while (now >= next && in_flight < pacer.window()) send();
      for (; !arrivals.empty() && arrivals.begin()->first <= now; arrivals.erase(arrivals.begin())) {
        newest = arrivals.begin()->second;
        newest_at = arrivals.begin()->first;
        ++unreported;
        if (answer_at == 0) answer_at = now + 10'000;
      }
      if (answer_at == 0 || now < answer_at + delay) continue;
      report();
    }
  }
  void send() {
    const std::uint64_t waits = std::max(free_at, now) - now;
    worst = std::max(worst, waits);
    pacer.sent(++number, now);
    sent_at[number] = now;
    ++in_flight;
    next = std::max(next + 2000, now) - 2000 + pacer.gap();
    if (waits > queue) {
      --in_flight;
      ++lost;
      return;
    }
    free_at = now + waits + line;
    arrivals.emplace(free_at + delay, number);
  }
  void report() {
    for (; unreported > 0; --unreported, --in_flight, ++came) pacer.arrived();
    const auto arrived = static_cast<std::int64_t>(newest_at + delay);
    const std::int64_t sample = arrived - static_cast<std::int64_t>(sent_at[newest]);
    trip.variation = trip.smoothed == 0 ? sample / 2 : trip.variation + (std::abs(trip.smoothed - sample) - trip.variation) / 4;
    trip.smoothed = trip.smoothed == 0 ? sample : trip.smoothed + (sample - trip.smoothed) / 8;
    trip.least = trip.least == 0 ? sample : std::min(trip.least, sample);
    pacer.feedback({newest, number, arrived - sample, arrived}, trip, now);
    answer_at = 0;
  }

  LinePacer pacer;
  std::uint64_t line, queue, delay;
  RoundTrip trip;
  std::map<std::uint64_t, std::uint64_t> arrivals, sent_at;
  std::uint64_t now = 1'000'000, next = now, free_at = 0, answer_at = 0, newest = 0, newest_at = 0, number = 0;
  std::uint64_t in_flight = 0, unreported = 0, came = 0, lost = 0, worst = 0;
};

TEST(LinePacer, FillsALineAfterARoundTripAndLeavesItsQueueShort) {
  for (const std::uint64_t line : {150u, 900u, 9'000u})
    for (const std::uint64_t delay : {1'000u, 20'000u, 100'000u}) {
      PacedLine test(line, delay, 100'000);
      const auto settled = 4 * delay + 60'000;
      test.run(test.now + settled + (line < 500 ? 6 : 1) * (2 * delay + 20'000));
      const std::uint64_t came = test.came, before = test.now;
      test.worst = 0;
      test.run(test.now + 3'000'000);
      const double fraction = static_cast<double>((test.came - came) * line) / static_cast<double>(test.now - before);
      EXPECT_GT(fraction, std::min(0.85, 0.85 * 800 * static_cast<double>(line) / static_cast<double>(2 * delay + 10'000)))
          << line << " us, delay " << delay;
      EXPECT_LT(test.worst, 40'000 + 6 * line + delay / 4) << line << " us, delay " << delay;
    }
}

TEST(LinePacer, KeepsToTheRateThatIsStated) {
  PacedLine test(100, 10'000, 100'000, 4'000);
  test.run(test.now + 4'000'000);
  EXPECT_LE(test.came, 1001u + 16);
  EXPECT_GT(test.came, 900u);
}

/// A line that becomes three times as slow is followed, and so is one that becomes as fast again.
TEST(LinePacer, FollowsALineThatChanges) {
  PacedLine test(800, 20'000, 200'000);
  test.run(test.now + 1'000'000);
  test.line = 2400;
  test.run(test.now + 3'000'000);
  test.worst = 0;
  test.run(test.now + 1'000'000);
  EXPECT_LT(test.worst, 40'000u);
  test.line = 800;
  test.run(test.now + 1'000'000);
  const std::uint64_t came = test.came;
  test.run(test.now + 1'000'000);
  EXPECT_GT(test.came - came, 1000u);
}

TEST(LinePacer, AfterATimeOutFewGoUntilSomethingIsHeard) {
  LinePacer pacer(0);
  EXPECT_EQ(pacer.window(), 16u);
  EXPECT_EQ(pacer.gap(), 500u);
  pacer.sent(1, 1'000'000);
  pacer.timed_out();
  EXPECT_EQ(pacer.window(), 4u);
  pacer.feedback({1, 1, 1'000'000, 1'900'000}, {900'000, 450'000, 900'000}, 1'910'000);
  EXPECT_EQ(pacer.window(), 16u);
}

/// Of acknowledgements that lie about times or come out of order nothing follows but a spacing between the fastest and none.
TEST(LinePacer, AcknowledgementsThatLieChangeOnlyTheOwnPacing) {
  std::mt19937_64 random(5);
  LinePacer pacer(0);
  pacer.sent(1, 1);
  std::uint64_t number = 1;
  for (std::uint64_t now = 2'000'000; now < 3'000'000; now += 100) {
    number += random() % 40;
    for (auto i = random() % 60; i > 0; --i) pacer.arrived();
    const auto arrived = static_cast<std::int64_t>(now - random() % 1'100'000);
    const auto sample = static_cast<std::int64_t>(random() % 2'000'000);
    pacer.feedback({number, number + random() % 9, arrived - sample, arrived},
                   {sample, sample / 2, std::min<std::int64_t>(sample, 7)}, now);
    ASSERT_GE(pacer.gap(), 80u);
    ASSERT_GE(pacer.window(), 4u);
    ASSERT_LE(pacer.window(), 800u);
  }
}

// ==== pieces at the client ====

TEST(PieceReceiver, TakesTheWindowInAnyOrderAndTwice) {
  const Bytes bytes = random_bytes(64 * 1024 - 5);
  PieceReceiver receiver(bytes.size(), hash_of(bytes));
  PieceSender sender = sender_of(bytes);
  for (std::uint64_t i = 64; i-- > 0;) {
    EXPECT_FALSE(receiver.is_complete());
    EXPECT_EQ(rule_of(receiver.take(i, sender.bytes(i))), "");
    EXPECT_EQ(rule_of(receiver.take(i, sender.bytes(i))), "");
  }
  ASSERT_TRUE(receiver.is_complete());
  const auto declaration = receiver.declaration();
  ASSERT_TRUE(declaration);
  EXPECT_TRUE(std::ranges::equal(*declaration, bytes));
}

TEST(PieceReceiver, AnythingElseIsRefused) {
  const Bytes bytes = random_bytes(100 * 1024 + 5);
  const auto first = [&](std::size_t size) { return std::span(bytes).first(size); };
  PieceReceiver receiver(bytes.size(), hash_of(bytes));
  const auto refused = receiver.take(64, first(1024));
  ASSERT_FALSE(refused) << "beyond the window of a client to which nothing has come";
  EXPECT_EQ(refused.error().code, Errc::invalid);
  EXPECT_STREQ(refused.error().rule, "R-SES-8");
  EXPECT_EQ(rule_of(receiver.take(63, first(1024))), "");
  EXPECT_EQ(rule_of(receiver.take(80, first(1024))), "R-SES-8");
  EXPECT_EQ(rule_of(receiver.take(79, first(1024))), "") << "16 more for the one that has come";
  EXPECT_EQ(rule_of(receiver.take(0, first(1023))), "R-SES-8");
  EXPECT_EQ(rule_of(receiver.take(0, first(1025))), "R-SES-8");
  EXPECT_EQ(rule_of(receiver.take(0, {})), "R-SES-8");
  for (std::uint64_t i = 0; i < 100; ++i) ASSERT_EQ(rule_of(receiver.take(i, first(1024))), "");
  EXPECT_EQ(rule_of(receiver.take(101, first(5))), "R-SES-8") << "there is none";
  EXPECT_EQ(rule_of(receiver.take(100, first(1024))), "R-SES-8") << "the last is shorter";
  EXPECT_EQ(rule_of(receiver.take(~std::uint64_t{0}, first(1024))), "R-SES-8");
  EXPECT_EQ(rule_of(receiver.take(std::uint64_t{1} << 54, first(1024))), "R-SES-8") << "whose first byte would be 0 modulo 2^64";
  EXPECT_FALSE(receiver.is_complete());
  EXPECT_EQ(receiver.received(), 100 * 1024u);
}

TEST(PieceReceiver, AHugeSizeAllocatesOnlyWhatCame) {
  const Bytes piece(1024);
  const std::uint64_t before = testing::allocated_bytes();
  for (const std::uint64_t size : {std::uint64_t{1} << 63, ~std::uint64_t{0}}) {
    PieceReceiver receiver(size, 0);
    EXPECT_FALSE(receiver.is_complete());
    EXPECT_EQ(rule_of(receiver.take(size / 1024 - 1, piece)), "R-SES-8");
    EXPECT_EQ(testing::allocated_bytes(), before);
  }
  PieceReceiver receiver(std::uint64_t{1} << 63, 0);
  std::uint64_t came = 0;
  const auto allocated = [&] { return testing::allocated_bytes() - before; };
  for (std::uint64_t last = 63; last < 1023; last = std::min<std::uint64_t>(last + 16, 1023)) {
    ASSERT_TRUE(receiver.take(last, piece)) << "the last piece that the window permits";
    ASSERT_LE(allocated(), 1200 * ++came) << "holes take no memory";
  }
  EXPECT_EQ(rule_of(receiver.take(1024, piece)), "R-SES-8");
}

/// Memory that is short in the middle of what waited for a piece costs none of it.
TEST(PieceReceiver, GoesOnWhereMemoryWasShort) {
  const Bytes bytes = random_bytes(20 * 1024);
  const auto piece = [&](std::uint64_t i) { return std::span(bytes).subspan(1024 * i, 1024); };
  for (unsigned at = 1; at < 9; ++at) {
    PieceReceiver receiver(bytes.size(), hash_of(bytes));
    for (std::uint64_t i = 1; i < 20; ++i) ASSERT_TRUE(receiver.take(i, piece(i)));
    testing::fail_allocation(at);
    const auto taken = receiver.take(0, piece(0));
    testing::fail_allocation(0);
    if (!taken) {
      EXPECT_STREQ(taken.error().rule, "R-API-11");
      ASSERT_TRUE(receiver.take(0, piece(0)));
    }
    ASSERT_TRUE(receiver.is_complete()) << at;
    EXPECT_TRUE(receiver.declaration()) << at;
  }
}

TEST(PieceReceiver, WithoutMemoryItSaysSo) {
  const Bytes piece(1024);
  PieceReceiver receiver(5000, 0);
  testing::fail_allocation(1);
  const auto taken = receiver.take(0, piece);
  testing::fail_allocation(0);
  ASSERT_FALSE(taken);
  EXPECT_STREQ(taken.error().rule, "R-API-11");
  EXPECT_TRUE(receiver.take(0, piece)) << "when it comes again";
}

TEST(PieceReceiver, AnotherHashIsRefused) {
  Bytes bytes = random_bytes(2048);
  const std::uint64_t hash = hash_of(bytes);
  for (const std::size_t at : {0u, 1024u, 2047u}) {
    bytes[at] ^= 1;
    PieceReceiver receiver(bytes.size(), hash);
    for (std::uint64_t i = 0; i < 2; ++i) ASSERT_TRUE(receiver.take(i, std::span(bytes).subspan(1024 * i, 1024)));
    ASSERT_TRUE(receiver.is_complete());
    const auto declaration = receiver.declaration();
    ASSERT_FALSE(declaration);
    EXPECT_STREQ(declaration.error().rule, "R-SES-10");
    EXPECT_EQ(declaration.error().code, Errc::checksum);
    bytes[at] ^= 1;
  }
  PieceReceiver empty(0, hash_of({}));
  EXPECT_TRUE(empty.is_complete());
  EXPECT_TRUE(empty.declaration());
}

/// A third of the datagrams and of the acknowledgements is lost, and all come in any order. No piece is refused.
TEST(Pieces, ComeThroughALossyNetwork) {
  const Bytes bytes = random_bytes(300 * 1024 + 17);
  PieceSender sender = sender_of(bytes);
  PieceReceiver receiver(bytes.size(), hash_of(bytes));
  std::mt19937_64 random(4);
  std::multimap<std::uint64_t, std::uint64_t> down, up, lost;  // when, index
  std::uint64_t count = 0, now = 0;
  const auto due = [&](auto& events, auto&& handle) {
    for (; !events.empty() && events.begin()->first <= now; events.erase(events.begin())) handle(events.begin()->second);
  };
  for (; !sender.is_done() && now < 60'000'000; now += 500) {
    if (const auto index = sender.next()) {
      sender.sent(*index);
      ++count;
      lost.emplace(now + 100'000, *index);
      if (random() % 3 > 0) down.emplace(now + random() % 50'000, *index);
    }
    due(down, [&](std::uint64_t index) {
      ASSERT_EQ(rule_of(receiver.take(index, sender.bytes(index))), "") << index;
      if (random() % 3 > 0) up.emplace(now + random() % 50'000, index);
    });
    due(up, [&](std::uint64_t index) { sender.arrived(index); });
    due(lost, [&](std::uint64_t index) { sender.lost(index); });
  }
  ASSERT_TRUE(receiver.is_complete());
  EXPECT_TRUE(receiver.declaration());
  EXPECT_LT(now, 10'000'000u);
  EXPECT_LT(count, 900u) << "of 301 pieces, 4 of 9 attempts succeed";
}

}  // namespace
}  // namespace tactus
