// SPDX-License-Identifier: Apache-2.0
/// Packets that are too large for a datagram, between two ends of a session: Exchange, Fragments, SentFragments and Resends together.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include <tactus/session/exchange.h>
#include "tests/unit/session_exchange_fixture.h"

namespace tactus {
namespace {

using testing::Bytes;
using testing::Ends;
using testing::kEpoch;
using testing::kIsFragment;
using testing::kIsPacket;
using testing::kMillisecond;
using testing::types_of;

/// Ticks over a network that loses nothing.
void exchange(Ends& ends, int ticks) {
  for (int i = 0; i < ticks; ++i) {
    ends.submit();
    ends.give(ends.drain(*ends.server));
    ends.answer();
  }
}

/// The server hears what the client has to send after each datagram.
void give_and_answer(Ends& ends, const std::vector<Bytes>& down) {
  for (const Bytes& bytes : down) {
    EXPECT_TRUE(ends.hear(*ends.client, bytes));
    for (const Bytes& datagram : ends.drain(*ends.client)) EXPECT_TRUE(ends.hear(*ends.server, datagram));
  }
}

TEST(ExchangeFragments, ALargePacketComesInFragments) {
  Ends ends({.squares = 40, .count = 1, .noise = 5e-3});
  const auto packets = ends.submit();
  ASSERT_EQ(packets.size(), 2u);
  const std::size_t size = packets[1].bytes.size(), count = (size + 1149) / 1150;
  ASSERT_GT(count, 3u);
  auto down = ends.drain(*ends.server);
  ASSERT_GE(down.size(), count);
  for (const Bytes& bytes : down) EXPECT_LE(bytes.size(), kLargestDatagram);
  EXPECT_EQ(types_of(down[0]), std::vector<std::size_t>{kIsPacket});
  EXPECT_EQ(types_of(down[2]), std::vector<std::size_t>{kIsFragment});
  std::mt19937_64 random(3);
  std::ranges::shuffle(down, random);
  for (std::size_t i = 0; i < down.size(); ++i) {
    EXPECT_LT(ends.client->traffic().packets_heard, 2u);
    EXPECT_TRUE(ends.hear(*ends.client, down[i]));
  }
  EXPECT_EQ(ends.client->traffic().packets_heard, 2u);
  ends.expect_same();
  ends.answer();
  EXPECT_EQ(ends.server->sent().highest_acknowledged(), down.size());
  EXPECT_EQ(ends.server->sent().loss(), 0u);
  EXPECT_EQ(ends.server->traffic().packets_sent, 2u);
  const auto next = ends.submit();
  ASSERT_EQ(next.size(), 2u);
  EXPECT_FALSE(next[1].key) << "the packet has become a baseline";
}

/// Fragments are acknowledged one by one, but a packet that lacks one must not be built on.
TEST(ExchangeFragments, WithoutAllItsFragmentsAPacketIsNoBaseline) {
  for (const bool layered : {false, true}) {
    Ends ends({.squares = 40, .count = 1, .layered = layered, .noise = 5e-3}, 0);
    exchange(ends, 3);
    ends.submit();
    auto down = ends.drain(*ends.server);
    ASSERT_GT(down.size(), 3u);
    down.erase(down.begin() + 1);
    const std::uint64_t before = ends.client->traffic().packets_heard;
    ends.give(down);
    EXPECT_EQ(ends.client->traffic().packets_heard, before + (layered ? 1u : 0u)) << "the haptic layer is small";
    ends.now += 5 * kMillisecond;
    ends.answer();
    EXPECT_EQ(ends.server->traffic().lost, 1u);
    for (int i = 0; i < 3; ++i, ends.now += 50 * kMillisecond) ends.drain(*ends.server);  // copies are lost, too
    exchange(ends, 10);
    EXPECT_EQ(ends.client->traffic().packets_refused, 0u);
    EXPECT_GE(ends.client->traffic().packets_heard, before + 10);
    ends.expect_same();
  }
}

TEST(ExchangeFragments, ALostFragmentComesAgainAlone) {
  Ends ends({.squares = 40, .count = 1, .noise = 5e-3}, 0);
  exchange(ends, 3);
  const std::uint64_t before = ends.client->traffic().packets_heard;
  ends.submit();
  auto down = ends.drain(*ends.server);
  ASSERT_GT(down.size(), 3u);
  down.erase(down.begin() + 1);
  ends.give(down);
  EXPECT_EQ(ends.client->traffic().packets_heard, before);
  ends.now += 5 * kMillisecond;
  ends.answer();
  EXPECT_EQ(ends.server->traffic().lost, 1u);
  const auto copies = ends.drain(*ends.server);
  ASSERT_EQ(copies.size(), 1u);
  EXPECT_EQ(types_of(copies[0]).back(), kIsFragment);
  ends.give(copies);
  EXPECT_EQ(ends.client->traffic().packets_heard, before + 1) << "the packet is whole";
  ends.expect_same();
  ends.answer();
  EXPECT_TRUE(ends.drain(*ends.server).empty()) << "one loss is not many: it goes once";
  EXPECT_EQ(ends.server->sent().highest_acknowledged(), ends.server->sent().newest()) << "what comes again is acknowledged, too";
}

/// An acknowledgement reports 65 numbers: one of a packet in more fragments than that must go before all have come.
TEST(ExchangeFragments, APacketOfManyFragmentsIsAcknowledgedMeanwhile) {
  Ends ends({.squares = 160, .count = 1, .noise = 2e-2}, 0);
  ends.submit();
  const auto down = ends.drain(*ends.server);
  ASSERT_GT(down.size(), 65u);
  give_and_answer(ends, down);
  EXPECT_EQ(ends.server->traffic().lost, 0u);
  EXPECT_EQ(ends.server->sent().highest_acknowledged(), down.size());
  ends.expect_same();
}

/// Its numbers are more than the states that an end keeps. Neither its own substream nor another one needs a key packet for that.
TEST(ExchangeFragments, APacketOfManyFragmentsIsABaseline) {
  Ends ends({.squares = 160, .count = 1, .noise = 2e-2});
  for (int tick = 0; tick < 3; ++tick) {
    const auto packets = ends.submit();
    ASSERT_EQ(packets.size(), 2u);
    for (const Packet& packet : packets)
      EXPECT_EQ(packet.key, tick == 0) << "substream " << packet.substream << ", tick " << tick;
    const auto down = ends.drain(*ends.server);
    EXPECT_GT(down.size(), 64u);
    give_and_answer(ends, down);
    ends.answer();
    EXPECT_EQ(ends.client->traffic().packets_refused, 0u);
    ends.expect_same();
  }
}

/// A datagram is acknowledged as a whole. Packets, fragments and copies of both wait at the same time here.
TEST(ExchangeFragments, AFragmentSharesItsDatagramWithNoOtherPacket) {
  Ends ends({.squares = 40, .count = 3, .noise = 2e-3});
  std::size_t fragments = 0, datagrams = 0;
  for (int i = 0; i < 200; ++i) {
    ends.submit();
    std::vector<Bytes> arrive;
    for (const Bytes& bytes : ends.drain(*ends.server)) {
      const auto types = types_of(bytes);
      const auto in_it = std::ranges::count_if(types, [](std::size_t type) { return type >= kIsFragment; });
      if (std::ranges::find(types, kIsFragment) != types.end()) {
        ++fragments;
        EXPECT_EQ(in_it, 1);
      }
      if (++datagrams % 5 != 0 || i > 180) arrive.push_back(bytes);
    }
    ends.give(arrive);
    ends.answer();
  }
  ends.expect_same();
  EXPECT_GT(fragments, 500u);
  EXPECT_GT(ends.server->traffic().lost, 100u);
}

TEST(ExchangeFragments, NothingIsWrittenBehindAFragment) {
  const Bytes some(20, 1);
  for (const bool is_packet : {false, true}) {
    DatagramWriter writer(Direction::down);
    writer.begin(1);
    ASSERT_TRUE(writer.add(FragmentPart{0, 1, 1, 2, some}));
    EXPECT_FALSE(writer.add(is_packet ? Part(PacketPart{0, some}) : Part(FragmentPart{0, 2, 1, 2, some})));
    EXPECT_TRUE(read_datagram(writer.finish(kEpoch), Direction::down));
  }
}

}  // namespace
}  // namespace tactus
