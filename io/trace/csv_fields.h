// SPDX-License-Identifier: Apache-2.0
/// Fields of a line of a table: what separates them, quotes, decimal commas, and words that say that a value is missing. Internal to the
/// library.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tactus {

inline constexpr char kBlanks = ' ';        ///< as a separator: any number of blanks and tabs
inline constexpr char kEdgedBars = '\x1D';  ///< as a separator: bars, and one at each end of the line, as in Markdown
inline constexpr std::string_view kCsvSeparators = ",;\t \x1D|";  ///< the likelier one first

/// Numbers in quotes whose comma was taken for the decimal point.
struct PointedFields {
  std::size_t count = 0;
  std::size_t open = 0;  ///< of them those as "1,000", which may be thousands
};

std::string_view trim_field(std::string_view text) noexcept;

/// Split a line (RFC 4180 quoting, no line breaks inside quotes) into `fields`, whose strings are reused. Where the separator is no comma,
/// "1,5" becomes "1.5"; where it is one, only inside quotes.   out  of the fields that got a point so although commas separate
PointedFields split_fields(std::string_view line, char separator, std::vector<std::string>& fields);

/// Says that there is no value: nothing at all, -, NA, NaN, inf, null and the like.
bool is_missing_word(std::string_view text) noexcept;
/// A number, or a time of day or a date: what stands in rows, not in names.
bool is_value(std::string_view text);

/// A text as a field: in quotes when it needs them.
std::string csv_field(std::string_view text);

}  // namespace tactus
