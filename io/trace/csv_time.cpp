// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/csv_time.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <utility>

#include <tactus/base/text.h>

namespace tactus {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

bool is_digit(char c) noexcept { return c >= '0' && c <= '9'; }

/// Take `count` digits from the front.
std::optional<std::int64_t> take_digits(std::string_view& text, std::size_t count) noexcept {
  if (text.size() < count) return std::nullopt;
  std::int64_t value = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (!is_digit(text[i])) return std::nullopt;
    value = 10 * value + (text[i] - '0');
  }
  text.remove_prefix(count);
  return value;
}

bool take(std::string_view& text, std::string_view any) noexcept {
  if (text.empty() || any.find(text[0]) == std::string_view::npos) return false;
  text.remove_prefix(1);
  return true;
}

/// [ns] ".123456789", digits beyond are dropped.
std::int64_t take_fraction(std::string_view& text) noexcept {
  if (text.size() < 2 || (text[0] != '.' && text[0] != ',') || !is_digit(text[1])) return 0;
  text.remove_prefix(1);
  std::int64_t value = 0, weight = kSecond / 10;
  for (; !text.empty() && is_digit(text[0]); text.remove_prefix(1), weight /= 10) value += weight * (text[0] - '0');
  return value;
}

/// [ns] "12:00:00.5", "12:00:00:500", "1:00:00.5 PM" or, of minutes, "59:30.5" at the front.
std::optional<std::int64_t> take_clock(std::string_view& text) noexcept {
  const std::size_t digits = text.size() > 1 && text[1] == ':' ? 1 : 2;
  auto hours = take_digits(text, digits);
  if (!hours || !take(text, ":")) return std::nullopt;
  auto minutes = take_digits(text, 2);
  std::optional<std::int64_t> seconds;
  if (minutes && !text.empty() && (text[0] == '.' || text[0] == ',')) seconds = std::exchange(minutes, std::exchange(hours, 0));
  else if (!minutes || !take(text, ":") || !(seconds = take_digits(text, 2))) return std::nullopt;
  if (*hours > 24 || *minutes > 59 || *seconds > 60) return std::nullopt;
  std::int64_t fraction = take_fraction(text);
  if (text.size() >= 4 && text[0] == ':') {
    text.remove_prefix(1);
    const auto milliseconds = take_digits(text, 3);
    if (!milliseconds || (!text.empty() && is_digit(text[0]))) return std::nullopt;
    fraction = *milliseconds * 1'000'000;
  }
  std::string_view half = text;
  take(half, " ");
  const bool is_after = half.size() >= 2 && (half[0] == 'P' || half[0] == 'p'),
             is_half = half.size() >= 2 && (is_after || half[0] == 'A' || half[0] == 'a') && (half[1] == 'M' || half[1] == 'm');
  if (is_half) {
    if (*hours < 1 || *hours > 12) return std::nullopt;
    *hours = *hours % 12 + (is_after ? 12 : 0);
    text = half.substr(2);
  }
  return (*hours * 3600 + *minutes * 60 + *seconds) * kSecond + fraction;
}

/// [ns] east of UTC; no zone is UTC.
std::optional<std::int64_t> take_zone(std::string_view& text) noexcept {
  if (text.empty() || take(text, "Zz")) return 0;
  const bool is_west = text[0] == '-';
  if (!take(text, "+-")) return std::nullopt;
  const auto hours = take_digits(text, 2);
  if (!hours) return std::nullopt;
  take(text, ":");
  const auto minutes = text.empty() ? std::optional<std::int64_t>(0) : take_digits(text, 2);
  if (!minutes) return std::nullopt;
  return (is_west ? -1 : 1) * (*hours * 3600 + *minutes * 60) * kSecond;
}

/// One to `most` digits.
std::optional<std::int64_t> take_number(std::string_view& text, std::size_t most) noexcept {
  std::size_t count = 0;
  while (count < most && count < text.size() && is_digit(text[count])) ++count;
  return count == 0 ? std::nullopt : take_digits(text, count);
}

/// 1 for "Jan".
std::optional<std::int64_t> take_month_name(std::string_view& text) noexcept {
  constexpr std::string_view kNames = "janfebmaraprmayjunjulaugsepoctnovdec";
  if (text.size() < 3) return std::nullopt;
  std::array<char, 3> name{};
  for (std::size_t i = 0; i < 3; ++i) name[i] = static_cast<char>(text[i] | 0x20);
  const std::size_t at = kNames.find(std::string_view(name.data(), 3));
  if (at == std::string_view::npos || at % 3 != 0) return std::nullopt;
  text.remove_prefix(3);
  return static_cast<std::int64_t>(at / 3 + 1);
}

/// "2024-05-01", "2024/5/1", "1.5.2024", "13/05/2024", "01-May-2024" at the front.
std::optional<std::chrono::year_month_day> take_date(std::string_view& text, DateOrder order) noexcept {
  const bool begins_with_year = text.find_first_not_of("0123456789") == 4;
  const auto first = take_number(text, 4);
  if (!first || text.empty()) return std::nullopt;
  const char mark = text[0];
  if (!take(text, "-/.")) return std::nullopt;
  const auto name = take_month_name(text);
  const auto second = name ? name : take_number(text, 2);
  if (!second || text.empty() || text[0] != mark) return std::nullopt;
  text.remove_prefix(1);
  const auto third = take_number(text, 4);
  if (!third) return std::nullopt;
  std::int64_t year = *first, month = *second, day = *third;
  if (!begins_with_year) {
    year = *third < 100 ? *third + 2000 : *third;
    day = *first;
    if (mark != '.' && !name) {  // 05/06/2024
      const bool is_open = *first <= 12 && *second <= 12 && *first != *second;
      if (is_open && order == DateOrder::by_digits) return std::nullopt;
      const bool is_month_first = *second > 12 || (is_open && order == DateOrder::mdy);
      if (is_month_first) month = *first, day = *second;
    }
  }
  if (year < 1700 || year > 2250 || month > 12 || day > 31) return std::nullopt;
  const std::chrono::year_month_day date{std::chrono::year(static_cast<int>(year)),
                                         std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day))};
  return date.ok() ? std::optional(date) : std::nullopt;  // no 30 February
}

