// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/csv_time.h>

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>

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

/// [ns] "12:00:00.5" at the front.
std::optional<std::int64_t> take_clock(std::string_view& text) noexcept {
  const std::size_t digits = text.size() > 1 && text[1] == ':' ? 1 : 2;
  const auto hours = take_digits(text, digits);
  if (!hours || !take(text, ":")) return std::nullopt;
  const auto minutes = take_digits(text, 2);
  if (!minutes || !take(text, ":")) return std::nullopt;
  const auto seconds = take_digits(text, 2);
  if (!seconds || *hours > 24 || *minutes > 59 || *seconds > 60) return std::nullopt;
  return (*hours * 3600 + *minutes * 60 + *seconds) * kSecond + take_fraction(text);
}

/// Days since 1970 of a date of the Gregorian calendar.
std::int64_t days_of(std::int64_t year, std::int64_t month, std::int64_t day) noexcept {
  year -= month <= 2;
  const std::int64_t era = year / 400, of_era = year - era * 400;
  const std::int64_t of_year = (153 * (month + (month > 2 ? -3 : 9)) + 2) / 5 + day - 1;
  return era * 146097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719468;
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

std::optional<CsvTime> parse_date(std::string_view text) noexcept {
  const auto year = take_digits(text, 4);
  if (!year || !take(text, "-/")) return std::nullopt;
  const auto month = take_digits(text, 2);
  if (!month || !take(text, "-/")) return std::nullopt;
  const auto day = take_digits(text, 2);
  if (!day || *month < 1 || *month > 12 || *day < 1 || *day > 31 || *year < 1700 || *year > 2250) return std::nullopt;
  if (!take(text, "Tt _")) return std::nullopt;
  const auto clock = take_clock(text);
  if (!clock) return std::nullopt;
  if (!text.empty() && text[0] == ' ') text.remove_prefix(1);
  const auto zone = take_zone(text);
  if (!zone || !text.empty()) return std::nullopt;
  return CsvTime{days_of(*year, *month, *day) * 86400 * kSecond + *clock - *zone, CsvTimeKind::date};
}

/// Digits with at most one point, exactly; nothing: not of that form, or too large.
std::optional<std::int64_t> exact_decimal(std::string_view text, std::int64_t unit) noexcept {
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
  value += (rest * unit + weight / 2) / weight;
  if (value > INT64_MAX / 2) return std::nullopt;
  return static_cast<std::int64_t>(is_negative ? -value : value);
}

}  // namespace

std::optional<CsvTime> parse_csv_time(std::string_view text, std::int64_t unit) noexcept {
  if (const auto exact = exact_decimal(text, unit)) return CsvTime{*exact};
  if (text.size() >= 19 && (text[4] == '-' || text[4] == '/')) return parse_date(text);
  if (text.find(':') != std::string_view::npos) {
    const auto clock = take_clock(text);
    return clock && text.empty() ? std::optional(CsvTime{*clock, CsvTimeKind::clock}) : std::nullopt;
  }
  const auto number = parse_number<double>(text);  // with an exponent
  if (!number || !(std::abs(*number) * static_cast<double>(unit) < 4.6e18)) return std::nullopt;
  return CsvTime{std::llround(*number * static_cast<double>(unit))};
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
  const std::int64_t seconds = nanoseconds / kSecond - (nanoseconds % kSecond < 0 ? 1 : 0);
  const std::int64_t days = seconds / 86400 - (seconds % 86400 < 0 ? 1 : 0), of_day = seconds - days * 86400;
  const std::int64_t shifted = days + 719468, era = (shifted >= 0 ? shifted : shifted - 146096) / 146097,
                     of_era = shifted - era * 146097;
  const std::int64_t year_of_era = (of_era - of_era / 1460 + of_era / 36524 - of_era / 146096) / 365;
  const std::int64_t of_year = of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100),
                     month = (5 * of_year + 2) / 153;
  const std::int64_t calendar = month < 10 ? month + 3 : month - 9;
  std::array<char, 80> text{};
  std::snprintf(text.data(), text.size(), "%04lld-%02lld-%02lld %02lld:%02lld:%02lld UTC",
                static_cast<long long>(year_of_era + era * 400 + (calendar <= 2 ? 1 : 0)), static_cast<long long>(calendar),
                static_cast<long long>(of_year - (153 * month + 2) / 5 + 1), static_cast<long long>(of_day / 3600),
                static_cast<long long>(of_day / 60 % 60), static_cast<long long>(of_day % 60));
  return text.data();
}

}  // namespace tactus
