// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/csv_units.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <numbers>

#include <tactus/trace/csv_fields.h>

namespace tactus {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
using enum CsvDimension;

// The first spelling of each is the one that notes use.
constexpr std::array kUnits{CsvUnit{"m", length, 1},
                            CsvUnit{"cm", length, 1e-2},
                            CsvUnit{"mm", length, 1e-3},
                            CsvUnit{"um", length, 1e-6},
                            CsvUnit{"\xC2\xB5m", length, 1e-6},
                            CsvUnit{"\xCE\xBCm", length, 1e-6},
                            CsvUnit{"km", length, 1e3},
                            CsvUnit{"in", length, 0.0254},
                            CsvUnit{"inch", length, 0.0254},
                            CsvUnit{"inches", length, 0.0254},
                            CsvUnit{"ft", length, 0.3048},
                            CsvUnit{"feet", length, 0.3048},
                            CsvUnit{"meter", length, 1},
                            CsvUnit{"meters", length, 1},
                            CsvUnit{"metre", length, 1},
                            CsvUnit{"metres", length, 1},
                            CsvUnit{"centimeter", length, 1e-2},
                            CsvUnit{"centimeters", length, 1e-2},
                            CsvUnit{"centimetres", length, 1e-2},
                            CsvUnit{"millimeter", length, 1e-3},
                            CsvUnit{"millimeters", length, 1e-3},
                            CsvUnit{"millimetres", length, 1e-3},
                            CsvUnit{"s", time, 1},
                            CsvUnit{"ms", time, 1e-3},
                            CsvUnit{"us", time, 1e-6},
                            CsvUnit{"ns", time, 1e-9},
                            CsvUnit{"min", time, 60},
                            CsvUnit{"\xC2\xB5s", time, 1e-6},
                            CsvUnit{"\xCE\xBCs", time, 1e-6},
                            CsvUnit{"h", time, 3600},
                            CsvUnit{"sec", time, 1},
                            CsvUnit{"secs", time, 1},
                            CsvUnit{"second", time, 1},
                            CsvUnit{"seconds", time, 1},
                            CsvUnit{"msec", time, 1e-3},
                            CsvUnit{"msecs", time, 1e-3},
                            CsvUnit{"millis", time, 1e-3},
                            CsvUnit{"millisecond", time, 1e-3},
                            CsvUnit{"milliseconds", time, 1e-3},
                            CsvUnit{"usec", time, 1e-6},
                            CsvUnit{"usecs", time, 1e-6},
                            CsvUnit{"micros", time, 1e-6},
                            CsvUnit{"microsecond", time, 1e-6},
                            CsvUnit{"microseconds", time, 1e-6},
                            CsvUnit{"nsec", time, 1e-9},
                            CsvUnit{"nsecs", time, 1e-9},
                            CsvUnit{"nanos", time, 1e-9},
                            CsvUnit{"nanosecond", time, 1e-9},
                            CsvUnit{"nanoseconds", time, 1e-9},
                            CsvUnit{"nanosec", time, 1e-9},
                            CsvUnit{"nanosecs", time, 1e-9},
                            CsvUnit{"microsec", time, 1e-6},
                            CsvUnit{"microsecs", time, 1e-6},
                            CsvUnit{"millisec", time, 1e-3},
                            CsvUnit{"millisecs", time, 1e-3},
                            CsvUnit{"day", time, 86400},
                            CsvUnit{"days", time, 86400},
                            CsvUnit{"minutes", time, 60},
                            CsvUnit{"hours", time, 3600},
                            CsvUnit{"rad", angle, 1},
                            CsvUnit{"deg", angle, kDegree},
                            CsvUnit{"\xC2\xB0", angle, kDegree},
                            CsvUnit{"\xB0", angle, kDegree},  // Latin-1
                            CsvUnit{"\xB0/s", angular_speed, kDegree},
                            CsvUnit{"\xB5m", length, 1e-6},
                            CsvUnit{"\xB5s", time, 1e-6},
                            CsvUnit{"degree", angle, kDegree},
                            CsvUnit{"degrees", angle, kDegree},
                            CsvUnit{"radian", angle, 1},
                            CsvUnit{"radians", angle, 1},
                            CsvUnit{"mrad", angle, 1e-3},
                            CsvUnit{"N", force, 1},
                            CsvUnit{"mN", force, 1e-3},
                            CsvUnit{"kN", force, 1e3},
                            CsvUnit{"newton", force, 1},
                            CsvUnit{"newtons", force, 1},
                            CsvUnit{"lbf", force, 4.4482216152605},
                            CsvUnit{"gf", force, 9.80665e-3},
                            CsvUnit{"kgf", force, 9.80665},
                            CsvUnit{"m/s", speed, 1},
                            CsvUnit{"cm/s", speed, 1e-2},
                            CsvUnit{"mm/s", speed, 1e-3},
                            CsvUnit{"km/h", speed, 1 / 3.6},
                            CsvUnit{"mps", speed, 1},
                            CsvUnit{"m_s", speed, 1},
                            CsvUnit{"mm_s", speed, 1e-3},
                            CsvUnit{"cm_s", speed, 1e-2},
                            CsvUnit{"m s^-1", speed, 1},
                            CsvUnit{"m s-1", speed, 1},
                            CsvUnit{"rad s^-1", angular_speed, 1},
                            CsvUnit{"rad s-1", angular_speed, 1},
                            CsvUnit{"rad/s", angular_speed, 1},
                            CsvUnit{"deg/s", angular_speed, kDegree},
                            CsvUnit{"\xC2\xB0/s", angular_speed, kDegree},
                            CsvUnit{"rad_s", angular_speed, 1},
                            CsvUnit{"deg_s", angular_speed, kDegree},
                            CsvUnit{"dps", angular_speed, kDegree},
                            CsvUnit{"mrad/s", angular_speed, 1e-3},
                            CsvUnit{"rpm", angular_speed, std::numbers::pi / 30}};

bool equal(std::string_view a, std::string_view b, bool any_case) noexcept {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](char x, char y) {
    return x == y || (any_case && std::tolower(static_cast<unsigned char>(x)) == std::tolower(static_cast<unsigned char>(y)));
  });
}

