// SPDX-License-Identifier: Apache-2.0
/// Packets in pieces.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <tactus/base/bytes.h>
#include <tactus/session/fragments.h>
#include "tests/property/allocated.h"

namespace tactus {
namespace {

// ==== session fragments ====

using Bytes = std::vector<std::uint8_t>;

/// A packet, and the fragments of it as a sender makes them: one in each datagram from the packet's number on.
struct Cut {
  Cut(std::uint64_t of, std::size_t size, std::uint64_t in = 1) : number(of), substream(in), bytes(size) {
    std::mt19937_64 random(of + in);
    for (auto& b : bytes) b = static_cast<std::uint8_t>(random());
  }
  std::size_t count() const { return (bytes.size() + kFragmentSize - 1) / kFragmentSize; }
  FragmentPart part(std::size_t index) const {
    const std::size_t begin = index * kFragmentSize;
    return {index, substream, index, count(), std::span(bytes).subspan(begin, std::min(kFragmentSize, bytes.size() - begin))};
  }
  auto give(Fragments& to, std::size_t index) const { return to.take(number + index, part(index)); }

  std::uint64_t number, substream;
  Bytes bytes;
};

void expect_whole(const Result<Fragments::Taken>& taken, const Cut& cut) {
  ASSERT_TRUE(taken) << taken.error().rule;
  ASSERT_TRUE(taken->complete);
  EXPECT_FALSE(taken->kept) << "not before it is decoded";
  const Fragments::Complete& whole = *taken->complete;
  EXPECT_EQ(whole.number, cut.number);
  EXPECT_TRUE(std::ranges::equal(whole.packet, cut.bytes));
  EXPECT_EQ(whole.substream, cut.substream);
}

void expect_only(bool kept, const Result<Fragments::Taken>& taken) {
  ASSERT_TRUE(taken) << taken.error().rule;
  EXPECT_FALSE(taken->complete);
  EXPECT_EQ(taken->kept, kept);
}
void expect_kept(const Result<Fragments::Taken>& taken) { expect_only(true, taken); }
void expect_nothing(const Result<Fragments::Taken>& taken) { expect_only(false, taken); }

TEST(Fragments, InEveryOrderAndDoubledThePacketComesOnce) {
  for (const std::size_t size : {kFragmentSize + 1, 2 * kFragmentSize, 3 * kFragmentSize + 7, 4 * kFragmentSize}) {
    const Cut cut(100, size);
    std::vector<std::size_t> order(cut.count());
    std::iota(order.begin(), order.end(), 0u);
    do {
      Fragments fragments(10'000);
      for (std::size_t i = 0; i + 1 < order.size(); ++i)
        for (int twice = 0; twice < 2; ++twice) expect_kept(cut.give(fragments, order[i]));
      const auto last = cut.give(fragments, order.back());
      expect_whole(last, cut);
      for (const std::size_t i : order) expect_nothing(cut.give(fragments, i));
      fragments.decoded(*last->complete);
      for (const std::size_t i : order) expect_kept(cut.give(fragments, i));
    } while (std::ranges::next_permutation(order).found);
  }
}

/// What is wrong with a fragment of a packet of three, all else being right.
template <class Change>
std::string rule_after(Change change, std::uint64_t datagram = 100) {
  Fragments fragments(3 * kFragmentSize);
  static const Bytes bytes(kFragmentSize + 1, 5);
  FragmentPart part{0, 1, 0, 3, std::span(bytes).first(kFragmentSize)};
  change(part, bytes);
  const auto taken = fragments.take(datagram, part);
  return taken ? "" : taken.error().rule;
}

TEST(Fragments, WrongOnesAreRefused) {
  using Part = FragmentPart;
  const auto rule = [](auto change) { return rule_after(change); };
  EXPECT_EQ(rule([](Part&, const Bytes&) {}), "");
  EXPECT_EQ(rule([](Part& p, const Bytes&) { p.count = 0; }), "R-SES-7");
  EXPECT_EQ(rule([](Part& p, const Bytes&) { p.count = 1; }), "R-SES-7") << "it would fit into a datagram";
  EXPECT_EQ(rule([](Part& p, const Bytes&) { p.count = 1025; }), "R-SES-7");
  EXPECT_EQ(rule([](Part& p, const Bytes&) { p.count = ~std::uint64_t{0}; }), "R-SES-7");
  EXPECT_EQ(rule([](Part& p, const Bytes&) { p.index = 3; }), "R-SES-7");
  EXPECT_EQ(rule([](Part& p, const Bytes&) { p.index = ~std::uint64_t{0}; }), "R-SES-7") << "index + 1 is 0";
  EXPECT_EQ(rule([](Part& p, const Bytes&) { p.index = p.count = ~std::uint64_t{0}; }), "R-SES-7");
  EXPECT_EQ(rule([](Part& p, const Bytes&) { p.bytes = p.bytes.first(kFragmentSize - 1); }), "R-SES-7")
      << "only the last is shorter";
  EXPECT_EQ(rule([](Part& p, const Bytes& b) { p.bytes = b; }), "R-SES-7") << "too long";
  EXPECT_EQ(rule([](Part& p, const Bytes&) { p.index = 2; }), "") << "the last";
  EXPECT_EQ(rule([](Part& p, const Bytes&) { p.index = 2, p.bytes = p.bytes.first(1); }), "") << "the last may be shorter";
  EXPECT_EQ(rule([](Part& p, const Bytes&) { p.index = 2, p.bytes = {}; }), "R-SES-7");
  EXPECT_EQ(rule([](Part& p, const Bytes&) { p.index = 3, p.count = 4, p.bytes = p.bytes.first(1); }), "R-SES-7")
      << "beyond the scene's largest";
  EXPECT_EQ(rule([](Part& p, const Bytes&) { p.back = 99; }), "");
  EXPECT_EQ(rule([](Part& p, const Bytes&) { p.back = 100; }), "R-SES-7") << "numbers count from 1";
  EXPECT_EQ(rule([](Part& p, const Bytes&) { p.back = ~std::uint64_t{0}; }), "R-SES-7");
}

TEST(Fragments, OfOnePacketAgreeInTheirCount) {
  Fragments fragments(5 * kFragmentSize);
  const Cut three(10, 3 * kFragmentSize);
  expect_kept(three.give(fragments, 0));
  FragmentPart other = three.part(1);
  other.count = 4;
  const auto taken = fragments.take(11, other);
  ASSERT_FALSE(taken);
  EXPECT_STREQ(taken.error().rule, "R-SES-7");
  EXPECT_EQ(taken.error().code, Errc::invalid);
  expect_kept(three.give(fragments, 1));
  expect_whole(three.give(fragments, 2), three);
}

TEST(Fragments, FourPacketsAtATimeAndTheOldestGoesFirst) {
  Fragments fragments(3 * kFragmentSize);
  std::vector<Cut> cuts;
  for (std::uint64_t i = 0; i < 4; ++i)
    cuts.emplace_back(10 + i / 2 * 10, 2 * kFragmentSize + 1 + i, i % 2);  // two share a number
  for (std::size_t index = 0; index < 2; ++index)
    for (const Cut& cut : cuts) expect_kept(cut.give(fragments, index));
  const Cut older(5, 2 * kFragmentSize), newer(30, 2 * kFragmentSize);
  expect_nothing(older.give(fragments, 0));
  expect_nothing(older.give(fragments, 1));  // there was no place for it
  expect_kept(newer.give(fragments, 0));     // in the place of number 10, substream 0
  expect_nothing(cuts[0].give(fragments, 0));
  expect_nothing(cuts[0].give(fragments, 2));
  expect_whole(cuts[2].give(fragments, 2), cuts[2]);
  expect_whole(cuts[3].give(fragments, 2), cuts[3]);
  expect_whole(newer.give(fragments, 1), newer);
  expect_whole(cuts[1].give(fragments, 2), cuts[1]);
}

/// What was acknowledged of a packet that gave way is gone: were another fragment of it kept, the sender would think that all are here.
TEST(Fragments, APacketThatGaveWayNeverComesBack) {
  std::mt19937_64 random(5);
  Fragments fragments(3 * kFragmentSize);
  std::set<std::pair<std::uint64_t, std::uint64_t>> gone, held;
  std::uint64_t newest = 1000;
  for (int i = 0; i < 20'000; ++i) {
    newest += random() % 3 == 0 ? 1u : 0u;
    const std::pair name(newest - random() % 8, random() % 3);
    const Cut cut(name.first, 3 * kFragmentSize, name.second);
    const auto taken = cut.give(fragments, random() % 2);
    ASSERT_TRUE(taken);
    ASSERT_FALSE(taken->complete) << "the third is never given";
    if (!taken->kept) continue;
    EXPECT_FALSE(gone.contains(name));
    held.insert(name);
    if (held.size() > Fragments::kMost) gone.insert(held.extract(held.begin()).value());
  }
  EXPECT_GT(gone.size(), 1000u);
}

TEST(Fragments, APlaceThatIsUsedAgainForgetsAll) {
  Fragments fragments(3 * kFragmentSize);
  for (std::uint64_t n = 10; n < 200; n += 10) expect_kept(Cut(n, 3 * kFragmentSize).give(fragments, n / 10 % 3));
  const Cut last(300, 2 * kFragmentSize + 5);
  for (const std::size_t index : {2u, 0u}) expect_kept(last.give(fragments, index));
  expect_whole(last.give(fragments, 1), last);
}

TEST(Fragments, TheLargestPacketOfAll) {
  const Cut cut(1, kFragmentSize * kMostFragments);
  Fragments fragments(~std::size_t{0} / 2);
  for (std::size_t i = 0; i + 1 < cut.count(); ++i) expect_kept(cut.give(fragments, i));
  expect_whole(cut.give(fragments, cut.count() - 1), cut);
}

TEST(Fragments, NothingIsAllocatedWhenEveryPacketFitsNorLater) {
  const Bytes byte(1);
  const std::uint64_t before = testing::allocated_bytes();
  Fragments none(kFragmentSize);
  for (const std::uint64_t index : {0u, 1u})
    EXPECT_FALSE(none.take(10, {0, 1, index, 2, byte})) << "no packet of this scene is so large";
  EXPECT_EQ(testing::allocated_bytes(), before);
  Fragments some(3 * kFragmentSize);
  const Cut cut(9, 3 * kFragmentSize);
  const std::uint64_t made = testing::allocated_bytes();
  for (std::size_t i = 0; i < 3; ++i) ASSERT_TRUE(cut.give(some, i));
  EXPECT_EQ(testing::allocated_bytes(), made);
}

/// A scene whose largest packet fills one fragment exactly needs no place for fragments.
TEST(Fragments, WhereNoPacketNeedsThemTheyAreRefused) {
  const Bytes bytes(kFragmentSize);
  for (const std::size_t largest : {std::size_t{0}, std::size_t{1}, kFragmentSize}) {
    Fragments fragments(largest);
    const auto taken = fragments.take(7, {0, 0, 0, 2, bytes});
    ASSERT_FALSE(taken) << largest;
    EXPECT_STREQ(taken.error().rule, "R-SES-7");
  }
}

// ==== session pieces ====

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
