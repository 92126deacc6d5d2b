// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/bag_folder.h>

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include <tactus/trace/mcap_reader.h>
#include "tests/unit/temp_file.h"
#include "tests/unit/trace_fixture.h"

namespace tactus {
namespace {

TEST(TraceBagFolder, MetadataIsReadWhateverItsDepth) {
  const BagMetadata metadata = parse_bag_metadata(
      "# a comment\nrosbag2_bagfile_information:\r\n  version: 9\r\n  storage_identifier: mcap\r\n  relative_file_paths:\r\n    "
      "- \"a_0.mcap\"\r\n"
      "    - a_1.mcap\r\n  message_count: 12\n  topics_with_message_count:\n    - message_count: 99\n      topic_metadata:\n"
      "        compression_mode: no\n  compression_format: 'zstd'\n  compression_mode: FILE\nother:\n  storage_identifier: x\n");
  EXPECT_EQ(metadata.storage, "mcap");
  EXPECT_EQ(metadata.files, (std::vector<std::string>{"a_0.mcap", "a_1.mcap"}));
  EXPECT_EQ(metadata.message_count, 12U);
  EXPECT_EQ(metadata.compression_format, "zstd");
  EXPECT_EQ(metadata.compression_mode, "FILE");
  // Lists without an indentation of their own, as yaml-cpp and PyYAML write them.
  EXPECT_EQ(parse_bag_metadata("rosbag2_bagfile_information:\n  relative_file_paths:\n  - x.mcap\n  - y.mcap\n").files.size(),
            2U);
}

TEST(TraceBagFolder, ARecordingCanBeReadTwice) {
  const TempFile file;
  write_recording(make_recording(5), file.path());
  const RecordingFiles files = files_of(file.path()).value();
  std::size_t counts[2] = {0, 0};
  for (std::size_t& count : counts) {
    auto reader = mcap::Reader::open(files).value();
    while (reader.next().value() != mcap::Item::end) ++count;
    EXPECT_EQ(reader.bytes_read(), files.bytes());
  }
  EXPECT_GT(counts[0], 5U);
  EXPECT_EQ(counts[0], counts[1]);
  EXPECT_EQ(files.bytes(), std::filesystem::file_size(file.path()));
}

TEST(TraceBagFolder, WithoutAListTheNumbersInTheNamesOrderTheFiles) {
  const auto folder = std::filesystem::path(::testing::TempDir()) / ("tactus_bag_" + std::to_string(getpid()));
  std::filesystem::create_directory(folder);
  for (const char* name : {"b_10.mcap", "b_9.mcap", "b_1.mcap", ".b_0.mcap", "notes.txt"}) std::ofstream(folder / name) << name;
  const auto files = files_of(folder.string());
  std::filesystem::remove_all(folder);
  ASSERT_TRUE(files);
  ASSERT_EQ(files->count(), 3U);
  EXPECT_EQ(files->name(0), "b_1.mcap");
  EXPECT_EQ(files->name(2), "b_10.mcap");
  EXPECT_EQ(files->notes.size(), 1U);
}

/// A bag lies in one folder: what its list says opens nothing outside of it.
TEST(TraceBagFolder, NothingOutsideOfTheFolderIsOpened) {
  const auto outer = std::filesystem::path(::testing::TempDir()) / ("tactus_outer_" + std::to_string(getpid()));
  std::filesystem::create_directories(outer / "bag");
  std::ofstream(outer / "secret.mcap") << "secret";
  for (const std::string& name : {std::string("../secret.mcap"), (outer / "secret.mcap").string(), std::string("..")}) {
    std::ofstream(outer / "bag" / "metadata.yaml")
        << "rosbag2_bagfile_information:\n  relative_file_paths:\n    - " << name << '\n';
    const auto files = files_of((outer / "bag").string());
    ASSERT_FALSE(files) << name;
    EXPECT_EQ(files.error().error.rule, std::string_view("R-TRC-1")) << name;
    EXPECT_NE(files.error().cause.find("not there"), std::string::npos) << name;
  }
  std::filesystem::remove_all(outer);
}

}  // namespace
}  // namespace tactus
