// SPDX-License-Identifier: Apache-2.0
/// What a mapping and the names of a table say together: columns, units, order and axes of each quantity. Internal to the library.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <tactus/trace/csv.h>
#include <tactus/trace/csv_header.h>

namespace tactus {

template <class T>
using CsvResult = tl::expected<T, Diagnostic>;

/// A number of a row; no column: 0.
struct CsvNumber {
  std::optional<std::size_t> column;
  double scale = 1;
};

/// What is sampled together: the pose and motion of an object, the probe of a user, or a force.
struct CsvChannel {
  enum class Kind : std::uint8_t { object, device, force };
  enum class Turn : std::uint8_t { none, quaternion, euler, vector, matrix };
  Kind kind = Kind::object;
  std::uint32_t index = 0;              ///< of the object or user
  std::array<CsvNumber, 3> position{};  ///< or force
  Turn turn = Turn::none;
  std::array<CsvNumber, 9> rotation{};  ///< quaternion: w, x, y, z
  enum class Order : std::uint8_t { known, counted, open };
  Order order = Order::known;  ///< of the quaternion; counted: columns end with 0, 1, 2, 3, which mostly are w, x, y, z
  std::array<std::uint8_t, 3> euler_axes{};  ///< in the order of turning about axes of the object
  bool has_velocity = false, has_angular_velocity = false;
  std::array<CsvNumber, 3> velocity{}, angular_velocity{};
};

struct CsvNamedPlan {
  std::vector<std::string> names;    ///< of all columns
  TraceInfo info;                    ///< of a long table without objects and users
  std::vector<CsvChannel> channels;  ///< of a long table: of each object
  std::optional<std::size_t> time, segment, object;
  std::optional<std::size_t> clock;     ///< the time of day of `time`, which is a date
  std::optional<std::size_t> fraction;  ///< is added to `time`
  bool fraction_is_guess = false;       ///< its name alone says so
  std::int64_t fraction_unit = 1;
  std::int64_t time_unit = 1'000'000'000;  ///< [ns]
  bool time_is_stated = false;             ///< by option or name
  bool time_is_clock = false;              ///< kClockUnit
  std::vector<bool> used;                  ///< per column
  ReadNotes notes;
};

/// err  R-CSV-2, R-CSV-8, R-CSV-10, with the offending column
CsvResult<CsvNamedPlan> plan_named_csv(const CsvMapping& mapping, const CsvHeader& header);

}  // namespace tactus
