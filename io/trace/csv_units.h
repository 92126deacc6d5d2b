// SPDX-License-Identifier: Apache-2.0
/// What the names of columns say besides what they name: a unit ("t_ms", "x [mm]", "yaw (deg)"), an axis ("qx", "Rotation W", "pitch").
/// Internal to the library.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace tactus {

enum class CsvDimension : std::uint8_t { length, time, angle, force, speed, angular_speed };

struct CsvUnit {
  std::string_view name;
  CsvDimension dimension;
  double scale;  ///< SI units in one of it
};

/// The unit that all of `text` spells, in brackets or without: "mm", "[mm]", "milliseconds".
std::optional<CsvUnit> unit_of(std::string_view text) noexcept;

struct UnitInName {
  std::optional<CsvUnit> unit;  ///< of the dimension that was asked for
  std::string_view foreign;     ///< in brackets, but no unit of that dimension
};
UnitInName unit_in_name(std::string_view name, CsvDimension dimension) noexcept;

/// "p_x" for "p_x [m]": without what stands in brackets at its end.
std::string_view without_brackets(std::string_view name) noexcept;

/// 'w', 'x', 'y' or 'z' where the name ends with it: "qw", "q_x []", "Rotation Y", "orientation.z"; 0: it does not say. roll, pitch and yaw are x, y and z.
char axis_in_name(std::string_view name) noexcept;

}  // namespace tactus
