// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/file_kind.h>

#include <gtest/gtest.h>

#include <string_view>

namespace tactus {
namespace {

using std::string_view_literals::operator""sv;

Diagnostic kind(std::string_view text) {
  return not_mcap({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, "in.x");
}

TEST(TraceFileKind, KnownKindsAreNamedWithTheirCommand) {
  const std::pair<std::string_view, std::string_view> cases[] = {
      {"#ROSBAG V2.0\n"sv, "rosbags-convert --src in.x"},
      {"SQLite format 3\0"sv, "ros2 bag convert -i in.x"},
      {"\x1f\x8b\x08"sv, "gunzip in.x"},
      {"\xfd"
       "7zXZ\0"sv,
       "xz -d in.x"},
      {"BZh9"sv, "bunzip2 in.x"},
      {"PK\x03\x04"sv, "unzip in.x"},
      {"\x89"
       "TCT"sv,
       "tactus decode in.x"},
      {" {\"a\": 1}"sv, "import csv"},
      {"\x93NUMPY\x01\0"sv, "numpy.load('in.x')"},
      {"MATLAB 5.0 MAT-file"sv, "writematrix"},
      {"PAR1"sv, "read_parquet('in.x')"},
      {"\x89HDF\r\n\x1a\n"sv, "h5py.File('in.x')"},
      {"\xd0\xcf\x11\xe0"sv, "--convert-to csv in.x"},
      {"PK\x03\x04xxxxxxxxxxxxxxxxxxxxxxxxxx[Content_Types].xml"sv, "--convert-to csv in.x"},
      {"TDSm"sv, "TdmsFile.read('in.x')"},
      {"\x02\x50xx"sv, "c3d2csv in.x"},
      {"t,x\n0,1\n"sv, "import csv in.x"}};
  for (const auto& [first, command] : cases) {
    const Diagnostic error = kind(first);
    EXPECT_EQ(error.error.code, Errc::unsupported) << command;
    EXPECT_EQ(error.error.rule, std::string_view("R-TRC-2"));
    EXPECT_NE(error.remedy.find(command), std::string::npos) << error.remedy;
  }
  EXPECT_EQ(kind("").error.rule, std::string_view("R-TRC-3"));
  EXPECT_EQ(kind("\x89MCA").error.code, Errc::truncated);
  EXPECT_EQ(kind("\x89MCAP1\r\n").error.rule, std::string_view("R-TRC-7"));
  EXPECT_EQ(kind("\x01\x02\x03\xf0").error.code, Errc::malformed);
  EXPECT_TRUE(kind("\x01\x02\x03\xf0").cause.empty());
}

/// What is printed may be copied into a shell.
TEST(TraceFileKind, ANameThatAShellWouldReadDoesNotStandInACommand) {
  const auto remedy = [](std::string_view first, const std::string& path) {
    return not_mcap(std::span(reinterpret_cast<const std::uint8_t*>(first.data()), first.size()), path).remedy;
  };
  EXPECT_EQ(remedy("BZh9", "/data/run_1-a.mcap"), "Unpack it first: `bunzip2 /data/run_1-a.mcap`.");
  for (const char* name :
       {"$(touch x).mcap", "a'); import os; ('.npy", "two words.mcap", "a;b", "`id`", "a\nb", "-rf", "\"", "", "-"}) {
    EXPECT_EQ(remedy("BZh9", name), "Unpack it first: `bunzip2 FILE`.") << name;
    EXPECT_NE(remedy("\x93NUMPY\x01", name).find("numpy.load('FILE')"), std::string::npos) << name;
  }
}

TEST(TraceFileKind, TopicsAreNamedByEncoding) {
  std::map<std::uint16_t, mcap::Channel> channels;
  for (std::uint16_t i = 1; i <= 6; ++i) channels[i] = {i, 0, "/t" + std::to_string(i), i == 6 ? "json" : "protobuf", {}};
  const Diagnostic error = nothing_of_use({}, channels, "in.x");
  EXPECT_EQ(error.error.rule, std::string_view("R-TRC-7"));
  EXPECT_EQ(error.cause, "no topic has messages of ROS 2 (json: /t6; protobuf: /t1, /t2, /t3, /t4 and 1 more)");
  EXPECT_EQ(nothing_of_use({{1, {1, "std_msgs/msg/String", "", ""}}}, {{1, {1, 1, "/words", "cdr", {}}}}, "").cause,
            "no topic has poses, transforms or forces (cdr: /words); of ROS 2 it holds std_msgs/msg/String");
}

}  // namespace
}  // namespace tactus