/// Where the bracket begins that ends the name.
std::size_t opening(std::string_view name) noexcept {
  if (name.empty()) return std::string_view::npos;
  constexpr std::string_view kOpen = "([{", kClose = ")]}";
  const std::size_t which = kClose.find(name.back());
  return which == std::string_view::npos ? which : name.rfind(kOpen[which]);
}

/// In brackets, but about something else: an index, an axis, nothing.
bool is_no_unit(std::string_view text) noexcept {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  return text.empty() || text == "-" || (text.size() == 1 && (text[0] & 0x80) == 0) || std::ranges::all_of(text, is_digit);
}

std::optional<CsvUnit> of_dimension(std::string_view text, CsvDimension dimension) noexcept {
  const auto unit = unit_of(text);
  return unit && unit->dimension == dimension ? unit : std::nullopt;
}

/// "t_ms", "yaw deg", "vx_mm_s"
std::optional<CsvUnit> unit_at_end(std::string_view name, CsvDimension dimension) noexcept {
  constexpr std::string_view kJoints = "_ .-/";
  const std::size_t last = name.find_last_of(kJoints);
  if (last == std::string_view::npos || last == 0) return std::nullopt;
  const std::size_t second = name.find_last_of(kJoints, last - 1);
  if (second != std::string_view::npos)
    if (const auto unit = of_dimension(name.substr(second + 1), dimension)) return unit;
  const std::string_view end = name.substr(last + 1);
  if (end == "in" || end == "h" || end == "m/s") return std::nullopt;  // words
  return of_dimension(end, dimension);
}