std::optional<CsvTime> parse_date(std::string_view text, DateOrder order) noexcept {
  const auto date = take_date(text, order);
  if (!date) return std::nullopt;
  take(text, ",");
  if (!take(text, "Tt _")) return std::nullopt;
  const auto clock = take_clock(text);
  if (!clock) return std::nullopt;
  if (!text.empty() && text[0] == ' ') text.remove_prefix(1);
  const auto zone = take_zone(text);
  if (!zone || !text.empty()) return std::nullopt;
  return CsvTime{std::chrono::nanoseconds(std::chrono::sys_days(*date).time_since_epoch()).count() + *clock - *zone,
                 CsvTimeKind::date};
}

/// Days of 1970 in the count of Excel or MATLAB that this number can be of; 0: of none.
std::int64_t epoch_of_days(std::string_view text) noexcept {
  constexpr std::int64_t kExcel = 25569, kMatlab = 719529;
  const auto days = parse_number<double>(text);
  if (!days) return 0;
  if (*days > kMatlab && *days < kMatlab + 50000) return kMatlab;
  return *days > kExcel && *days < kExcel + 50000 ? kExcel : 0;
}

/// Digits with at most one point, exactly; nothing: not of that form, or too large.
/// in  epoch  [units] is subtracted
std::optional<std::int64_t> exact_decimal(std::string_view text, std::int64_t unit, std::int64_t epoch) noexcept {
  const bool is_negative = text.starts_with('-');
  if (is_negative || text.starts_with('+')) text.remove_prefix(1);
  constexpr std::size_t kMost = 19;
  const std::size_t point = std::min(text.find('.'), text.size());
  if (text.empty() || point > kMost || (point == 0 && text.size() == 1)) return std::nullopt;
  __extension__ using Wide = __int128;
  Wide value = 0;
  std::size_t at = 0;
  for (; at < point; ++at) {
    if (!is_digit(text[at])) return std::nullopt;
    value = 10 * value + (text[at] - '0');
  }
  value *= unit;
  Wide rest = 0, weight = 1;
  for (++at; at < text.size(); ++at) {
    if (!is_digit(text[at])) return std::nullopt;
    if (weight >= Wide{1'000'000'000'000'000}) continue;
    rest = 10 * rest + (text[at] - '0');
    weight *= 10;
  }
  value += (rest * unit + weight / 2) / weight - Wide{epoch} * unit;
  if (value > INT64_MAX / 2) return std::nullopt;
  return static_cast<std::int64_t>(is_negative ? -value : value);
}

}  // namespace

std::optional<CsvTime> parse_csv_time(std::string_view text, std::int64_t unit, DateOrder order) noexcept {
  const std::int64_t epoch = unit == kDayUnit ? epoch_of_days(text) : 0;
  if (const auto exact = exact_decimal(text, unit, epoch))
    return CsvTime{*exact, epoch == 0 ? CsvTimeKind::number : CsvTimeKind::date};
  if (text.find(':') != std::string_view::npos) {
    if (const auto date = parse_date(text, order)) return date;
    const auto clock = take_clock(text);
    return clock && text.empty() ? std::optional(CsvTime{*clock, CsvTimeKind::clock}) : std::nullopt;
  }
  const auto number = parse_number<double>(text);  // with an exponent
  if (!number || !(std::abs(*number - static_cast<double>(epoch)) * static_cast<double>(unit) < 4.6e18)) return std::nullopt;
  return CsvTime{std::llround((*number - static_cast<double>(epoch)) * static_cast<double>(unit)),
                 epoch == 0 ? CsvTimeKind::number : CsvTimeKind::date};
}

std::optional<std::int64_t> unit_of_epoch(std::string_view text) noexcept {
  const auto number = parse_number<double>(text);
  if (!number) return std::nullopt;
  for (const std::int64_t unit : {std::int64_t{1}, std::int64_t{1'000}, std::int64_t{1'000'000}, kSecond}) {
    const double seconds = *number * (static_cast<double>(unit) / 1e9);
    if (seconds > 3.15e8 && seconds < 4.1e9) return unit;
  }
  return std::nullopt;
}

std::string date_text(std::int64_t nanoseconds) {
  const std::chrono::sys_time<std::chrono::nanoseconds> time{std::chrono::nanoseconds(nanoseconds)};
  const auto day = std::chrono::floor<std::chrono::days>(time);
  const std::chrono::year_month_day date(day);
  const std::chrono::hh_mm_ss clock(std::chrono::floor<std::chrono::seconds>(time - day));
  std::array<char, 80> text{};
  std::snprintf(text.data(), text.size(), "%04d-%02u-%02u %02d:%02d:%02d UTC", static_cast<int>(date.year()),
                static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()), static_cast<int>(clock.hours().count()),
                static_cast<int>(clock.minutes().count()), static_cast<int>(clock.seconds().count()));
  return text.data();
}

std::string number_text(double value, const char* form) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), form, value);
  return text.data();
}

}  // namespace tactus
