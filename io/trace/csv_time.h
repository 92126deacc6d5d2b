// SPDX-License-Identifier: Apache-2.0
/// Times of a table, without loss: numbers in a unit, dates and times of day. Internal to the library.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace tactus {

enum class CsvTimeKind : std::uint8_t { number, date, clock };

struct CsvTime {
  std::int64_t nanoseconds = 0;  ///< of a number: since the table's own 0; of a date: since 1970 UTC; of a clock: since midnight
  CsvTimeKind kind = CsvTimeKind::number;
};

enum class DateOrder : std::uint8_t { by_digits, mdy, dmy };  ///< of 05/06/2024; by_digits: that is no time, 25/06/2024 is

inline constexpr std::int64_t kDayUnit = 86'400'000'000'000;  ///< [ns]

/// "1403636579763555584", "0.001", "2024-05-01T12:00:00.123456789Z" (a space for the T, +02:00 for the Z, or no zone), "1.5.2024 12:00:00",
/// "01-May-2024 12:00:00", "5/13/2024 1:00:00 PM", "12:00:00.123", "59:30.5" (minutes). Numbers of days are those of Excel (since 1899-12-30) and MATLAB
/// (datenum) where they are that large.
/// in   unit  [ns] of a number; 1e-9 s to 1 day     out  nothing: it is no time, or beyond what 64 bits of nanoseconds hold
std::optional<CsvTime> parse_csv_time(std::string_view text, std::int64_t unit, DateOrder order = DateOrder::by_digits) noexcept;

/// [ns] The unit by which a number can be a time since 1970 within the years 1980 to 2100; nothing: by none.
std::optional<std::int64_t> unit_of_epoch(std::string_view text) noexcept;

/// "2023-11-14 22:13:20 UTC" of nanoseconds since 1970.
std::string date_text(std::int64_t nanoseconds);

std::string number_text(double value, const char* form = "%.6g");

}  // namespace tactus
