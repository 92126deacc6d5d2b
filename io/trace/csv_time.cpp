// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/csv_time.h>

#include <array>
#include <charconv>
#include <chrono>
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
  if (!day || *year < 1700 || *year > 2250) return std::nullopt;
  const std::chrono::year_month_day date{std::chrono::year(static_cast<int>(*year)),
                                         std::chrono::month(static_cast<unsigned>(*month)),
                                         std::chrono::day(static_cast<unsigned>(*day))};
  if (!date.ok()) return std::nullopt;  // no 30 February
  if (!take(text, "Tt _")) return std::nullopt;
  const auto clock = take_clock(text);
  if (!clock) return std::nullopt;
  if (!text.empty() && text[0] == ' ') text.remove_prefix(1);
  const auto zone = take_zone(text);
  if (!zone || !text.empty()) return std::nullopt;
  return CsvTime{std::chrono::nanoseconds(std::chrono::sys_days(date).time_since_epoch()).count() + *clock - *zone,
                 CsvTimeKind::date};
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

}  // namespace tactus
