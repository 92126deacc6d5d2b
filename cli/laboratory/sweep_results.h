// SPDX-License-Identifier: Apache-2.0
/// The folder of a sweep, or of one of its shards: points.csv grows by one row per finished point, times.csv by what differs from run
/// to run, context.json says of what. A killed sweep loses no finished point, and a later one computes none of them again.
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
  using Row = GrowingTable::Row;
  using Digests = std::map<std::string, std::string>;  ///< file of an input -> its digest

  /// Make the folder, or take up one that an earlier run of the same plan left; a row that was cut off is dropped. The plan may have
  /// got more values, derived columns and other plots, not another command, inputs or measures. One sweep at a time holds a folder.
  static tl::expected<SweepResults, Failure> open(const std::string& folder, const SweepPlan& plan);

  /// Take the rows of the shards in this folder.
  /// err  one is of another plan, program or input, is written to, or has other measures of a point
  Outcome absorb_shards(const SweepPlan& plan);
  /// The inputs that the next points are computed from.   err  one differs from that of earlier points
  Outcome bind_inputs(const SweepPlan& plan, const Digests& digests);

  bool has(const std::vector<std::string>& values) const { return rows_.contains(values); }
  /// Write a row through to the disk.   in  timing  host, seconds, times.   err  the operating system refuses
  Outcome add(const std::vector<std::string>& values, const Row& measures, const Row& timing);
  /// Of a point of the plan, in the order of its all_columns() without those derived; empty: unfinished.
  Row row(const SweepPlan& plan, std::size_t point) const;
  std::vector<double> seconds() const;  ///< of all finished points
  /// Put the rows in the plan's order; those of values that it no longer names come last.
  Outcome sort(const SweepPlan& plan);
  const std::string& folder() const { return folder_; }

 private:
  using Rows = std::map<std::vector<std::string>, Row>;  ///< by the values of the parameters

  SweepResults(std::string folder, Descriptor lock) : folder_(std::move(folder)), lock_(std::move(lock)) {}
  Outcome read(const SweepPlan& plan);
  Outcome read_context(const SweepPlan& plan);
  Outcome absorb(const std::string& folder, const SweepPlan& plan);
  std::string table_path() const { return folder_ + "/points.csv"; }
  std::string times_path() const { return folder_ + "/times.csv"; }
  std::string context_path() const { return folder_ + "/context.json"; }

  std::string folder_;
  Descriptor lock_;
  std::optional<GrowingTable> table_, times_table_;  // none until read()
  Rows rows_, times_;
  Digests digests_;
};

/// Where the shard of a sweep into `folder` has its own.
std::string shard_folder(const std::string& folder, const SweepShard& shard);

/// err  it cannot be read
tl::expected<std::string, Failure> digest_of_file(const std::string& path);

}  // namespace tactus::cli
