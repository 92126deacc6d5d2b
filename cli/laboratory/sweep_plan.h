// SPDX-License-Identifier: Apache-2.0
/// Plans of sweeps: a command of this program, run once for every combination of parameters. reports/plans/README.md lists every key.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "cli/report/messages.h"

namespace tactus::cli {

/// An input that is made once before the first point, by a command in which {file} stands for the path to write.
struct SweepInput {
  std::string name;
  std::string file;  ///< name of the file in the sweep's folder
  std::vector<std::string> command;

  std::vector<std::string> words(const std::string& path) const;  ///< the command that writes to `path`
};

/// One figure: every y over x in a panel of its own, one below the other; one line for each value of a parameter.
struct SweepPlot {
  std::string name, title;
  std::string x, series;       ///< columns
  std::vector<std::string> y;  ///< columns
  std::string x_label;
  std::vector<std::string> y_label;  ///< one for each y
  bool log_x = false, log_y = false;
  std::vector<std::pair<std::string, std::string>> where;  ///< only points whose parameter has this value
};

struct SweepParameter {
  std::string name;
  std::vector<std::string> values;  ///< as typed on a command line
};

struct SweepMeasure {
  std::string column;
  std::string place;  ///< JSON pointer into the command's report
};

struct SweepPlan {
  std::string name, text;
  std::vector<std::string> command;  ///< words; {parameter} stands for its value
  std::vector<SweepInput> inputs;
  std::vector<SweepParameter> parameters;
  std::vector<SweepMeasure> measures;
  std::vector<SweepPlot> plots;

  std::size_t points() const;                                     ///< number of combinations
  std::vector<std::string> values(std::size_t point) const;       ///< one per parameter; the last one varies fastest
  const SweepInput* input_named(const std::string& value) const;  ///< nullptr: there is none
  /// The words of a point's command. Values are inserted as they are: {name} in a value stands for nothing. A value that names an input
  /// stands for its file in `folder`; where a parameter is a word of its own, its value may be several words, or none.
  std::vector<std::string> words(std::size_t point, const std::string& folder) const;
  std::vector<std::string> columns() const;  ///< parameters, then measures
};

/// err  file, line, key, rule R-SCN-n (as for scenes) and remedy
tl::expected<SweepPlan, Failure> load_plan(const std::string& path);

}  // namespace tactus::cli
