// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/fragments.h>

#include <gtest/gtest.h>

namespace tactus {
namespace {

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
