// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/fragments.h>

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <tactus/base/bytes.h>
#include "tests/property/allocated.h"

namespace tactus {
namespace {

constexpr std::uint64_t kPatience = 100'000;

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

/// Sends all that may go at `now`, as datagrams of the pieces' indices + 1, and returns how many those are.
std::uint64_t send_all(PieceSender& sender, std::uint64_t now) {
  std::uint64_t count = 0;
  for (; const auto index = sender.next(now, kPatience); ++count) sender.sent(*index, *index + 1, now);
  return count;
}

TEST(PieceSender, SendsAWindowAndThenWaits) {
  PieceSender sender = sender_of(Bytes(400 * 1024));
  EXPECT_EQ(send_all(sender, 0), 8u);
  sender.arrived(3);
  EXPECT_EQ(send_all(sender, 1), 1u) << "there are more at a time, and the window begins at the lowest that is missing";
  sender.arrived(1);
  EXPECT_EQ(send_all(sender, 2), 2u);
  sender.arrived(2);
  EXPECT_EQ(send_all(sender, 3), 3u) << "2 was there before: the window moves on by two";
  for (std::uint64_t i = 4; i <= 90; ++i) {
    sender.arrived(i);
    send_all(sender, i);
  }
  EXPECT_EQ(sender.next(91, kPatience), std::nullopt);
  sender.arrived(91);
  EXPECT_EQ(sender.next(91, kPatience), 91u + 63) << "at most 64 at a time";
}

/// What waits beyond the few that may go is not due: nothing would be sent for it.
TEST(PieceSender, NothingIsDueThatMayNotGo) {
  PieceSender sender = sender_of(Bytes(400 * 1024));
  EXPECT_EQ(send_all(sender, 0), 8u);
  sender.slow_down();
  EXPECT_EQ(send_all(sender, kPatience), 4u);
  EXPECT_EQ(sender.due(kPatience), 2 * kPatience);
}

TEST(PieceSender, ThroughAQueueFewGoAtATime) {
  PieceSender sender = sender_of(Bytes(1000 * 1024));
  std::uint64_t sent = 0, arrived = 0;
  const auto send = [&] {
    const std::uint64_t count = send_all(sender, 1);
    sent += count;
    return count;
  };
  const auto all_arrive = [&] {
    while (arrived < sent) sender.arrived(++arrived);
  };
  for (const std::uint64_t expected : {8u, 16u, 32u, 64u, 64u}) {
    EXPECT_EQ(send(), expected);
    all_arrive();
  }
  sender.slow_down();
  EXPECT_EQ(send(), 32u);
  all_arrive();
  for (int i = 0; i < 10; ++i) sender.slow_down();
  EXPECT_EQ(send(), 4u) << "but so many do";
}

TEST(PieceSender, WhatIsLostOrLateGoesAgain) {
  PieceSender sender = sender_of(Bytes(3 * 1024));
  EXPECT_EQ(sender.due(kPatience), std::nullopt);
  for (std::uint64_t i = 0; i < 3; ++i) sender.sent(i, 10 + i, 1000 * i);
  EXPECT_EQ(sender.due(kPatience), kPatience);
  EXPECT_EQ(sender.next(kPatience - 1, kPatience), std::nullopt);
  EXPECT_EQ(sender.next(kPatience, kPatience), 0u) << "its time is over";
  sender.lost(12);
  EXPECT_EQ(sender.next(2000, kPatience), 2u);
  sender.sent(2, 13, 2000);
  sender.lost(12);
  EXPECT_EQ(sender.next(2000, kPatience), std::nullopt) << "13 is not 12";
  sender.arrived(10);
  EXPECT_EQ(sender.due(kPatience), 1000 + kPatience);
  sender.arrived(11);
  EXPECT_FALSE(sender.is_done());
  sender.arrived(13);
  EXPECT_TRUE(sender.is_done());
  EXPECT_EQ(sender.next(900'000, kPatience), std::nullopt);
  EXPECT_EQ(sender.due(kPatience), std::nullopt);
}

TEST(PieceSender, PiecesAreTheDeclaration) {
  for (const std::size_t size : {0u, 1u, 1023u, 1024u, 1025u, 5000u}) {
    const Bytes bytes = random_bytes(size);
    PieceSender sender = sender_of(bytes);
    EXPECT_EQ(sender.is_done(), size == 0);
    Bytes joined;
    for (std::uint64_t now = 0; const auto index = sender.next(now, kPatience); ++now) {
      const auto piece = sender.bytes(*index);
      EXPECT_FALSE(piece.empty());
      EXPECT_LE(piece.size(), kPieceSize);
      joined.insert(joined.end(), piece.begin(), piece.end());
      sender.sent(*index, now + 1, now);
    }
    EXPECT_EQ(joined, bytes);
  }
}

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
  ASSERT_FALSE(refused) << "beyond the window";
  EXPECT_EQ(refused.error().code, Errc::invalid);
  EXPECT_STREQ(refused.error().rule, "R-SES-8");
  EXPECT_EQ(rule_of(receiver.take(63, first(1024))), "");
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
  ASSERT_TRUE(receiver.take(0, piece));
  ASSERT_TRUE(receiver.take(63, piece));
  EXPECT_LE(testing::allocated_bytes() - before, 2 * 64 * 1024u) << "no more than the window";
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
  std::multimap<std::uint64_t, std::pair<std::uint64_t, std::uint64_t>> down;  // when, number, index
  std::multimap<std::uint64_t, std::uint64_t> up;
  std::uint64_t number = 0, now = 0;
  for (; !sender.is_done() && now < 60'000'000; now += 500) {
    if (const auto index = sender.next(now, kPatience)) {
      sender.sent(*index, ++number, now);
      if (random() % 3 > 0) down.emplace(now + random() % 50'000, std::pair(number, *index));
    }
    for (; !down.empty() && down.begin()->first <= now; down.erase(down.begin())) {
      const auto& [n, index] = down.begin()->second;
      ASSERT_EQ(rule_of(receiver.take(index, sender.bytes(index))), "") << index;
      if (random() % 3 > 0) up.emplace(now + random() % 50'000, n);
    }
    for (; !up.empty() && up.begin()->first <= now; up.erase(up.begin())) sender.arrived(up.begin()->second);
  }
  ASSERT_TRUE(receiver.is_complete());
  EXPECT_TRUE(receiver.declaration());
  EXPECT_LT(now, 5'000'000u);
  EXPECT_LT(number, 900u) << "of 301 pieces, 4 of 9 attempts succeed";
}

}  // namespace
}  // namespace tactus
