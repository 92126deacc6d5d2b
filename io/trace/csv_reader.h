// SPDX-License-Identifier: Apache-2.0
/// Rows of a table as text (RFC 4180 quoting, but no line breaks inside quotes), plain or zstd, in bounded memory.
///
/// The line of names tells what separates the fields: of comma, semicolon and tab the one that it has most of, outside quotes. Where that
/// is no comma, numbers may have a decimal comma. Lines that begin with # or % are comments; if there are no other names, the last of
/// those ahead of the numbers holds them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <tactus/base/result.h>
#include <tactus/trace/byte_source.h>
#include <tactus/trace/input_budget.h>

namespace tactus {

class CsvReader {
 public:
  /// err  io R-TRC-1; truncated, malformed R-CSV-1: damaged zstd data; limit_exceeded R-CSV-6: a line over 1 MiB, R-CSV-9
  static Result<CsvReader> open(const std::string& path);
  /// Move on to the line of names; false: there is none.   pre  first call
  Result<bool> names();
  /// Move on to the next line that is neither blank nor a comment; false at the end.
  Result<bool> next();
  /// Of this line; numbers have a decimal point.
  const std::vector<std::string>& fields() const noexcept { return fields_; }
  std::uint64_t line() const noexcept { return line_; }  ///< counts from 1

 private:
  explicit CsvReader(ByteSource source) : source_(std::move(source)) {}
  Result<void> start();
  Result<void> read_raw();
  Result<void> refill();
  Result<std::optional<std::string_view>> next_line();
  Result<std::optional<std::string_view>> next_row();
  void split(std::string_view line);
  bool holds_numbers() const;

  ByteSource source_;
  std::optional<StreamDecompressor> zstd_;
  InputBudget budget_;
  std::vector<std::uint8_t> raw_;  // read but not yet decompressed
  std::string text_;
  std::size_t line_start_ = 0, scanned_ = 0;  // in text_
  bool ended_ = false;
  std::uint64_t line_ = 0;
  char separator_ = ',';
  bool has_names_ = false;
  std::string comment_;  // the last one ahead of the names
  bool holds_ = false;   // held_ is the next line
  std::vector<std::string> fields_, held_;
};

/// A text as a field: in quotes when it needs them.
std::string csv_field(std::string_view text);

}  // namespace tactus
