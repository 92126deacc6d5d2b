// SPDX-License-Identifier: Apache-2.0
/// Which substream a packet is of.
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <tuple>
#include <vector>

#include <tactus/packet/substream.h>
#include <tactus/tactus.h>
#include "tests/unit/deformable_fixture.h"

namespace tactus {
namespace {

using testing::scene_of_sheets;

TEST(Substream, OneAloneHasNoNumber) {
  const std::array<std::uint8_t, 3> packet{7, 8, 9};
  for (const auto& [deformables, dof, substream] : {std::tuple{0U, Dof::all, 0U}, {1U, Dof::none, 1U}, {0U, Dof::none, 0U}}) {
    const auto split = split_substream(*scene_of_sheets(deformables, dof), packet);
    ASSERT_TRUE(split);
    EXPECT_EQ(split->substream, substream);
    EXPECT_EQ(split->bytes.size(), 3U);
  }
}

TEST(Substream, OfSeveralEachIsReported) {
  const auto substream_of = [](const SharedScene& of, std::uint8_t byte) {
    const std::array<std::uint8_t, 2> packet{byte, 5};
    const auto split = split_substream(*of, packet);
    EXPECT_EQ(split ? split->bytes.size() : 1, 1U);
    return split ? static_cast<int>(split->substream) : -1;
  };
  EXPECT_EQ(substream_of(scene_of_sheets(1, Dof::all), 0), 0);
  EXPECT_EQ(substream_of(scene_of_sheets(1, Dof::all), 1), 1);
  EXPECT_EQ(substream_of(scene_of_sheets(1, Dof::all), 2), -1);
  EXPECT_EQ(substream_of(scene_of_sheets(2, Dof::none), 0), -1);
  EXPECT_EQ(substream_of(scene_of_sheets(2, Dof::none), 2), 2);
  EXPECT_STREQ(split_substream(*scene_of_sheets(2, Dof::none), {}).error().rule, "R-PKT-6");
  EXPECT_EQ(split_substream(*scene_of_sheets(2, Dof::none), {}).error().code, Errc::truncated);
}

/// What a sender makes begins with its substream's number, if there are several.
TEST(Substream, WhatWasSentIsSplitAgain) {
  for (const SharedScene& of : {scene_of_sheets(2, Dof::all), scene_of_sheets(1, Dof::none), scene_of_sheets(0, Dof::all),
                                scene_of_sheets(2, Dof::none)}) {
    auto sender = Sender::create(of).value();
    RigidSample moved;
    moved.pose.position.x = 0.1;
    const std::vector<float> shape = testing::moved_by(4, {0, 0, 0.01});
    const std::vector<DeformableTruth> shapes(of->deformables.size(), {shape, {}});
    const auto packets = sender.encode(3, {.objects = {&moved, 1}, .deformables = shapes});
    ASSERT_TRUE(packets) << packets.error().rule;
    ASSERT_EQ(packets->size(), of->moving().size() + of->deformables.size());
    for (const Packet& packet : *packets) {
      const auto split = split_substream(*of, packet.bytes);
      ASSERT_TRUE(split);
      EXPECT_EQ(split->substream, packet.substream);
      EXPECT_EQ(packet.bytes.size() - split->bytes.size(), has_substream_number(*of) ? 1u : 0u);
    }
    EXPECT_EQ(has_substream_number(*of), packets->size() > 1);
  }
}

}  // namespace
}  // namespace tactus
