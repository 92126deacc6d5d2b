// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/surface/surface_sequence.h>

#include <gtest/gtest.h>

#include "tests/unit/tet_fixture.h"

namespace tactus::sim {
namespace {

constexpr std::string_view kSquare = "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 2 3 4 5\n";  // the first vertex has no face

std::string_view rule_of(const std::string& folder) {
  const auto sequence = SurfaceSequence::open(folder);
  return sequence ? "" : sequence.error().error.rule;
}

std::string_view rule_of_second(std::string_view text) {
  const TempFolder folder;
  folder.write("1.obj", kSquare);
  folder.write("2.obj", text);
  const auto positions = SurfaceSequence::open(folder.file("")).value().positions(1);
  return positions ? "" : positions.error().error.rule;
}

TEST(SurfaceSequence, NumbersInNamesCompareByValue) {
  const std::vector<std::string> ordered{
      "a", "a1", "a01", "a2", "a10", "a10b2", "a10b10", "a99999999999999999999", "a100000000000000000000", "b"};
  for (std::size_t i = 0; i < ordered.size(); ++i) {
    for (std::size_t j = 0; j < ordered.size(); ++j) {
      if (ordered[i] == "a1" && ordered[j] == "a01") continue;  // equal in value: either order, but one
      if (ordered[i] == "a01" && ordered[j] == "a1") continue;
      EXPECT_EQ(natural_less(ordered[i], ordered[j]), i < j) << ordered[i] << ' ' << ordered[j];
    }
  }
  EXPECT_NE(natural_less("a1", "a01"), natural_less("a01", "a1"));
}

TEST(SurfaceSequence, FramesInOrderWithoutUnusedVertices) {
  const TempFolder folder;
  folder.write("f10.obj", "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 1 1 0.5\nv 0 1 0\nf 2 3 4 5\n");
  folder.write("f9.obj", kSquare);
  folder.write("notes.txt", "not a surface");
  const auto sequence = SurfaceSequence::open(folder.file(""));
  ASSERT_TRUE(sequence) << to_string(sequence.error());
  ASSERT_EQ(sequence->size(), 2U);
  EXPECT_EQ(sequence->rest().vertices.size(), 4U);
  EXPECT_EQ(sequence->rest().triangles.size(), 2U);
  EXPECT_EQ(sequence->positions(0).value(), sequence->rest().vertices);
  EXPECT_EQ(sequence->positions(1).value()[2], (Vec3{1, 1, 0.5}));
}

TEST(SurfaceSequence, LaterFramesMayCollapse) {
  EXPECT_EQ(rule_of_second("v 9 9 9\nv 0 0 0\nv 0 0 0\nv 0 0 0\nv 0 0 0\nf 2 3 4 5\n"), "");
}

TEST(SurfaceSequence, EachRule) {
  const TempFolder empty, mixed, stl;
  mixed.write("a.obj", kSquare);
  mixed.write("b.off", kSquare);
  stl.write("a.STL", "");
  EXPECT_EQ(rule_of(empty.file("nothing")), "R-SEQ-1");
  EXPECT_EQ(rule_of(empty.file("")), "R-SEQ-2");
  EXPECT_EQ(rule_of(mixed.file("")), "R-SEQ-2");
  EXPECT_EQ(rule_of(stl.file("")), "R-SEQ-3");
  EXPECT_EQ(rule_of_second("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"), "R-SEQ-4");
  EXPECT_EQ(rule_of_second("v 9 9 9\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 2 3 4\nf 2 4 5\n"), "R-SEQ-4");
  EXPECT_EQ(rule_of_second("v 9 9 9\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 2 3 5 4\n"), "R-SEQ-4");
  EXPECT_EQ(rule_of_second("v 9 9 9\nv 0 0 0\nv 1 0 0\nv 1 1 2e6\nv 0 1 0\nf 2 3 4 5\n"), "R-SRF-8");
  EXPECT_EQ(rule_of_second("v 0 0 0\n"), "R-SRF-7");
}

}  // namespace
}  // namespace tactus::sim
