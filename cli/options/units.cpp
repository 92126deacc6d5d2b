// SPDX-License-Identifier: Apache-2.0
#include "cli/options/units.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <span>

namespace tactus::cli {
namespace {

struct Unit {
  std::string_view name;
  double factor;
};

constexpr std::array<Unit, 4> kLengths{{{"m", 1}, {"cm", 1e-2}, {"mm", 1e-3}, {"um", 1e-6}}};
constexpr std::array<Unit, 3> kAngles{{{"deg", std::numbers::pi / 180}, {"rad", 1}, {"mrad", 1e-3}}};
constexpr std::array<Unit, 4> kTimes{{{"s", 1}, {"ms", 1e-3}, {"us", 1e-6}, {"min", 60}}};
constexpr std::array<Unit, 2> kForces{{{"N", 1}, {"mN", 1e-3}}};
constexpr std::array<Unit, 1> kFractions{{{"%", 1e-2}}};

std::span<const Unit> units_of(Dimension dimension) {
  switch (dimension) {
    case Dimension::length:
      return kLengths;
    case Dimension::angle:
      return kAngles;
    case Dimension::time:
      return kTimes;
    case Dimension::force:
      return kForces;
    case Dimension::fraction:
      return kFractions;
  }
  return {};
}

const char* type_name(Dimension dimension) {
  switch (dimension) {
    case Dimension::length:
      return "LENGTH";
    case Dimension::angle:
      return "ANGLE";
    case Dimension::time:
      return "TIME";
    case Dimension::force:
      return "FORCE";
    case Dimension::fraction:
      return "FRACTION";
  }
  return "";
}

std::string list(std::span<const Unit> units) {
  std::string text;
  for (std::size_t i = 0; i < units.size(); ++i) {
    text += i == 0 ? "" : i + 1 == units.size() ? " or " : ", ";
    text += units[i].name;
  }
  return text;
}

template <class T>
T or_usage_error(const std::string& option, tl::expected<T, std::string> parsed) {
  if (!parsed) refuse_option(option, parsed.error());
  return *parsed;
}

/// A fraction is at most 1: a bare 4 is meant as 4 %, which it is not.
tl::expected<Quantity, std::string> checked(std::string_view text, const Quantity& quantity, Dimension dimension) {
  if (!std::isfinite(quantity.value)) return tl::unexpected(fmt::format("'{}': too large", text));
  if (dimension != Dimension::fraction || quantity.value <= 1) return quantity;
  return tl::unexpected(fmt::format("'{}': must be at most 100 %; four percent is 4% or 0.04", text));
}

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(' ');
  return first == std::string_view::npos ? std::string_view() : text.substr(first, text.find_last_not_of(' ') - first + 1);
}

const char* noun(Dimension dimension) {
  switch (dimension) {
    case Dimension::length:
      return "a length";
    case Dimension::angle:
      return "an angle";
    case Dimension::time:
      return "a time";
    case Dimension::force:
      return "a force";
    case Dimension::fraction:
      return "a fraction";
  }
  return "";
}

bool is_clear_without_unit(double number, Dimension dimension) {
  return number == 0 || dimension == Dimension::force || dimension == Dimension::fraction;
}

/// "-p,--deadband" is called "--deadband" in messages.
std::string long_name(const std::string& names) { return names.substr(names.rfind(',') + 1); }

}  // namespace

std::string needs_unit(std::string_view text, Dimension dimension) {
  return fmt::format("'{}': {} needs its unit: {}", text, noun(dimension), list(units_of(dimension)));
}

tl::expected<Quantity, std::string> parse_quantity(std::string_view typed, Dimension dimension, Bare bare) {
  const std::string_view text = trimmed(typed);
  const auto units = units_of(dimension);
  double number = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (status != std::errc() || !std::isfinite(number)) {
    return tl::unexpected(fmt::format("'{}': not a number with a unit ({})", text, list(units)));
  }
  if (number < 0) return tl::unexpected(fmt::format("'{}': must not be negative", text));
  const std::string_view suffix = trimmed({end, static_cast<std::size_t>(text.data() + text.size() - end)});
  if (suffix.empty()) {
    if (bare == Bare::refused && !is_clear_without_unit(number, dimension)) return tl::unexpected(needs_unit(text, dimension));
    return checked(text, {number, true}, dimension);
  }
  for (const Unit& unit : units) {
    if (unit.name == suffix) return checked(text, {number * unit.factor, false}, dimension);
  }
  return tl::unexpected(fmt::format("'{}': unknown unit '{}'; use {}", text, suffix, list(units)));
}

tl::expected<PoseBound, std::string> parse_pose_bound(std::string_view text) {
  const std::size_t comma = text.find(',');
  if (comma == std::string_view::npos)
    return tl::unexpected(fmt::format("'{}': give a length and an angle, such as 0.3mm,2deg", text));
  TACTUS_TRY(const auto length, parse_quantity(text.substr(0, comma), Dimension::length, Bare::allowed));
  TACTUS_TRY(const auto angle, parse_quantity(text.substr(comma + 1), Dimension::angle));
  return PoseBound{length, angle};
}

Option* add_quantity(Command& app, const std::string& name, double& value, Dimension dimension, const std::string& help) {
  const auto read = [&value, dimension, name](const std::string& text) {
    value = or_usage_error(long_name(name), parse_quantity(text, dimension)).value;
  };
  return app.add_option(name, read, help)->type_name(type_name(dimension));
}

Check within(Dimension dimension, const std::string& low, const std::string& high) {
  const double least = parse_quantity(low, dimension)->value, most = parse_quantity(high, dimension)->value;
  const auto look = [=](const std::string& text) {
    const auto typed = parse_quantity(text, dimension);
    if (!typed) return typed.error();
    return typed->value < least || typed->value > most ? fmt::format("'{}': must be from {} to {}", text, low, high) : "";
  };
  return Check(look, fmt::format("{} to {}", low, high));
}

Check above_zero(Dimension dimension) {
  const auto look = [=](const std::string& text) {
    const auto typed = parse_quantity(text, dimension);
    if (!typed) return typed.error();
    return typed->value > 0 ? std::string() : fmt::format("'{}': must be above 0", text);
  };
  return Check(look, "above 0");
}

Option* add_pose_bound(Command& app, const std::string& name, PoseBound& value, const std::string& help) {
  const auto read = [&value, name](const std::string& text) { value = or_usage_error(long_name(name), parse_pose_bound(text)); };
  return app.add_option(name, read, help)->type_name("LENGTH,ANGLE");
}

}  // namespace tactus::cli
