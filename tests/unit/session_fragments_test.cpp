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

TEST(Fragments, ManyPacketsAtATimeAndTheOldestGoesFirst) {
  Fragments fragments(3 * kFragmentSize);
  std::vector<Cut> cuts;
  for (std::uint64_t i = 0; i < Fragments::kMost; ++i)
    cuts.emplace_back(10 + i / 2 * 10, 2 * kFragmentSize + 1 + i, i % 2);  // two share a number
  for (std::size_t index = 0; index < 2; ++index)
    for (const Cut& cut : cuts) expect_kept(cut.give(fragments, index));
  const Cut older(5, 2 * kFragmentSize), newer(1000, 2 * kFragmentSize);
  expect_nothing(older.give(fragments, 0));
  expect_nothing(older.give(fragments, 1));  // there was no slot for it
  expect_kept(newer.give(fragments, 0));     // in the slot of number 10, substream 0
  expect_nothing(cuts[0].give(fragments, 0));
  expect_nothing(cuts[0].give(fragments, 2));
  expect_whole(cuts[2].give(fragments, 2), cuts[2]);
  expect_whole(cuts[3].give(fragments, 2), cuts[3]);
  expect_whole(newer.give(fragments, 1), newer);
  expect_whole(cuts[1].give(fragments, 2), cuts[1]);
}

/// What was acknowledged of a packet that was dropped is forgotten: were another fragment of it kept, the sender would think that all are here.
TEST(Fragments, APacketThatWasDroppedNeverComesBack) {
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

TEST(Fragments, ASlotThatIsUsedAgainForgetsAll) {
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

/// A scene whose largest packet fills one fragment exactly needs no slot for fragments.
TEST(Fragments, WhereNoPacketNeedsThemTheyAreRefused) {
  const Bytes bytes(kFragmentSize);
  for (const std::size_t largest : {std::size_t{0}, std::size_t{1}, kFragmentSize}) {
    Fragments fragments(largest);
    const auto taken = fragments.take(7, {0, 0, 0, 2, bytes});
    ASSERT_FALSE(taken) << largest;
    EXPECT_STREQ(taken.error().rule, "R-SES-7");
  }
}

}  // namespace
}  // namespace tactus