/// "timeMs", "TimeUS", "nanoseconds"
std::optional<CsvUnit> unit_of_time(std::string_view name) noexcept {
  if (const auto unit = of_dimension(name, time)) return unit;
  for (const std::size_t size : {std::size_t{2}, std::size_t{3}, std::size_t{4}, std::size_t{5}}) {
    if (name.size() <= size) break;
    const std::string_view end = name.substr(name.size() - size);
    const char before = name[name.size() - size - 1];
    const bool is_word = end[0] >= 'A' && end[0] <= 'Z' && before >= 'a' && before <= 'z';
    const bool is_stamp = (end == "ms" || end == "us" || end == "ns") && (name.substr(0, name.size() - size).ends_with("time") ||
                                                                          name.substr(0, name.size() - size).ends_with("stamp"));
    if (!is_word && !is_stamp) continue;
    for (const CsvUnit& unit : kUnits)
      if (unit.dimension == time && equal(unit.name, end, true)) return unit;
  }
  return std::nullopt;
}

}  // namespace

std::optional<CsvUnit> unit_of(std::string_view text) noexcept {
  text = trim_field(text);
  if (text.size() >= 2 && opening(text) == 0) text = trim_field(text.substr(1, text.size() - 2));
  for (const CsvUnit& unit : kUnits)
    if (equal(unit.name, text, false)) return unit;
  for (const CsvUnit& unit : kUnits)
    if (unit.name.size() > 2 && equal(unit.name, text, true)) return unit;
  return std::nullopt;
}

UnitInName unit_in_name(std::string_view name, CsvDimension dimension) noexcept {
  name = trim_field(name);
  const std::size_t bracket = opening(name);
  if (bracket != std::string_view::npos) {
    const std::string_view inside = trim_field(name.substr(bracket + 1, name.size() - bracket - 2));
    if (const auto unit = of_dimension(inside, dimension)) return {unit, {}};
    if (!is_no_unit(inside) || unit_of(inside)) return {std::nullopt, inside};
    name = trim_field(name.substr(0, bracket));
  }
  for (const std::string_view joint : {" in ", " / "})
    if (const std::size_t at = name.rfind(joint); at != std::string_view::npos)
      if (const auto unit = of_dimension(name.substr(at + joint.size()), dimension)) return {unit, {}};
  if (const auto unit = unit_at_end(name, dimension)) return {unit, {}};
  return {dimension == time ? unit_of_time(name) : std::nullopt, {}};
}

std::string_view without_brackets(std::string_view name) noexcept {
  const std::size_t bracket = opening(name);
  return bracket == std::string_view::npos || bracket == 0 ? name : trim_field(name.substr(0, bracket));
}

char axis_in_name(std::string_view name) noexcept {
  name = without_brackets(name);
  for (const std::string_view unit : {"_deg", "_rad", "_degrees", "_radians", " deg", " rad"})
    if (name.size() > unit.size() && name.ends_with(unit)) name.remove_suffix(unit.size());
  const auto ends = [&](std::string_view word) {
    return name.size() >= word.size() && equal(name.substr(name.size() - word.size()), word, true);
  };
  if (ends("roll")) return 'x';
  if (ends("pitch")) return 'y';
  if (ends("yaw") || ends("heading")) return 'z';
  if (name.empty()) return 0;
  const char last = static_cast<char>(std::tolower(static_cast<unsigned char>(name.back())));
  if (last < 'w' || last > 'z') return 0;
  if (name.size() == 1) return last;
  const char before = name[name.size() - 2];
  const bool is_capital = name.back() < 'a' && before >= 'a' && before <= 'z';  // "quatX"
  const bool stands_apart = std::string_view("_ .-/:[").find(before) != std::string_view::npos;
  const bool has_letter =
      name.size() == 2 || std::string_view("_ .-/:").find(name[name.size() - 3]) != std::string_view::npos;  // "qx", "pose_qx"
  const bool is_word = ends("quatx") || ends("quaty") || ends("quatz") || ends("quatw") || ends("rotx") || ends("roty") ||
                       ends("rotz") || ends("rotw");
  return is_capital || stands_apart || has_letter || is_word ? last : static_cast<char>(0);
}

}  // namespace tactus
