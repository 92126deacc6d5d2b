// SPDX-License-Identifier: Apache-2.0
/// What `tactus bench precision` has found so far. In a folder, time.csv and space.csv grow by a row per finished point and
/// context.json says what they are of: a run that was stopped goes on there.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cli/laboratory/growing_table.h"
#include "cli/output.h"
#include "lab/study/precision.h"
#include "lab/study/precision_space.h"

namespace tactus::cli {

/// One point of the time study. The reference is a row, too: its errors are those estimated of itself.
struct TimeRow {
  std::string scene;
  sim::study::PrecisionPoint point;
};
inline constexpr const char* kReferenceMethod = "reference";

struct SpaceRow {
  std::string scene;
  sim::study::SpacePoint point;
};

class PrecisionResults {
 public:
  using Context = std::map<std::string, std::string>;

  /// Take up what is in the folder if it was made in the same context; start afresh in an empty folder or with Existing::replace.
  /// err  the context differs; a file cannot be read or written; a row cannot be understood
  static tl::expected<PrecisionResults, Failure> open(std::string folder, Context context, OutputFile::Existing existing);

  /// Written through to the disk.
  Outcome add(const TimeRow& row);
  Outcome add(const SpaceRow& row);

  const TimeRow* find(const std::string& scene, const std::string& method, int steps_per_sample) const;
  const SpaceRow* find(const std::string& scene, const sim::study::SpaceJob& job) const;
  const Context& context() const noexcept { return context_; }
  const std::string& folder() const noexcept { return folder_; }

 private:
  PrecisionResults(std::string folder, Context context) : folder_(std::move(folder)), context_(std::move(context)) {}
  Outcome read();
  std::string path(const char* file) const { return folder_ + "/" + file; }

  std::string folder_;
  Context context_;
  std::optional<GrowingTable> time_table_, space_table_;  // none until read()
  std::vector<TimeRow> times_;
  std::vector<SpaceRow> spaces_;
};

}  // namespace tactus::cli
