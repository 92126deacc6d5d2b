// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/trace_capture.h>

#include <gtest/gtest.h>

#include <array>

#include <tactus/trace/csv.h>
#include "tests/unit/trace_fixture.h"

namespace tactus {
namespace {

TraceCapture some_capture() {
  return {.started = 1'790'000'000'123'456'789,
          .device = "Falcon 17",
          .backend = "falcon",
          .scheduling = "real-time priority",
          .subject = "7",
          .remarks = "left hand\ntired"};
}

/// What a capture holds beside the rest.
Recording make_capture(std::size_t frames) {
  Recording recording = make_recording(frames);
  recording.info.capture = some_capture();
  recording.info.users[0].has_servo = true;
  recording.info.users[0].report_descriptor = {0x05, 0x0d, 0xff, 0x00, 0xa0};
  for (std::size_t i = 0; i < frames; ++i) {
    recording.frames[i].users[0].servo = {static_cast<std::int64_t>(1000 * i), static_cast<std::int64_t>(7 * i), i == 3 ? 3U : 0U,
                                          static_cast<std::uint32_t>(i % 64)};
    for (std::size_t k = 0; k < i % 4; ++k) {
      DeviceReports& reports = recording.frames[i].users[0].reports;
      reports.sizes.push_back(static_cast<std::uint32_t>(1 + k));
      reports.bytes.insert(reports.bytes.end(), 1 + k, static_cast<std::uint8_t>(17 * i + k));
    }
    if (i % 5 == 2) recording.frames[i].marker = "mark \xC3\xA4 " + std::to_string(i);
  }
  return recording;
}

TEST(TraceCapture, EntriesGiveItBack) { EXPECT_EQ(capture_from(entries_of(some_capture())), some_capture()); }

TEST(TraceCapture, EveryEntryIsNeededAndChecked) {
  const mcap::TextMap whole = entries_of(some_capture());
  for (const auto& [key, text] : whole) {
    mcap::TextMap less = whole;
    less.erase(key);
    EXPECT_FALSE(capture_from(less)) << key;
  }
  for (const char* started : {"", "-1", "x", "1.5", "9999999999999999999999"}) {
    mcap::TextMap wrong = whole;
    wrong["started_ns"] = started;
    EXPECT_FALSE(capture_from(wrong)) << started;
  }
  mcap::TextMap wrong = whole;
  wrong["subject"] = "\xff";
  EXPECT_FALSE(capture_from(wrong));
}

TEST(TraceCapture, TracesKeepIt) {
  const TempFile file;
  const Recording written = make_capture(40);
  const Bytes bytes = write_recording(written, file.path());
  const auto reader = TraceReader::open_memory(bytes);
  ASSERT_TRUE(reader);
  EXPECT_EQ(reader->info().capture, written.info.capture);
  EXPECT_EQ(reader->info().users, written.info.users);
  const Reading read = read_bytes(bytes);
  ASSERT_FALSE(read.error);
  ASSERT_EQ(read.frames.size(), written.frames.size());
  for (std::size_t i = 0; i < read.frames.size(); ++i) {
    EXPECT_EQ(image(read.frames[i]), image(written.frames[i])) << i;
    EXPECT_EQ(read.frames[i].users[0].reports, written.frames[i].users[0].reports) << i;
  }
}

TEST(TraceCapture, EveryPrefixIsReadOrRefused) {
  const TempFile file;
  const Bytes bytes = write_recording(make_capture(4), file.path());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const Reading read = read_bytes(std::span(bytes).first(size));
    EXPECT_TRUE(read.error || read.cut_short) << size;
  }
}

TEST(TraceCapture, AWriterRefusesWhatAReaderWould) {
  const TempFile file;
  const Recording recording = make_capture(3);
  auto writer = TraceWriter::create(file.path(), recording.info).value();
  TraceFrame frame = recording.frames[0];
  frame.users[0].servo.lateness = -1;
  EXPECT_STREQ(writer.write(frame).error().rule, "R-API-5");
  frame = recording.frames[0];
  frame.users[0].servo.age = -1;
  EXPECT_STREQ(writer.write(frame).error().rule, "R-API-5");
  frame = recording.frames[0];
  frame.marker = "\xff";
  EXPECT_STREQ(writer.write(frame).error().rule, "R-API-5");
  for (const DeviceReports& wrong : {DeviceReports{{2}, {1}}, DeviceReports{{0}, {}}, DeviceReports{{}, {1}}}) {
    frame = recording.frames[0];
    frame.users[0].reports = wrong;
    EXPECT_STREQ(writer.write(frame).error().rule, "R-API-5");
  }
  EXPECT_TRUE(writer.write(recording.frames[0]));
}

TEST(TraceCapture, TablesKeepHowTheTicksWent) {
  const TempFile file, table, again;
  const Recording written = make_capture(20);
  write_recording(written, file.path());
  auto reader = TraceReader::open(file.path()).value();
  {
    std::ofstream out(table.path());
    ASSERT_TRUE(export_csv(reader, out));
  }
  CsvMapping mapping;
  mapping.layout = CsvLayout::tactus;
  const auto imported = import_csv(table.path(), mapping, again.path());
  ASSERT_TRUE(imported);
  const Reading read = read_all(TraceReader::open(again.path()));
  ASSERT_EQ(read.frames.size(), written.frames.size());
  for (std::size_t i = 0; i < read.frames.size(); ++i) {
    EXPECT_EQ(read.frames[i].users[0].servo, written.frames[i].users[0].servo) << i;
    EXPECT_EQ(read.frames[i].users[0].reports, written.frames[i].users[0].reports) << i;
  }
}

TEST(TraceCapture, ATableWithWrongReportsIsRefused) {
  const TempFile file, table, again;
  write_recording(make_capture(3), file.path());
  std::ostringstream out;
  auto reader = TraceReader::open(file.path()).value();
  ASSERT_TRUE(export_csv(reader, out));
  const std::string whole = out.str();
  const std::size_t at = whole.rfind("22 2323");
  ASSERT_NE(at, std::string::npos);
  CsvMapping mapping;
  mapping.layout = CsvLayout::tactus;
  for (const char* wrong : {"2", "22 232", "22  2323", "2x", "22;2323"}) {
    std::ofstream(table.path()) << std::string(whole).replace(at, 7, wrong);
    const auto imported = import_csv(table.path(), mapping, again.path());
    ASSERT_FALSE(imported) << wrong;
    EXPECT_STREQ(imported.error().error.rule, "R-CSV-4") << wrong;
  }
}

}  // namespace
}  // namespace tactus
