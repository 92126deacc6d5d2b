// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/file_kind.h>

#include <algorithm>
#include <array>
#include <set>
#include <string_view>

#include <tactus/base/rule.h>
#include <tactus/base/shown.h>
#include <tactus/base/text.h>

namespace tactus {
namespace {

constexpr std::string_view kSpreadsheet =
    "Save it as CSV, for example by `libreoffice --convert-to csv FILE`, then `tactus import csv`.";
constexpr std::string_view kDataFrame =
    "`python3 -c \"import pandas; pandas.read_parquet('FILE').to_csv('table.csv', index=False)\"`, then `tactus import csv "
    "table.csv`.";
struct Kind {
  std::string_view magic;
  std::size_t offset;
  std::string_view what, remedy;
};

using namespace std::string_view_literals;

constexpr std::array kKinds{
    Kind{"#ROSBAG V"sv, 0, "this is a bag of ROS 1, not an MCAP file", kConvertBag},
    Kind{"SQLite format 3\0"sv, 0, "this is a database (SQLite; rosbag2 writes .db3 files), not an MCAP file", kConvertDatabase},
    Kind{"\x1f\x8b"sv, 0, "this file is compressed with gzip", "Unpack it first: `gunzip FILE`."},
    Kind{"\xfd"
         "7zXZ\0"sv,
         0, "this file is compressed with xz", "Unpack it first: `xz -d FILE`."},
    Kind{"BZh"sv, 0, "this file is compressed with bzip2", "Unpack it first: `bunzip2 FILE`."},
    Kind{"[Content_Types].xml"sv, 30, "this is a spreadsheet (xlsx), not an MCAP file", kSpreadsheet},
    Kind{"\xd0\xcf\x11\xe0"sv, 0, "this is a spreadsheet (xls), not an MCAP file", kSpreadsheet},
    Kind{"PK\x03\x04"sv, 0, "this is a zip archive", "Unpack it first: `unzip FILE`."},
    Kind{"7z\xbc\xaf\x27\x1c"sv, 0, "this is a 7z archive", "Unpack it first: `7z x FILE`."},
    Kind{"ustar"sv, 257, "this is a tar archive", "Unpack it first: `tar -xf FILE`."},
    Kind{
        "\x89HDF\r\n\x1a\n"sv, 0, "this is an HDF5 file, not an MCAP file",
        "`python3 -c \"import h5py, numpy; numpy.savetxt('table.csv', h5py.File('FILE')['NAME'], delimiter=',')\"`, then `tactus "
        "import csv table.csv`."},
    Kind{"\x93NUMPY"sv, 0, "this is an array of NumPy, not an MCAP file",
         "`python3 -c \"import numpy; numpy.savetxt('table.csv', numpy.load('FILE'), delimiter=',', header='time,x,y,z', "
         "comments='')\"` with the names of its columns, then `tactus import csv table.csv`."},
    Kind{"MATLAB "sv, 0, "this is a MAT-file of MATLAB, not an MCAP file",
         "Write its columns as a table, in MATLAB `writematrix(x, 'table.csv')`, then `tactus import csv table.csv`."},
    Kind{"PAR1"sv, 0, "this is a Parquet file, not an MCAP file", kDataFrame},
    Kind{"TDSm"sv, 0, "this is a TDMS file of LabVIEW, not an MCAP file",
         "`python3 -c \"import nptdms; nptdms.TdmsFile.read('FILE').as_dataframe().to_csv('table.csv')\"`, then `tactus import "
         "csv "
         "table.csv`."},
    Kind{"\x02\x50"sv, 0, "this is a C3D file of motion capture, not an MCAP file",
         "Write it as a table with `c3d2csv FILE` of the Python package c3d, then `tactus import csv`."},
    Kind{"ULog\x01\x12\x35"sv, 0, "this is a ULog of PX4, not an MCAP file",
         "Write it as tables with `ulog2csv FILE`, then `tactus import csv`."},
    Kind{"\x89"
         "TCT"sv,
         0, "this is a Tactus stream, not a trace", "Decode it first: `tactus decode FILE -o trace.mcap`."},
    Kind{"\x7f"
         "ELF"sv,
         0, "this is a program, not an MCAP file", "Give the recording itself."},
};

constexpr const char* kRecord =
    "Record topics of poses, transforms, odometry or wrenches: `ros2 bag record -s mcap /tf /tf_static /TOPIC`.";

Diagnostic error(Errc code, RuleName rule, std::string_view what, std::string remedy) {
  return {.error = fail(code, rule).value(), .cause = std::string(what), .remedy = std::move(remedy)};
}

/// Neither a shell nor Python reads anything into it: only such a name may stand in a command that somebody copies.
bool is_safe_in_a_command(std::string_view path) {
  const auto is_safe = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '_' || c == '-' ||
           c == '/';
  };
  return !path.empty() && path.front() != '-' && std::all_of(path.begin(), path.end(), is_safe);
}

std::string with_name(std::string_view remedy, const std::string& path) {
  std::string text(remedy);
  const auto at = text.find("FILE");
  if (at != std::string::npos && is_safe_in_a_command(path)) text.replace(at, 4, path);
  if (text.find("`tactus import csv") != std::string::npos)
    text += " It wants to know the columns: `--time NAME --map position=X,Y,Z -o trace.mcap`.";
  return text;
}

/// "/a, /b and 3 more"
std::string list_of(const std::set<std::string>& topics) {
  constexpr std::size_t kMost = 4;
  std::string text;
  std::size_t count = 0;
  for (const std::string& topic : topics) {
    if (count == kMost) return text + " and " + std::to_string(topics.size() - kMost) + " more";
    text += (count++ > 0 ? ", " : "") + shown(topic);
  }
  return text;
}

}  // namespace

