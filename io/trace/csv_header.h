// SPDX-License-Identifier: Apache-2.0
/// What stands ahead of the values of a table: names in one or several lines, a line of units, a preamble, or nothing. Internal to the
/// library.
///
/// Values begin at the first line of which more than half of the fields are numbers, times or missing. The names are in the lines above it
/// that have as many fields; the lowest of them holds units if it has nothing else. Where the lowest line of names has one twice, the
/// lines above it are put in front of its names (an empty field there means the one before it). Without any such line the last comment holds the names,
/// if it has as many fields; else columns have numbers only.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <tactus/trace/csv.h>
#include <tactus/trace/read_notes.h>

namespace tactus {

struct CsvLine {
  std::uint64_t number = 0;  ///< counts from 1
  std::string text;
  bool is_comment = false;
  bool is_after_blank = false;
  bool is_open = false;  ///< the table ends without an end of this line
};

struct CsvHeader {
  std::vector<std::string> names;  ///< of all columns; "#1", "#2" where the table names none
  std::vector<std::string> units;  ///< of a line of units, per column; empty: there is none
  std::string length_unit;         ///< of all lengths, from the preamble; may be empty
  std::uint64_t line = 0;          ///< of the names; 0: none
  std::size_t values = 0;          ///< the line among those given where values begin
  char separator = ',';
  ReadNotes notes;
};

/// Lines that find_header() wants to see at most.
inline constexpr std::size_t kHeaderLines = 100;

/// in  lines  first lines of a table that are not blank
CsvHeader find_header(std::span<const CsvLine> lines, CsvNames names);

}  // namespace tactus
