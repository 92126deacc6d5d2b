// SPDX-License-Identifier: Apache-2.0
/// Rows of a table as text (RFC 4180 quoting, but no line breaks inside quotes), plain or zstd, in any encoding that text.h knows, in
/// bounded memory.
///
/// Commas, semicolons, tabs or blanks separate the fields; the first values show which (or a line sep=;). Where it is no comma, numbers may have
/// a decimal comma, where it is one, numbers in quotes. A separator at the end of a row is no field. Lines that begin with #, % or // are
/// comments. What stands ahead of the values: csv_header.h.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <tactus/base/result.h>
#include <tactus/base/text.h>
#include <tactus/trace/byte_source.h>
#include <tactus/trace/csv_fields.h>
#include <tactus/trace/csv_header.h>
#include <tactus/trace/input_budget.h>

namespace tactus {

class CsvReader {
 public:
  /// err  io R-TRC-1; truncated, malformed R-CSV-1: damaged zstd data; limit_exceeded R-CSV-6: a line over 1 MiB, R-CSV-9
  static Result<CsvReader> open(const std::string& path, const CsvText& format = {});
  /// What the file is instead of a text: "an Excel workbook, or another zip archive"; empty: a text.
  std::string_view foreign() const noexcept;
  /// Find the names, which are then the fields; false: the table is empty.   pre  first call
  Result<bool> names();
  const CsvHeader& header() const noexcept { return header_; }  ///< valid after names()
  /// Move on to the next line that is neither blank nor a comment; false at the end.
  Result<bool> next();
  /// Of this line; numbers have a decimal point.
  const std::vector<std::string>& fields() const noexcept { return fields_; }
  std::uint64_t line() const noexcept { return line_; }  ///< counts from 1
  bool is_open() const noexcept { return is_open_; }     ///< the table ends within this line, or without an end of it
  std::size_t bytes() const noexcept { return bytes_; }  ///< of this line
  /// Lines that stand ahead of the values, too, and were left out, as where tables are put together; of which the first one.
  std::uint64_t repeated_names() const noexcept { return repeated_names_; }
  std::uint64_t first_repeated() const noexcept { return first_repeated_; }
  const PointedFields& decimal_commas() const noexcept { return decimal_commas_; }  ///< so far
  bool is_after_blank() const noexcept { return is_after_blank_; }                  ///< a blank line stands ahead of this one

 private:
  explicit CsvReader(ByteSource source) : source_(std::move(source)) {}
  Result<void> start(const CsvText& format);
  Result<void> read_raw();
  Result<void> refill();
  Result<std::optional<std::string_view>> next_line();
  Result<std::optional<std::string_view>> next_row();
  Result<bool> look_ahead();
  bool is_name_again(std::string_view line);

  ByteSource source_;
  std::optional<StreamDecompressor> zstd_;
  InputBudget budget_;
  TextDecoder decoder_;
  std::vector<std::uint8_t> raw_, piece_;  // read but not yet decompressed; decompressed
  std::string text_;
  std::size_t line_start_ = 0, scanned_ = 0;  // in text_
  bool ended_ = false, is_open_ = false;
  std::uint64_t line_ = 0, repeated_names_ = 0, first_repeated_ = 0;
  PointedFields decimal_commas_;
  bool is_after_blank_ = false;
  std::size_t bytes_ = 0;
  CsvNames wanted_names_ = CsvNames::automatic;
  CsvHeader header_;
  std::vector<CsvLine> ahead_;  // read to find the names
  std::size_t replayed_ = 0;    // of ahead_
  std::vector<std::string> fields_;
};

}  // namespace tactus
