// SPDX-License-Identifier: Apache-2.0
/// The folder of a sweep: points.csv grows by one row per finished point, context.json says of what. A killed sweep loses no
/// finished point, and a later one computes none of them again.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cli/laboratory/growing_table.h"
#include "cli/laboratory/sweep_plan.h"
#include "cli/output.h"

namespace tactus::cli {

class SweepResults {
 public:
  using Row = GrowingTable::Row;  ///< parameters, then measures

  /// Make the folder, or take up one that an earlier run of the same plan left; a row that was cut off is dropped. The plan may have
  /// got more values and other plots, not another command, inputs or measures. One sweep at a time holds a folder.
  static tl::expected<SweepResults, Failure> open(const std::string& folder, const SweepPlan& plan);

  bool has(const std::vector<std::string>& values) const { return rows_.contains(values); }
  /// Write a row through to the disk.   err  the operating system refuses
  Outcome add(const std::vector<std::string>& values, const std::vector<std::string>& measures);
  /// Rows of the plan's points in its order; unfinished points are left out.
  std::vector<Row> rows(const SweepPlan& plan) const;
  /// Put the rows in the plan's order, once all are there.
  Outcome sort(const SweepPlan& plan);
  const std::string& folder() const { return folder_; }

 private:
  SweepResults(std::string folder, Descriptor lock) : folder_(std::move(folder)), lock_(std::move(lock)) {}
  Outcome read(const SweepPlan& plan);
  Outcome check_context(const SweepPlan& plan) const;
  std::string table_path() const { return folder_ + "/points.csv"; }

  std::string folder_;
  Descriptor lock_;
  std::optional<GrowingTable> table_;                                  // none until read()
  std::map<std::vector<std::string>, std::vector<std::string>> rows_;  // parameters -> measures
};

}  // namespace tactus::cli
