// SPDX-License-Identifier: Apache-2.0
/// Recordings in text form: import with a column mapping, export of any trace. Decimal point, commas, names in the first line.
///
/// rule     class             broken when
/// R-CSV-1  truncated         the text has no line of names and one of values, or its zstd data ends early
///          malformed         its zstd data is damaged
/// R-CSV-2  malformed         a column of the mapping is not there, or there twice
/// R-CSV-3  malformed         a row has more or fewer fields than there are columns
/// R-CSV-4  malformed         a field is not a finite decimal number, not a whole number in range where one is needed, or no reports
/// R-CSV-5  invalid           time does not increase within a segment by a tick at least, or leaves 0 .. 2^31 s
/// R-CSV-6  limit_exceeded    a line is longer than 1 MiB
/// R-CSV-7  invalid_argument  the rate is unknown: no tick_rate in the mapping and no column of time with two rows
/// R-CSV-8  invalid_argument  the mapping names some columns of a vector but not all, or nothing to record, or angular velocities in the
///                            body frame without rotations
/// R-CSV-9  limit_exceeded    the zstd data unpacks to more than its size has earned (input_budget.h)
#pragma once

#include <array>
#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include <tactus/base/diagnostic.h>
#include <tactus/trace/frame.h>
#include <tactus/trace/trace_file.h>

namespace tactus {

enum class CsvLayout : std::uint8_t {
  named_columns,  ///< one object, one user, columns as the mapping names them
  tactus,         ///< columns of export_csv(): any objects and users; only tick_rate of the mapping is used. A force without
                  ///< columns is not known (KnownForces)
};

/// Frame of the recorded angular velocities. A gyroscope on the object measures in the body frame.
enum class AngularVelocityFrame : std::uint8_t { world, body };

inline constexpr const char* kZeroColumn = "0";  ///< in a vector: a component that the table lacks and that is 0

/// Which column feeds which quantity; an empty name means "not there". Named groups: see csv_presets().
struct CsvMapping {
  CsvLayout layout = CsvLayout::named_columns;
  std::string time;     ///< [s]; empty: one row per tick
  std::string segment;  ///< rows of equal value form a segment (a toss, a trial); segments follow without a gap, the object jumps
  std::array<std::string, 3> position;          ///< [m]; empty: no object, a user alone
  std::array<std::string, 4> rotation;          ///< w, x, y, z, not normalised; empty: no rotation
  std::array<std::string, 3> velocity;          ///< [m/s]; empty: backward differences, 0 where a segment begins
  std::array<std::string, 3> angular_velocity;  ///< [rad/s]; empty: likewise
  AngularVelocityFrame angular_velocity_frame = AngularVelocityFrame::world;  ///< of angular_velocity; body needs rotation
  std::array<std::string, 3> device;                                          ///< [m] probe of the user
  std::array<std::string, 3> force;  ///< [N] on the user; one recorded force serves for client and server
  std::string object = "object";     ///< name of the object in the trace
  std::string user = "user";         ///< name of the user in the trace, if there is a device or a force
  double length_scale = 1.0;         ///< metres per unit of the file's lengths
  std::uint32_t tick_rate = 0;       ///< 0: from the median spacing of the time column
};

struct CsvPreset {
  const char* name;
  const char* description;
  CsvMapping mapping;
};
const std::vector<CsvPreset>& csv_presets();

/// Compares recorded angular velocities with differences of the rotations. Means over all rows that have both and turn by less
/// than a quarter turn.
struct AngularVelocityCheck {
  std::uint64_t rows = 0;
  double given = 0;               ///< [rad/s] magnitude
  double off = 0, off_other = 0;  ///< [rad/s] deviation from the differences: in the frame of the mapping, in the other one

  /// True if they contradict the rotations: another frame, unit or order of columns.
  bool is_off() const noexcept { return given > 0.1 && off > 0.5 * given; }
};

struct CsvImport {
  TickSpan ticks;  ///< one per row
  std::uint64_t segments = 0;
  AngularVelocityCheck angular_velocity;
};

/// Read `path` (plain or zstd, detected by its first bytes; "-" is standard input) into `out_path`.
/// err  io R-TRC-1; R-CSV-n; invalid_argument R-TRC-17, R-API-n when the trace cannot hold a value; with the location. A partly
///      written file is removed.
tl::expected<CsvImport, Diagnostic> import_csv(const std::string& path, const CsvMapping& mapping, const std::string& out_path);

/// One row per tick: tick, time_s, then of each object and user the columns of csv_plan.h, named by their topics
/// ("/objects/cube/qw"). A force that the trace does not know (KnownForces) has no columns. Numbers are the shortest decimals that
/// read back to the same bits. Returns the ticks of the rows.
/// err  io R-TRC-1: the stream refused; whatever TraceReader::next() reports.
Result<TickSpan> export_csv(TraceReader& reader, std::ostream& out);

}  // namespace tactus
