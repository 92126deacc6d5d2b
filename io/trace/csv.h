// SPDX-License-Identifier: Apache-2.0
/// Recordings in text form: import with a column mapping, export of any trace. What a table may look like: csv_reader.h, csv_header.h.
///
/// Numbers keep their meaning: units and axes in the names of columns are taken, and refused where the mapping says otherwise. A
/// value that is missing (an empty cell, NaN, "-", a rotation of length 0) is put between its neighbours, within CsvMapping::gap. Times that
/// lie on no grid are resampled, and those of rows that come in groups are spread evenly (csv_rate.h). Whatever was decided is reported in
/// CsvImport::notes.
///
/// rule      class             broken when
/// R-CSV-1   truncated         the text has no line of names and one of values, or its zstd data ends early
///           malformed         its zstd data is damaged
/// R-CSV-2   malformed         a column of the mapping is not there, or there twice
/// R-CSV-3   malformed         a row has more or fewer fields than there are columns
/// R-CSV-4   malformed         a field is not a decimal number, not a whole number in range where one is needed, or no reports; CsvMapping::strict:
///                             a value is missing
/// R-CSV-5   invalid           times are not in order (beyond a window of rows), repeat (only strict), or leave 0 .. 2^31 s
/// R-CSV-6   limit_exceeded    a line is longer than 1 MiB
/// R-CSV-7   invalid_argument  the rate is unknown: no tick_rate in the mapping and no column of time with two rows
/// R-CSV-8   invalid_argument  the mapping names some columns of a vector but not all, or nothing to record, or angular velocities in the
///                             body frame without rotations
/// R-CSV-9   limit_exceeded    the zstd data unpacks to, or rows are resampled to, more than its size has earned (input_budget.h)
/// R-CSV-10  invalid_argument  the mapping contradicts what the names of columns say of units and axes, or neither says what must be known
/// R-API-5, R-API-4  as declared_contact.h: a contact
/// R-CSV-11  invalid           the rate is below 10 Hz or above 50 kHz, or more than half of the ticks are missing, and nobody said the unit of
///                             time or the rate
#pragma once

#include <array>
#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include <tactus/base/diagnostic.h>
#include <tactus/trace/declared_contact.h>
#include <tactus/trace/frame.h>
#include <tactus/trace/read_notes.h>
#include <tactus/trace/trace_file.h>

