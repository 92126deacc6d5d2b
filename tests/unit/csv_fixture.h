// SPDX-License-Identifier: Apache-2.0
/// A table as text in, a trace as frames out.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include <tactus/trace/csv.h>
#include "tests/unit/trace_fixture.h"

namespace tactus {

inline void write_table(const std::string& path, std::string_view text) { std::ofstream(path, std::ios::binary) << text; }

struct Imported {
  TraceInfo info;
  std::vector<TraceFrame> frames;
  CsvImport done;
  std::string rule;  // of the error, if there was one
  Diagnostic error;
};

inline Imported import(std::string_view text, const CsvMapping& mapping) {
  const TempFile csv, trace;
  write_table(csv.path(), text);
  const auto done = import_csv(csv.path(), mapping, trace.path());
  Imported outcome;
  if (!done) {
    EXPECT_FALSE(std::filesystem::exists(trace.path()));
    outcome.error = done.error();
    outcome.rule = outcome.error.error.rule;
    return outcome;
  }
  outcome.done = *done;
  auto reader = TraceReader::open(trace.path());
  EXPECT_TRUE(reader);
  outcome.info = reader->info();
  Reading reading = read_all(std::move(reader));
  EXPECT_FALSE(reading.error);
  outcome.frames = std::move(reading.frames);
  return outcome;
}

inline CsvMapping xyz() {
  CsvMapping mapping;
  mapping.position = {"x", "y", "z"};
  mapping.tick_rate = 100;
  return mapping;
}

/// What the notes of an import say, without location.
inline std::vector<std::string> notes_of(const Imported& outcome) {
  std::vector<std::string> out;
  for (const ReadNote& note : outcome.done.notes.all())
    if (note.where.empty()) out.push_back(note.what + (note.count > 1 ? " x" + std::to_string(note.count) : ""));
  return out;
}

}  // namespace tactus
