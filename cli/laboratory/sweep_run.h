// SPDX-License-Identifier: Apache-2.0
/// The commands of a sweep: inputs are made, points are computed, several at a time.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "cli/laboratory/sweep_plan.h"
#include "cli/laboratory/sweep_results.h"
#include "cli/progress.h"

namespace tactus::cli {

/// Where the files of a plan's inputs are: in the sweep's folder, or where the user has them.
class SweepInputs {
 public:
  /// in   given  folders with files of the plan, and NAME=FILE
  /// err  one is neither, or names no input
  static tl::expected<SweepInputs, Failure> open(const SweepPlan& plan, std::string folder,
                                                 const std::vector<std::string>& given);

  std::string path_of(const std::string& file) const;
  /// Make those that these points use and that are not there.
  /// out  digests of all that they use
  tl::expected<SweepResults::Digests, Failure> make(const SweepPlan& plan, const std::vector<std::size_t>& points, unsigned jobs,
                                                    Visibility visibility) const;
  /// The commands that make() runs, where there is nothing yet.
  std::vector<std::vector<std::string>> commands(const SweepPlan& plan, const std::vector<std::size_t>& points) const;

 private:
  explicit SweepInputs(std::string folder) : folder_(std::move(folder)) {}
  Outcome make_one(const SweepInput& input, const std::string& file, const SweepPlan& plan, std::size_t point) const;

  std::string folder_;
  std::map<std::string, std::string> given_;  // file of the plan -> path
};

/// A command as it can be typed, whole; only control characters are escaped, for the terminal.
std::string as_typed(const std::vector<std::string>& words);

/// Compute these points, each by a process of its own.   out  of the points that failed, why
std::map<std::size_t, Failure> compute(const SweepPlan& plan, const SweepInputs& inputs, const std::vector<std::size_t>& points,
                                       SweepResults& results, unsigned jobs, Visibility visibility);

}  // namespace tactus::cli
