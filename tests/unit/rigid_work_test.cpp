// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <vector>

#include <tactus/rigid/rigid_work.h>
#include "tests/unit/rigid_fixture.h"

namespace tactus {
namespace {

TEST(RigidWork, ADecisionIsFoundByAllThatItDependsOn) {
  RigidWork work(*testing::scene_of(5));
  const RigidWork::Asked asked{.version = 7, .object = 2, .bound_scale = 1, .early = 0.5};
  EXPECT_EQ(work.find(1, asked), nullptr);
  work.put(1, asked, {Reason::visual, true});
  ASSERT_NE(work.find(1, asked), nullptr);
  EXPECT_EQ(work.find(1, asked)->reason, Reason::visual);
  EXPECT_TRUE(work.find(1, asked)->is_early);
  EXPECT_EQ(work.find(2, asked), nullptr) << "the truth is another one";
  for (RigidWork::Asked other : {RigidWork::Asked{8, 2, 1, 0.5}, {7, 3, 1, 0.5}, {7, 2, 2, 0.5}, {7, 2, 1, 0.3}})
    EXPECT_EQ(work.find(1, other), nullptr);
}

TEST(RigidWork, PathsOfOneContentHaveOneVersionWhateverTheHead) {
  RigidWork work(*testing::scene_of(5));
  const std::vector<std::uint32_t> key{1, 10, 5, 6}, later{2, 20, 5, 6}, other{1, 10, 5, 7};
  const std::array<std::uint8_t, 3> bytes{1, 2, 3};
  std::array<VersionedPath, 4> paths;
  const auto put = [&](std::uint64_t read, const std::vector<std::uint32_t>& of, VersionedPath& path) {
    VersionedPath* const after = &path;
    work.put(read, of, bytes, Reason::haptic, {&after, 1});
  };
  put(1, key, paths[0]);
  put(1, later, paths[1]);
  put(1, other, paths[2]);
  put(2, key, paths[3]);
  EXPECT_NE(paths[0].version, 0u);
  EXPECT_EQ(paths[1].version, paths[0].version);
  EXPECT_NE(paths[2].version, paths[0].version);
  EXPECT_NE(paths[3].version, paths[0].version) << "in another tick it is another path";
  ASSERT_NE(work.find(1, later), nullptr);
  EXPECT_EQ(work.find(1, later)->bytes, std::vector<std::uint8_t>(bytes.begin(), bytes.end()));
  EXPECT_EQ(work.find(1, later)->after[0].version, paths[0].version);
  EXPECT_EQ(work.find(1, std::vector<std::uint32_t>{3, 20, 5, 6}), nullptr);
  EXPECT_NE(work.next_version(), paths[3].version);
}

/// Those of many clients that differ: the oldest is forgotten, and none is taken for another.
TEST(RigidWork, OnlyTheNewestPayloadsAreKept) {
  RigidWork work(*testing::scene_of(2));
  VersionedPath path;
  VersionedPath* const after = &path;
  for (std::uint32_t i = 0; i < 9; ++i) work.put(1, std::vector<std::uint32_t>{0, 0, i}, {}, Reason::visual, {&after, 1});
  EXPECT_EQ(work.find(1, std::vector<std::uint32_t>{0, 0, 0}), nullptr);
  EXPECT_NE(work.find(1, std::vector<std::uint32_t>{0, 0, 1}), nullptr);
}

}  // namespace
}  // namespace tactus
