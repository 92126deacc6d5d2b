// SPDX-License-Identifier: Apache-2.0
/// When the rows of a table were: the rate of its first rows, and times of rows that come in groups. Internal to the library.
///
/// A clock that is coarser than the samples, or a driver that hands over many at once, gives several rows one time, or nearly. The rows of
/// such groups are spread evenly: they are samples, and only their times were lost. Copies of a row are none, and short pauses between
/// samples that are truly close are kept: an object that moves on farther from group to group than within them has moved in between.
#pragma once

#include <map>
#include <span>
#include <string>

#include <tactus/trace/csv_rows.h>

namespace tactus {

struct CsvRate {
  std::uint32_t tick_rate = 0;
  bool is_off_grid = false;  ///< rows lie between ticks
  double period = 0;         ///< [ns] of rows that come in groups; 0: they do not
  double apart = 0;          ///< [ns] groups, on average
  double size = 1;           ///< rows in a group, on average
  double lead = 0;           ///< [ns] of the first row's even time before its own one, below 0: behind it
};

/// Of the first rows, in order.   out  what was decided is reported in the plan's notes
/// err  invalid_argument R-CSV-7; invalid R-CSV-5, R-CSV-11
CsvResult<CsvRate> estimate_rate(std::span<const CsvRow> rows, const CsvMapping& mapping, CsvNamedPlan& plan);

/// Even times for rows in groups, which follow the clock of the table slowly.
class EvenTimes {
 public:
  EvenTimes() = default;
  explicit EvenTimes(const CsvRate& rate) : rate_(rate) {}
  /// [ns] in order;  in  object  of a long table
  std::int64_t time_of(const CsvRow& row, std::size_t object);

 private:
  struct Last {
    std::string segment;
    std::int64_t first = 0, time = 0;  // [ns] of the table
    double even = 0, correction = 0;   // [ns] since `first`; per row
  };
  CsvRate rate_;
  std::map<std::size_t, Last> last_;
};

}  // namespace tactus
