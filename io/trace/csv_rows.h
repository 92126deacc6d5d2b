// SPDX-License-Identifier: Apache-2.0
/// Fields of a row to samples in SI units, in the axes of a trace. Internal to the library.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include <tactus/base/rule.h>
#include <tactus/trace/csv_named.h>
#include <tactus/trace/csv_reader.h>
#include <tactus/trace/csv_time.h>

namespace tactus {

/// A sample of one channel. A device or a force has its vector in the position.
struct CsvValue {
  std::uint32_t channel = 0;
  bool is_there = false;  ///< else it is missing
  RigidSample sample;
};

struct CsvRow {
  std::uint64_t line = 0;
  std::int64_t time = 0;  ///< [ns]
  std::size_t bytes = 0;
  std::string segment;
  std::vector<CsvValue> values;
};

class CsvRows {
 public:
  CsvRows(const CsvMapping& mapping, CsvNamedPlan& plan);
  /// The row that the reader is at.   out  nothing: it is left out, which a note reports
  CsvResult<std::optional<CsvRow>> parse(const CsvReader& reader);
  /// Of a long table: names in the order in which they came.
  const std::vector<std::string>& objects() const noexcept { return objects_; }
  std::int64_t first_date() const noexcept { return first_date_; }  ///< [ns] since 1970; 0: times are no dates

 private:
  enum class Read : std::uint8_t { value, missing, wrong };
  Read read(const std::vector<std::string>& fields, const CsvNumber& number, double& value);
  template <std::size_t N>
  Read read(const std::vector<std::string>& fields, const std::array<CsvNumber, N>& numbers, std::span<double> values);
  Read read_sample(const std::vector<std::string>& fields, const CsvChannel& channel, RigidSample& sample);
  Read read_rotation(const std::vector<std::string>& fields, const CsvChannel& channel, Quat& rotation);
  bool read_time(const std::vector<std::string>& fields, CsvRow& row);
  bool looks_like_clock(std::int64_t time);
  bool add_fraction(const std::vector<std::string>& fields, CsvTime& time);
  CsvResult<void> settle_order(const std::vector<std::string>& fields, CsvChannel& channel);
  void settle_unit(const std::string& field);
  void turn_axes(RigidSample& sample, bool is_object) const;
  bool has_all(const std::vector<std::string>& fields);
  bool find_object(const std::vector<std::string>& fields, std::size_t& index);
  std::string at() const { return "line " + std::to_string(line_); }
  Diagnostic wrong(RuleName rule, std::string remedy) const;

  const CsvMapping& mapping_;
  CsvNamedPlan& plan_;
  bool turns_ = false;
  double mirror_ = 1;  // -1: the file's frame is left-handed
  std::vector<std::string> objects_;
  std::map<std::string, std::size_t, std::less<>> object_index_;
  std::uint64_t line_ = 0;
  std::size_t column_ = 0;  // that was read last
  std::string text_, why_;  // why a value is missing
  std::string remedy_;      // of a time that cannot be read
  bool has_time_ = false, may_be_clock_ = true;
  bool asks_ = false;  // what the rows mean: not one bad row
  std::int64_t last_clock_ = 0;
  CsvTimeKind kind_ = CsvTimeKind::number;
  std::int64_t last_time_ = 0, wrapped_ = 0, first_date_ = 0;
};

}  // namespace tactus
