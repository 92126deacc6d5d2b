// SPDX-License-Identifier: Apache-2.0
/// Recordings in text form: import with a column mapping, export of any trace.
#pragma once

#include <cstdint>
#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

#include "codec/base/result.h"
#include "codec/trace/frame.h"
#include "codec/trace/trace_file.h"

namespace tactus {

/// Which column feeds which quantity; an empty name means "not there". Named groups: see csv_presets().
struct CsvMapping {
  std::string time;                             ///< [s]; empty: one row per tick
  std::string segment;                          ///< rows of one value belong together (a toss, a trial)
  std::string position[3];                      ///< [m]
  std::string rotation[4];                      ///< w, x, y, z; empty: no rotation
  std::string velocity[3];                      ///< [m/s]; empty: differences of the position
  std::string angular_velocity[3];              ///< [rad/s]; empty: differences of the rotation
  std::string device[3];                        ///< [m] probe of one user
  std::string force[3];                         ///< [N] on that user
  std::string object = "object";                ///< name of the object in the trace
  double length_scale = 1.0;                    ///< metres per unit of the file's lengths
  std::uint32_t tick_rate = 0;                  ///< 0: from the preset or the time column
};

struct CsvPreset {
  const char* name;
  const char* description;
  CsvMapping mapping;
};
const std::vector<CsvPreset>& csv_presets();

/// Where a text file broke which rule; lines count from 1, 0 when unknown.
struct CsvError {
  Error error;
  std::uint64_t line = 0;
  std::string column;  ///< name of the column in the mapping's words, may be empty
  std::string text;    ///< the offending field
};

struct CsvImport {
  std::uint64_t rows = 0;
  std::uint64_t segments = 0;
};

/// Read `path` (plain or zstd, told by its first bytes; "-" is standard input) into `out_path`.
/// err  io R-TRC-1; malformed R-CSV-n (row length, not a number, missing column), with the place.
tl::expected<CsvImport, CsvError> import_csv(const std::string& path, const CsvMapping& mapping, const std::string& out_path);

/// One row per tick: tick, time_s, then per object and user the columns of the trace, 17 significant digits.
Result<std::uint64_t> export_csv(TraceReader& reader, std::ostream& out);

} // namespace tactus
