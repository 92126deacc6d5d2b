// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/csv_fields.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include <tactus/base/text.h>
#include <tactus/trace/csv_time.h>

namespace tactus {
namespace {

constexpr std::string_view kBlankBytes = " \t\r";

/// Append what stands between the quote at the front of `line` and its partner; the result is what follows.
std::string_view unquote(std::string_view line, std::string& field) {
  for (line.remove_prefix(1); !line.empty(); line.remove_prefix(1)) {
    if (line[0] == '"') {
      line.remove_prefix(1);
      if (!line.starts_with('"')) break;  // two quotes are one, inside
    }
    field += line[0];
  }
  return line;
}

/// "1,5" becomes "1.5"; what has both signs, or one twice, is no number.
bool give_point(std::string& field) noexcept {
  const std::size_t comma = field.find(',');
  if (comma == std::string::npos || field.find_first_of(".,", comma + 1) != std::string::npos || field.find('.') < comma)
    return false;
  const auto is_digit = [](char c) { return (c >= '0' && c <= '9') || c == '+' || c == '-'; };
  if (!std::all_of(field.begin(), field.begin() + static_cast<std::ptrdiff_t>(comma), is_digit)) return false;
  field[comma] = '.';
  return true;
}

/// "1.000", which was "1,000"
bool may_be_thousands(std::string_view field) noexcept {
  if (!field.empty() && (field[0] == '-' || field[0] == '+')) field.remove_prefix(1);
  const std::size_t point = field.find('.');
  return point >= 1 && point <= 3 && field[0] != '0' && field.size() == point + 4;
}

std::size_t end_of_field(std::string_view line, char separator) noexcept {
  return std::min(separator == kBlanks ? line.find_first_of(" \t") : line.find(separator == kEdgedBars ? '|' : separator),
                  line.size());
}

bool equals_any_case(std::string_view a, std::string_view b) noexcept {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](char x, char y) { return std::tolower(static_cast<unsigned char>(x)) == y; });
}

}  // namespace

std::string_view trim_field(std::string_view text) noexcept {
  constexpr std::string_view kHard = "\xC2\xA0";
  while (true) {
    const std::size_t before = text.size();
    text.remove_prefix(std::min(text.find_first_not_of(kBlankBytes), text.size()));
    text = text.substr(0, text.find_last_not_of(kBlankBytes) + 1);
    if (text.starts_with(kHard)) text.remove_prefix(kHard.size());
    if (text.ends_with(kHard)) text.remove_suffix(kHard.size());
    if (text.size() == before) return text;
  }
}

PointedFields split_fields(std::string_view line, char separator, std::vector<std::string>& fields) {
  if (separator == kBlanks || separator == kEdgedBars) line = trim_field(line);
  if (separator == kEdgedBars) {
    const bool has_edges = line.size() > 2 && line.starts_with('|') && line.ends_with('|');
    if (has_edges) line = line.substr(1, line.size() - 2);
    else separator = '\0';  // it is no line of such a table
  }
  const std::string_view blank = separator == '\t' ? std::string_view(" ") : kBlankBytes;  // an empty field is one, too
  std::size_t count = 0;
  PointedFields pointed;
  for (bool more = true; more; ++count) {
    if (count == fields.size()) fields.emplace_back();
    std::string& field = fields[count];
    field.clear();
    line.remove_prefix(std::min(line.find_first_not_of(blank), line.size()));
    const bool is_quoted = line.starts_with('"');
    if (is_quoted) line = unquote(line, field);
    const std::size_t end = end_of_field(line, separator);
    field += trim_field(line.substr(0, end));  // after a closing quote nothing should be left; if it is, the field is no number
    if (separator != ',') give_point(field);
    else if (is_quoted && give_point(field)) ++pointed.count, pointed.open += may_be_thousands(field);
    more = end < line.size();
    line.remove_prefix(std::min(end + 1, line.size()));
  }
  fields.resize(count);
  return pointed;
}

bool is_missing_word(std::string_view text) noexcept {
  constexpr std::array<std::string_view, 20> kWords{"-",    "--",   "---",      "na",        "n/a",     "#n/a", "nan",
                                                    "-nan", "+nan", "null",     "none",      "nil",     "nd",   "inf",
                                                    "-inf", "+inf", "infinity", "-infinity", "missing", "<na>"};
  if (text.empty()) return true;
  if (text.size() > 12) return false;
  if (text.starts_with("1.#") || text.starts_with("-1.#") || text.starts_with("-nan(") || text.starts_with("nan(")) return true;
  return std::ranges::any_of(kWords, [&](std::string_view word) { return equals_any_case(text, word); });
}

bool is_value(std::string_view text) {
  if (const auto number = parse_number<double>(text)) return std::isfinite(*number);
  constexpr std::int64_t kSecond = 1'000'000'000;
  const auto is_time = [](std::string_view of) { return parse_csv_time(of, kSecond, DateOrder::mdy).has_value(); };
  return text.find_first_of(":/-.") != std::string_view::npos && (is_time(text) || is_time(std::string(text) + " 00:00:00"));
}

std::string csv_field(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos && trim_field(text) == text) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) quoted.append(c == '"' ? 2 : 1, c);
  return quoted + '"';
}

}  // namespace tactus
