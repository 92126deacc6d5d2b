// SPDX-License-Identifier: Apache-2.0
/// Packets that build on the one before: what is lost goes again, and what waits for it is held.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include <tactus/session/exchange.h>
#include "tests/unit/session_exchange_fixture.h"

namespace tactus {
namespace {

using testing::Bytes;
using testing::Ends;
using testing::kIsPacket;
using testing::kMillisecond;
using testing::types_of;

/// A round trip of 20 ms is known.
struct RepairedEnds : Ends {
  explicit RepairedEnds(const testing::Meshes& meshes = {.baseline = Baseline::repaired}, std::size_t objects = 3)
      : Ends(meshes, objects) {
    for (int i = 0; i < 20; ++i) step();
  }
  void step() {
    submit();
    give(drain(*server));
    answer();
  }
  /// The datagrams of a tick, which the network loses.
  std::vector<Bytes> lose() {
    submit();
    now += 10 * kMillisecond;
    return drain(*server);
  }
};

struct Chains {
  std::size_t objects = 3, shapes = 0;
  std::uint32_t squares = 4;  // of each side of a shape: 30 make packets of several fragments
  testing::Meshes meshes() const { return {.baseline = Baseline::repaired, .squares = squares, .count = shapes}; }
};
constexpr std::array kChains{Chains{3, 0}, Chains{3, 2}, Chains{0, 1}, Chains{1, 2, 30}};

TEST(RepairedExchange, PacketsBuildOnTheOneBeforeAndWaitForIt) {
  for (const Chains& of : std::span(kChains).first(3)) {  // a tick is a datagram
    RepairedEnds ends(of.meshes(), of.objects);
    const std::size_t each = (of.objects > 0 ? 1 : 0) + of.shapes, first = of.objects > 0 ? 0 : 1;
    const std::uint64_t state = ends.client->receiver->state_hash(first), heard = ends.client->traffic().packets_heard;
    ASSERT_EQ(ends.lose().size(), 1u);
    ends.submit();
    ends.give(ends.drain(*ends.server));
    EXPECT_EQ(ends.client->receiver->state_hash(first), state) << "it waits";
    EXPECT_EQ(ends.client->waits_since(ends.now), ends.now);
    EXPECT_EQ(ends.client->traffic().packets_refused, 0u);
    ends.answer();
    EXPECT_EQ(ends.server->sent().highest_acknowledged(), ends.server->sent().newest()) << "what waits has arrived";
    for (int i = 0; i < 6 && ends.client->waits_since(ends.now); ++i) ends.step();
    EXPECT_FALSE(ends.client->waits_since(ends.now));
    EXPECT_GE(ends.client->traffic().packets_heard, heard + 3 * each);
    EXPECT_EQ(ends.server->traffic().lost, 1u);
    ends.expect_same();
  }
}

/// The copies are the packet itself: what they bring is heard again, and counts as decoded.
TEST(RepairedExchange, SecondCopiesChangeNothing) {
  RepairedEnds ends;
  ends.lose();
  for (int i = 0; i < 20; ++i) {
    ends.step();
    if (!ends.client->waits_since(ends.now)) ends.expect_same();
  }
  EXPECT_EQ(ends.client->traffic().packets_refused, 0u);
  EXPECT_EQ(ends.server->traffic().lost, 1u) << "datagrams with copies are acknowledged";
  ends.expect_same();
}

/// There is no time for a second round of them.
TEST(RepairedExchange, OverALongRoundTripThereAreMoreCopies) {
  for (const std::uint64_t delay : {10u, 50u}) {
    Ends ends({.baseline = Baseline::repaired});
    const auto step = [&] {
      ends.submit();
      const auto down = ends.drain(*ends.server);
      ends.now += delay * kMillisecond;
      ends.give(down);
      ends.now += 10 * kMillisecond;  // until it answers
      const auto up = ends.drain(*ends.client);
      ends.now += delay * kMillisecond;
      for (const Bytes& bytes : up) EXPECT_TRUE(ends.hear(*ends.server, bytes));
    };
    for (int i = 0; i < 20; ++i) step();
    ends.submit();
    ASSERT_EQ(ends.drain(*ends.server).size(), 1u);  // it is lost
    ends.now += 10 * kMillisecond;
    step();
    std::size_t copies = 0;
    for (int i = 0; i < 5; ++i, ends.now += 10 * kMillisecond) copies += ends.drain(*ends.server).size();
    EXPECT_EQ(copies, delay == 10 ? 2u : 3u) << 2 * delay << " ms there and back";
  }
}

/// Nothing after the last packet shows that it is lost.
TEST(RepairedExchange, TheLastPacketBeforeAPauseGoesAgain) {
  RepairedEnds ends;
  ends.lose();
  const auto due = ends.server->due();
  ASSERT_TRUE(due);
  EXPECT_EQ(*due, ends.server->eliciting_at() + ends.server->ack_timeout());
  ends.now = *due - 1;
  EXPECT_TRUE(ends.drain(*ends.server).empty());
  ends.now = *due;
  const auto copies = ends.drain(*ends.server);
  ASSERT_EQ(copies.size(), 1u);
  EXPECT_EQ(types_of(copies[0]), std::vector<std::size_t>{kIsPacket});
  ends.give(copies);
  ends.expect_same();
}

/// Without a link for a second all begin anew: one key packet of each, not all that was lost.
TEST(RepairedExchange, AfterAnOutageAKeyPacketOfEachIsEnough) {
  for (const Chains& of : kChains) {
    RepairedEnds ends(of.meshes(), of.objects);
    for (int i = 0; i < 100; ++i) ends.lose();
    const std::uint64_t heard = ends.client->traffic().packets_heard;
    for (int i = 0; i < 20; ++i) ends.step();
    ends.expect_same();
    EXPECT_FALSE(ends.client->waits_since(ends.now));
    EXPECT_LT(ends.client->traffic().packets_heard, heard + 60 * ((of.objects > 0 ? 1 : 0) + of.shapes));
    EXPECT_EQ(ends.client->traffic().packets_refused, 0u);
  }
}

/// Key packets of shapes are large: they wait until somebody answers.
TEST(RepairedExchange, ToASilentClientOnlyTheBodiesBeginAnew) {
  RepairedEnds ends({.baseline = Baseline::repaired, .count = 2});
  for (int i = 0; i < 120; ++i) ends.lose();
  std::size_t bodies = 0, shapes = 0;
  for (int i = 0; i < 100; ++i, ends.now += 10 * kMillisecond) {
    for (const Packet& packet : ends.submit()) (packet.substream == 0 ? bodies : shapes) += packet.key ? 1 : 0;
    ends.drain(*ends.server);
  }
  EXPECT_GE(bodies, 5u);
  EXPECT_EQ(shapes, 0u);
  for (int i = 0; i < 30; ++i) ends.step();
  ends.expect_same();
}

/// The last packet of a shape and its copies are lost with the link; then it rests, and no frame shows what is missing.
TEST(RepairedExchange, AShapeThatRestsIsRepairedToo) {
  RepairedEnds ends({.baseline = Baseline::repaired, .count = 1}, 1);
  for (int i = 0; i < 100; ++i) ends.lose();
  ends.sheets.clear();
  for (int i = 0; i < 100; ++i) ends.step();
  EXPECT_EQ(ends.client->receiver->state_hash(1), ends.server->sender->state_hash(1));
  const std::uint64_t sent = ends.server->traffic().packets_sent;
  for (int i = 0; i < 100; ++i) ends.step();
  EXPECT_EQ(ends.server->traffic().packets_sent, sent + 100) << "of the body alone";
}

/// More than is kept for copies is under way, and nothing is lost: no key packet goes.
TEST(RepairedExchange, AChainHoldsThoughItsPacketsAreForgotten) {
  Ends ends({.baseline = Baseline::repaired, .squares = 8, .count = 40}, 0);
  std::vector<std::vector<Bytes>> down;
  std::size_t keys = 0;
  for (int i = 0; i < 300; ++i, ends.now += 10 * kMillisecond) {
    for (const Packet& packet : ends.submit()) keys += packet.key ? 1 : 0;
    down.push_back(ends.drain(*ends.server));
    if (i < 40) continue;  // 400 ms
    ends.give(down[static_cast<std::size_t>(i) - 40]);
    for (const Bytes& bytes : ends.drain(*ends.client)) EXPECT_TRUE(ends.hear(*ends.server, bytes));
  }
  EXPECT_EQ(keys, 40u) << "the first of each";
  EXPECT_EQ(ends.client->traffic().packets_refused, 0u);
}

TEST(RepairedExchange, AClientThatAsksGetsAKeyPacketOnceInTheTimeOfAnAnswer) {
  RepairedEnds ends;
  const auto is_key = [&] {
    const auto packets = ends.submit();
    const bool out = packets[0].key;
    ends.give(ends.drain(*ends.server));
    return out;
  };
  EXPECT_FALSE(is_key());
  ends.server->want_key(ends.now);
  EXPECT_TRUE(is_key());
  ends.server->want_key(ends.now);
  EXPECT_FALSE(is_key()) << "the answer to the first is on its way";
  ends.now += ends.server->ack_timeout();
  ends.server->want_key(ends.now);
  EXPECT_TRUE(is_key());
  ends.expect_same();
}

// ==== packets that nothing waits for ====

/// Where a client has fixed a delay that is long enough, a copy comes before the tick is shown, or a little later.
TEST(PromptExchange, WhatIsLostGoesAgainToAClientThatWaitsForIt) {
  for (const std::uint64_t playout : {0u, 5u, 60u}) {
    RepairedEnds ends({.baseline = Baseline::acknowledged, .playout = playout * kMillisecond});
    const std::uint64_t sent = ends.server->traffic().packets_sent, heard = ends.client->traffic().packets_heard;
    ASSERT_EQ(ends.lose().size(), 1u);
    for (int i = 0; i < 8; ++i) ends.step();
    const std::uint64_t copies = ends.server->traffic().packets_sent - sent - 9;  // beside one in each tick
    EXPECT_EQ(copies, playout == 60 ? 1u : 0u) << playout;
    EXPECT_EQ(ends.client->traffic().packets_heard, heard + 8 + copies) << playout;
    EXPECT_FALSE(ends.client->waits_since(ends.now)) << "nothing waits for it";
    EXPECT_EQ(ends.client->traffic().packets_refused, 0u);
    ends.expect_same();
  }
}

/// What is too old to be shown does not go, and no key packet makes up for it.
TEST(PromptExchange, NoCopyIsTooLate) {
  RepairedEnds ends({.baseline = Baseline::acknowledged, .playout = 60 * kMillisecond});
  for (int i = 0; i < 30; ++i) ends.lose();
  const std::uint64_t before = ends.server->traffic().packets_sent;
  bool key = false;
  for (int i = 0; i < 8; ++i) {
    const auto packets = ends.submit();
    key = key || packets[0].key;
    ends.give(ends.drain(*ends.server));
    ends.answer();
  }
  EXPECT_LE(ends.server->traffic().packets_sent, before + 8 + 9) << "those of the last 90 ms";
  EXPECT_FALSE(key);
  ends.expect_same();
}

/// Any loss, doubling and disorder, bursts too: what the client decodes is what the server has, in order.
TEST(RepairedExchange, LossAndDisorderAreRepaired) {
  for (const Chains& of : kChains) {
    RepairedEnds ends(of.meshes(), of.objects);
    std::mt19937_64 random(of.objects + of.shapes);
    std::vector<std::pair<std::uint64_t, Bytes>> in_flight;
    std::uint64_t decoded = 0;
    for (int i = 0; i < 3000; ++i) {
      ends.submit();
      for (Bytes& bytes : ends.drain(*ends.server)) {
        if (random() % 10 < 3) continue;
        if (random() % 10 == 0) in_flight.emplace_back(ends.now + random() % 50'000, bytes);
        in_flight.emplace_back(ends.now + random() % 15'000, std::move(bytes));
      }
      ends.now += 10 * kMillisecond;
      for (std::size_t k = 0; k < in_flight.size();) {
        if (in_flight[k].first > ends.now) {
          ++k;
          continue;
        }
        const auto heard = ends.hear(*ends.client, in_flight[k].second);
        if (heard && heard->tick) ++decoded;
        in_flight.erase(in_flight.begin() + static_cast<std::ptrdiff_t>(k));
      }
      for (const Bytes& bytes : ends.drain(*ends.client)) {
        if (random() % 10 >= 3) {
          EXPECT_TRUE(ends.hear(*ends.server, bytes));
        }
      }
    }
    for (int i = 0; i < 30; ++i) ends.step();
    EXPECT_GT(decoded, 500u);
    EXPECT_EQ(ends.client->traffic().packets_refused, 0u) << of.shapes << " shapes";
    ends.expect_same();
  }
}

}  // namespace
}  // namespace tactus
