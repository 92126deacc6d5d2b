// SPDX-License-Identifier: Apache-2.0
#include <tactus/packet/substream.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "tests/unit/deformable_fixture.h"

namespace tactus {
namespace {

StreamHeader scene(std::size_t meshes, std::uint8_t dof) {
  StreamHeader header = testing::mesh_header(testing::sheet(1, 1));
  header.meshes.resize(meshes, header.meshes[0]);
  header.objects.push_back({"box", dof, {}});
  return header;
}

TEST(Part, OnePartHasNoByte) {
  const std::array<std::uint8_t, 3> packet{7, 8, 9};
  for (const auto& [meshes, dof, part] : {std::tuple{0U, Dof::all, 0U}, {1U, Dof::none, 1U}, {0U, Dof::none, 0U}}) {
    const auto split = split_part(scene(meshes, dof), packet);
    ASSERT_TRUE(split);
    EXPECT_EQ(split->part, part);
    EXPECT_EQ(split->bytes.size(), 3U);
  }
}

TEST(Part, SeveralPartsAreTold) {
  const auto part_of = [](const StreamHeader& header, std::uint8_t byte) {
    const std::array<std::uint8_t, 2> packet{byte, 5};
    const auto split = split_part(header, packet);
    EXPECT_EQ(split ? split->bytes.size() : 1, 1U);
    return split ? static_cast<int>(split->part) : -1;
  };
  EXPECT_EQ(part_of(scene(1, Dof::all), 0), 0);
  EXPECT_EQ(part_of(scene(1, Dof::all), 1), 1);
  EXPECT_EQ(part_of(scene(1, Dof::all), 2), -1);
  EXPECT_EQ(part_of(scene(2, Dof::none), 0), -1);
  EXPECT_EQ(part_of(scene(2, Dof::none), 2), 2);
  EXPECT_STREQ(split_part(scene(2, Dof::none), {}).error().rule, "R-PKT-6");
  EXPECT_EQ(split_part(scene(2, Dof::none), {}).error().code, Errc::truncated);
}

TEST(Part, WhatWasJoinedIsSplitAgain) {
  const std::array<std::uint8_t, 3> packet{7, 8, 9};
  for (const auto& header : {scene(2, Dof::all), scene(1, Dof::none), scene(0, Dof::all)}) {
    PartJoiner joiner(header);
    const std::size_t part = header.meshes.size();
    const auto joined = joiner.join(part, packet);
    EXPECT_EQ(joined.size(), has_part_byte(header) ? 4u : 3u);
    const auto split = split_part(header, joined);
    ASSERT_TRUE(split);
    EXPECT_EQ(split->part, part);
    EXPECT_TRUE(std::ranges::equal(split->bytes, packet));
  }
}

}  // namespace
}  // namespace tactus
