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

/// The order of files, as "name@offset name@offset"; a rule if they are refused.
std::string order(const std::vector<std::string>& names, const SequenceOptions& options = {}) {
  const TempFolder folder;
  for (const std::string& name : names) folder.write(name, kSquare);
  const auto sequence = SurfaceSequence::open(folder.file(""), options);
  if (!sequence) return sequence.error().error.rule + (' ' + sequence.error().detail);
  std::string out;
  for (std::size_t k = 0; k < sequence->size(); ++k) {
    out += (k > 0 ? " " : "") + std::filesystem::path(sequence->file(k)).stem().string();
    if (sequence->offset(k) != static_cast<double>(k)) out += '@' + std::to_string(static_cast<int>(sequence->offset(k)));
  }
  return out;
}

TEST(SurfaceSequence, NumbersGiveOrderAndTime) {
  EXPECT_EQ(order({"f_-1.obj", "f_-2.obj", "f_-3.obj", "f_0.obj", "f_1.obj"}), "f_-3 f_-2 f_-1 f_0 f_1");
  EXPECT_EQ(order({"f-1.obj", "f-2.obj", "f0.obj", "f1.obj"}), "f-2 f-1 f0 f1");
  EXPECT_EQ(order({"f-1.obj", "f-2.obj", "f-10.obj"}), "f-1 f-2 f-10@9");
  EXPECT_EQ(order({"f_-0002.obj", "f_-0001.obj", "f_0000.obj"}), "f_-0002 f_-0001 f_0000");
  EXPECT_EQ(order({"t=0.1.obj", "t=0.2.obj", "t=0.05.obj", "t=0.15.obj", "t=0.obj"}), "t=0 t=0.05 t=0.1 t=0.15 t=0.2");
  EXPECT_EQ(order({"f0.obj", "f1.obj", "f2.obj", "f5.obj", "f6.obj"}), "f0 f1 f2 f5@5 f6@6");
  EXPECT_EQ(order({"f0.obj", "f10.obj", "f20.obj", "f40.obj"}), "f0 f10 f20 f40@4");
  EXPECT_EQ(order({"v2_f_1.obj", "v2_f_9.obj", "v2_f_10.obj"}), "v2_f_1 v2_f_9@8 v2_f_10@9");
  EXPECT_EQ(order({"a.0001.obj", "a.0002.obj"}), "a.0001 a.0002");
}

TEST(SurfaceSequence, TwoSeriesAreRefusedOrChosen) {
  const std::vector<std::string> two{"left_0.obj", "left_1.obj", "right_0.obj", "right_1.obj"};
  EXPECT_EQ(order(two), "R-SEQ-5 left_*.obj and right_*.obj");
  EXPECT_EQ(order(two, {.series = "right_*"}), "right_0 right_1");
  EXPECT_EQ(order(two, {.series = "up_*"}), "R-SEQ-2 no file is called like 'up_*'; there is left_0.obj");
  EXPECT_EQ(order({"b1_0.obj", "b1_1.obj", "b2_0.obj", "b2_1.obj"}), "R-SEQ-5 b1_*.obj and b2_*.obj");
  EXPECT_EQ(order({"f1.obj", "f01.obj"}), "R-SEQ-5 the same number in f01.obj and f1.obj");
}

TEST(SurfaceSequence, CopiesAndHiddenFilesAreNoFrames) {
  EXPECT_EQ(order({"f_0.obj", "f_1.obj", "f_1 (copy).obj", "f_1.obj~", "._f_0.obj", ".DS_Store", "Thumbs.db", "f_1 - Copy.obj"}),
            "f_0 f_1");
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