namespace tactus {

enum class CsvLayout : std::uint8_t {
  named_columns,  ///< one object, one user, columns as the mapping names them
  tactus,         ///< columns of export_csv(): any objects and users; only tick_rate of the mapping is used. A force without
                  ///< columns is not known (RecordedForces)
};

/// Frame of the recorded angular velocities. A gyroscope on the object measures in the body frame.
enum class AngularVelocityFrame : std::uint8_t { world, body };

inline constexpr const char* kZeroColumn = "0";  ///< in a vector: a component that the table lacks and that is 0

inline constexpr const char* kTickUnit = "tick";     ///< as time_unit: the column counts ticks of tick_rate
inline constexpr const char* kClockUnit = "hhmmss";  ///< as time_unit: 123559.5 is 12:35:59.5, as of NMEA

enum class CsvNames : std::uint8_t {
  automatic,  ///< csv_header.h
  none,       ///< the first line holds values; columns are #1, #2, ...
  first,      ///< the first line holds the names, whatever they look like
};

/// What the text of a table is like, where its own looks mislead.
struct CsvText {
  std::uint32_t skip_lines = 0;  ///< ahead of everything
  CsvNames names = CsvNames::automatic;
};

/// In which order the four columns of a rotation are listed.
enum class QuaternionOrder : std::uint8_t {
  by_names,  ///< as the columns are called; where they are not called after axes, as the first rotation shows: it is near none
  wxyz,
  xyzw,
};

enum class CsvDateOrder : std::uint8_t { by_digits, mdy, dmy };  ///< of dates such as 05/06/2024

/// Which column feeds which quantity of an object or a user; an empty name means "not there". A column may also be named by its number,
/// "#3", without its unit, or by the end of its name where that is unique. At most one kind of rotation of each.
struct CsvQuantities {
  std::array<std::string, 3> position;  ///< [m]; empty: no object, a user alone
  std::array<std::string, 4> rotation;  ///< w, x, y, z or as CsvMapping::quaternion_order says; empty: no rotation
  std::array<std::string, 3>
      euler;  ///< [rad] in the order of CsvMapping::euler_order, or as roll, pitch, yaw (x, y, z) are called
  std::array<std::string, 3> rotation_vector;   ///< [rad] axis times angle
  std::array<std::string, 9> rotation_matrix;   ///< row by row, object to world
  std::array<std::string, 3> velocity;          ///< [m/s]; empty: backward differences, 0 where a segment begins
  std::array<std::string, 3> angular_velocity;  ///< [rad/s]; empty: likewise
  std::array<std::string, 3> device;            ///< [m] probe of the user
  std::array<std::string, 4> device_rotation;   ///< of the probe, as rotation, or as the three others; needs device
  std::array<std::string, 3> device_euler, device_rotation_vector;
  std::array<std::string, 9> device_rotation_matrix;
  std::array<std::string, 3> force;  ///< [N] on the user; one recorded force serves for client and server
};

/// Another object, user, or both, of a table that has several.
struct CsvSubject : CsvQuantities {
  std::string name;
};

/// The whole mapping. Named ones: see csv_presets().
struct CsvMapping : CsvQuantities {
  CsvLayout layout = CsvLayout::named_columns;
  std::string time;  ///< a number, a date with a time of day, or a time of day; empty: one row per tick. Two columns with a comma
                     ///< between: seconds and what is to be added (its name says ns, us or ms), or a date and a time of day
  CsvDateOrder date_order = CsvDateOrder::by_digits;
  std::string segment;  ///< rows of equal value form a segment (a toss, a trial); segments follow without a gap, the object jumps
  std::string object_column;  ///< of a long table: each of its values is an object (and a user), in its own rows
  AngularVelocityFrame angular_velocity_frame = AngularVelocityFrame::world;  ///< of angular_velocity; body needs rotation
  std::string object = "object";                                              ///< name of the object in the trace
  std::string user = "user";  ///< name of the user in the trace, if there is a device or a force
  std::vector<CsvSubject> others{};
  double length_scale = 1.0;  ///< metres per unit of the file's lengths
  bool says_length = false;   ///< length_scale was given, and must not contradict the names
  std::string time_unit{}, angle_unit{},
      force_unit{};  ///< "ms" (or kTickUnit, kClockUnit), "deg", "mN"; empty: as the names say, else s, rad and N
  QuaternionOrder quaternion_order = QuaternionOrder::by_names;
  std::string euler_order{};                 ///< "ZYX": about z, then the turned y, then the turned x; "xyz": about fixed axes
  std::array<std::int8_t, 3> axes{1, 2, 3};  ///< what the trace's x, y and z are in the file: {1, -3, 2} is x, -z, y
  std::uint32_t tick_rate = 0;               ///< 0: from the times
  double gap = 0;          ///< [s] missing values are put in within so much; 0: 0.1 s, or three sample periods if that is longer
  bool resample = true;    ///< times off the grid of the rate are resampled; else rounded, and refused if two are in a tick
  bool restarts = false;   ///< where the time falls, another segment begins
  bool strict = false;     ///< what is missing, out of order or cut is refused
  bool keep_last = false;  ///< take a last line without an end
  bool skip_bad = false;   ///< leave out rows that cannot be read
  std::vector<DeclaredContact> contacts{};  ///< what users touched: is written into the trace
  std::vector<std::string> missing{};       ///< more texts that mean "no value"
  CsvText text{};
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
  TickSpan ticks;
  std::uint64_t segments = 0;
  AngularVelocityCheck angular_velocity;
  ReadNotes notes{};  ///< what was decided
};

/// Read `path` (plain or zstd, detected by its first bytes; "-" is standard input) into `out_path`.
/// err  io R-TRC-1; R-CSV-n; invalid_argument R-TRC-17, R-API-n when the trace cannot hold a value; with the location. A partly
///      written file is removed.
tl::expected<CsvImport, Diagnostic> import_csv(const std::string& path, const CsvMapping& mapping, const std::string& out_path);

/// One row per tick: tick, time_s, then of each object and user the columns of csv_plan.h, named by their topics
/// ("/objects/cube/qw"). A force that the trace does not know (RecordedForces) has no columns. Numbers are the shortest decimals that
/// read back to the same bits. Returns the ticks of the rows.
/// err  io R-TRC-1: the stream refused; whatever TraceReader::next() reports.
Result<TickSpan> export_csv(TraceReader& reader, std::ostream& out);

}  // namespace tactus