Diagnostic not_mcap(std::span<const std::uint8_t> first, const std::string& path) {
  const std::string_view text(reinterpret_cast<const char*>(first.data()), first.size());
  if (text.empty())
    return error(Errc::truncated, "R-TRC-3", "the file is empty", "Copy it again from its source, or record it again.");
  const std::string_view magic(reinterpret_cast<const char*>(mcap::kMagic.data()), mcap::kMagic.size());
  if (magic.starts_with(text)) return error(Errc::truncated, "R-TRC-3", "the file ends within its first bytes", "");
  if (text.starts_with(magic.substr(0, 5)) && text.size() > 5 && text[5] != '0')
    return error(Errc::unsupported, "R-TRC-7", "this is MCAP of a later major version",
                 "Convert it with the tool that wrote it to version 0.");
  for (const Kind& kind : kKinds) {
    if (text.size() < kind.offset || !text.substr(kind.offset).starts_with(kind.magic)) continue;
    return error(Errc::unsupported, "R-TRC-2", kind.what, with_name(kind.remedy, path));
  }
  if (std::all_of(text.begin(), text.end(), [](char c) { return c == '\0'; }))
    return error(Errc::malformed, "R-TRC-2", "the file begins with zeros: it was never written, or is damaged",
                 "Copy it again from its source.");
  const auto begin = text.find_first_not_of(" \t\r\n");
  const bool is_text = std::all_of(text.begin(), text.end(), [](char c) {
    return static_cast<unsigned char>(c) >= 0x20 || c == '\t' || c == '\r' || c == '\n';
  });
  const bool is_utf16 = text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff");
  if (!is_utf16 && (!is_text || begin == std::string_view::npos)) return error(Errc::malformed, "R-TRC-2", "", "");
  if (text[begin] == '{' || text[begin] == '[')
    return error(Errc::unsupported, "R-TRC-2", "this is JSON, not an MCAP file",
                 with_name("Write its numbers as a table and read that: `tactus import csv`.", path));
  if (text[begin] == '<')
    return error(Errc::unsupported, "R-TRC-2", "this is XML or HTML, not an MCAP file; a download may have failed",
                 "Copy it again from its source.");
  return error(Errc::unsupported, "R-TRC-2", "this is a text file, not an MCAP file",
               with_name("If it is a table, read it with `tactus import csv FILE`.", path));
}

Diagnostic nothing_of_use(const std::map<std::uint16_t, mcap::Schema>& schemas,
                          const std::map<std::uint16_t, mcap::Channel>& channels, const std::string& path) {
  std::map<std::string, std::set<std::string>> by_encoding;
  std::set<std::string> types;
  for (const auto& [id, channel] : channels) {
    by_encoding[channel.message_encoding].insert(channel.topic);
    const auto schema = schemas.find(channel.schema_id);
    if (channel.message_encoding == "cdr" && schema != schemas.end()) types.insert(schema->second.name);
  }
  if (by_encoding.empty()) return error(Errc::unsupported, "R-TRC-16", "the file has no topics", kRecord);
  std::string holds;
  for (const auto& [encoding, topics] : by_encoding)
    holds += (holds.empty() ? "" : "; ") + (encoding.empty() ? "no encoding" : shown(encoding)) + ": " + list_of(topics);
  if (by_encoding.contains("cdr")) {
    return error(Errc::unsupported, "R-TRC-16",
                 "no topic has poses, transforms or forces (" + holds + "); of ROS 2 it holds " + list_of(types), kRecord);
  }
  const std::string what = "no topic has messages of ROS 2 (" + holds + ")";
  if (by_encoding.contains("ros1"))
    return error(Errc::unsupported, "R-TRC-7", what,
                 with_name("Its messages are of ROS 1. Convert the bag it was made of. " + std::string(kConvertBag), ""));
  return error(
      Errc::unsupported, "R-TRC-7", what,
      with_name("Write the poses as a table (`mcap cat FILE --json` gives the messages as text), then `tactus import csv`.",
                path));
}

}  // namespace tactus
