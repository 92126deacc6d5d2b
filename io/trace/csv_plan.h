// SPDX-License-Identifier: Apache-2.0
/// Maps the fields of a row to quantities, from a column mapping and a line of names.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <tactus/trace/csv.h>
#include <tactus/trace/frame.h>

namespace tactus {

/// One number of every row.
struct CsvBinding {
  std::size_t column = 0;
  std::uint32_t index = 0;  ///< of the object or the user
  double scale = 1.0;
  double& (*object_field)(RigidSample&) = nullptr;  ///< either this or the next is set
  double& (*user_field)(UserSample&) = nullptr;
};

/// What is no number, and whole numbers of a user, layout `tactus` only.
struct CsvUserColumns {
  std::size_t kind = 0, object = 0;                 ///< of the contact
  std::optional<std::size_t> buttons, time;         ///< of the device
  std::optional<std::array<std::size_t, 4>> servo;  ///< kServoColumns
  std::optional<std::size_t> reports;
};

struct CsvPlan {
  std::vector<std::string> names;  ///< of all columns
  TraceInfo info;                  ///< the rows determine tick rate and degrees of freedom
  std::vector<CsvBinding> bindings;
  std::optional<std::size_t> tick, time, segment, shown;
  std::vector<std::size_t> dof;       ///< per object, layout `tactus` only
  std::vector<CsvUserColumns> users;  ///< per user, likewise
  bool derive_velocity = false, derive_angular_velocity = false;
  bool check_angular_velocity = false;  ///< recorded, with rotations to compare it with
};

/// Location of a field within its line: "column x, 'oops'".   in  either may be empty
std::string place_of_field(const std::string& column, const std::string& text);

/// err  R-CSV-2, R-CSV-8, with the offending column.
tl::expected<CsvPlan, Diagnostic> plan_csv(const CsvMapping& mapping, const std::vector<std::string>& names);

}  // namespace tactus
