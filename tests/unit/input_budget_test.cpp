// SPDX-License-Identifier: Apache-2.0
// What traces and tables may cost: io/trace/input_budget.h and its users.
#include <tactus/trace/input_budget.h>

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include <tactus/trace/byte_source.h>
#include <tactus/trace/csv.h>
#include <tactus/trace/mcap_reader.h>
#include "tests/unit/trace_fixture.h"

namespace tactus {
namespace {

constexpr std::size_t kFree = InputBudget::kFree;

TEST(InputBudget, SpendsWhatIsFreeAndWhatIsEarned) {
  InputBudget budget;
  EXPECT_FALSE(budget.spend(kFree + 1));
  EXPECT_TRUE(budget.spend(kFree)) << "nothing is spent by a refusal";
  EXPECT_FALSE(budget.spend(1));
  budget.earn(2);
  EXPECT_TRUE(budget.spend(2 * InputBudget::kEarnedByByte));
  EXPECT_FALSE(budget.spend(1));
}

TEST(InputBudget, TableThatUnpacksToFarMoreIsRefused) {
  const TempFile table, trace;
  CsvMapping mapping;
  mapping.position = {"x", "y", "z"};
  const auto rule_of = [&](std::size_t lines) {
    const Bytes text(lines, '\n');
    Compressor compressor;
    const auto packed = compressor.compress(text).value();
    std::ofstream(table.path(), std::ios::binary)
        .write(reinterpret_cast<const char*>(packed.data()), static_cast<std::streamsize>(packed.size()));
    return std::string(import_csv(table.path(), mapping, trace.path()).error().error.rule);
  };
  EXPECT_EQ(rule_of(kFree / 2), "R-CSV-1") << "nothing but ends of lines";
  EXPECT_EQ(rule_of(kFree + (std::size_t{16} << 20)), "R-CSV-9");
}

/// A mesh at rest, whose shape is written anew at every tick: zeros, which zstd packs far more than a budget allows.
struct RestingMesh {
  static constexpr std::size_t kVertices = 60000, kTicks = 400;
  TraceInfo info;
  TraceFrame frame;
  RestingMesh() {
    TraceDeformable& mesh = info.meshes.emplace_back(TraceDeformable{.name = "sheet", .rest = {}});
    for (std::size_t i = 0; i < kVertices; ++i)
      mesh.rest.vertices.push_back({static_cast<double>(i / 2), i % 2 == 0 ? 0.0 : 1.0, 0});
    for (std::uint32_t i = 0; i + 2 < kVertices; ++i)
      mesh.rest.triangles.push_back(i % 2 == 0 ? Triangle{i, i + 2, i + 1} : Triangle{i, i + 1, i + 2});
    frame.meshes.push_back({true, std::vector<float>(3 * kVertices)});
  }
};

TEST(InputBudget, OwnTracesStayWithinIt) {
  RestingMesh mesh;
  static_assert(RestingMesh::kTicks * RestingMesh::kVertices * 12 > 4 * kFree,
                "beyond what is free and what the rest shape earns");
  const TempFile file;
  {
    auto writer = TraceWriter::create(file.path(), mesh.info);
    ASSERT_TRUE(writer) << writer.error().rule;
    for (; mesh.frame.tick < static_cast<std::int64_t>(RestingMesh::kTicks); ++mesh.frame.tick)
      ASSERT_TRUE(writer->write(mesh.frame));
    ASSERT_TRUE(writer->finish());
  }
  auto reader = TraceReader::open(file.path());
  ASSERT_TRUE(reader) << reader.error().rule;
  TraceFrame frame;
  std::size_t frames = 0;
  while (true) {
    const auto more = reader->next(frame);
    ASSERT_TRUE(more) << more.error().rule << " after " << frames << " frames";
    if (!*more) break;
    ++frames;
  }
  EXPECT_EQ(frames, RestingMesh::kTicks);
  EXPECT_LT(std::filesystem::file_size(file.path()), std::size_t{20} << 20) << "one chunk as it is earns many that are packed";
}

}  // namespace
}  // namespace tactus
