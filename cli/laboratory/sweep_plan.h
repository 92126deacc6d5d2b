// SPDX-License-Identifier: Apache-2.0
/// Plans of sweeps: a command of this program, run once for every combination of parameters. reports/plans/README.md lists every key.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "cli/laboratory/formula.h"
#include "cli/report/messages.h"

namespace tactus::cli {

/// An input that is made before the points that use it, by a command in which {file} stands for the path to write.
struct SweepInput {
  std::string name;
  std::string file;                  ///< name of the file in the sweep's folder; {parameter} stands for its value
  std::vector<std::string> command;  ///< {parameter} stands for its value; empty: the user gives the file
};

/// One figure: every y over x in a panel of its own, one below the other; one line for each value of a parameter.
struct SweepPlot {
  std::string name, title;
  std::string x, series;       ///< columns
  std::vector<std::string> y;  ///< columns
  std::string x_label, series_label;
  std::vector<std::string> y_label;  ///< one for each y
  bool log_x = false, log_y = false;
  std::vector<std::pair<std::string, std::string>> where;  ///< only points whose column has this value
  std::map<std::string, std::string> names;                ///< what the legend calls a value of the series
};

struct SweepParameter {
  std::string name;
  std::vector<std::string> values;  ///< as typed on a command line
  std::size_t axis = 0;             ///< parameters of one axis change together
};

struct SweepMeasure {
  std::string column;
  std::string place;  ///< JSON pointer into the command's report
};

struct SweepDerived {
  std::string column;
  std::string text;
  Formula formula;
  bool from_times = false;  ///< it uses a time, which differs from run to run
};

/// The i-th of n parts of a sweep, from 1.
struct SweepShard {
  std::size_t index = 1, count = 1;
};

struct SweepPlan {
  std::string name, text;
  std::vector<std::string> command;  ///< words; {parameter} stands for its value
  std::vector<SweepInput> inputs;
  std::vector<SweepParameter> parameters;
  std::vector<SweepMeasure> measures, times;
  std::vector<SweepDerived> derived;
  std::vector<SweepPlot> plots;
  bool repeats = false;  ///< the last parameter only repeats: tables and figures show the spread over its values

  std::size_t points() const;                                ///< number of combinations
  std::size_t repetitions() const;                           ///< consecutive points that differ in nothing else
  std::vector<std::string> values(std::size_t point) const;  ///< one per parameter; the last axis varies fastest
  bool is_of(std::size_t point, const SweepShard& shard) const;
  const SweepInput* input_named(const std::string& value) const;  ///< nullptr: there is none

  /// The files of inputs that a point uses, each with its input.
  std::vector<std::pair<std::string, const SweepInput*>> files_of(std::size_t point) const;
  /// The words of the command that makes the file which this point uses.
  std::vector<std::string> words(const SweepInput& input, std::size_t point, const std::string& path) const;
  /// The words of a point's command. Values are inserted as they are: {name} in a value stands for nothing. A value that names an input
  /// stands for path_of(its file); where a parameter is a word of its own, its value may be several words, or none.
  std::vector<std::string> words(std::size_t point, const std::function<std::string(const std::string& file)>& path_of) const;

  std::vector<std::string> columns() const;       ///< of points.csv: parameters, then measures
  std::vector<std::string> time_columns() const;  ///< of times.csv: parameters, host, seconds, then times
  std::vector<std::string> all_columns() const;   ///< parameters, measures, host, seconds, times, derived
};

inline constexpr const char* kHostColumn = "host";
inline constexpr const char* kSecondsColumn = "seconds";  ///< that the command of a point took

/// err  file, line, key, rule R-SCN-n (as for scenes) and remedy
tl::expected<SweepPlan, Failure> load_plan(const std::string& path);

}  // namespace tactus::cli
