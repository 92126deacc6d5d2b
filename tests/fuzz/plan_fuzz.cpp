// SPDX-License-Identifier: Apache-2.0
/// Any bytes as the TOML of a sweep plan: an error in words, or a plan whose every point has its words and whose figures name columns.
#include <sys/mman.h>
#include <unistd.h>
#include <algorithm>
#include <cstdint>

#include "cli/laboratory/sweep_plan.h"
#include "tests/fuzz/require.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const int file = memfd_create("plan", 0);
  require(file >= 0 && write(file, data, size) == static_cast<ssize_t>(size));
  const auto plan = tactus::cli::load_plan("/proc/self/fd/" + std::to_string(file));
  close(file);
  if (!plan) {
    require(plan.error().text.find("R-SCN-") != std::string::npos && plan.error().cause == tactus::cli::Failure::Cause::work);
    return 0;
  }
  const auto columns = plan->all_columns();
  const auto names_column = [&](const std::string& name) { return std::ranges::find(columns, name) != columns.end(); };
  for (const auto& plot : plan->plots) {
    require(names_column(plot.x) && names_column(plot.series) && std::ranges::all_of(plot.y, names_column));
    require(plot.y.size() == plot.y_label.size());
    for (const auto& [column, value] : plot.where) require(names_column(column));
  }
  require(plan->points() > 0 && !plan->command.empty());
  for (const std::size_t point : {std::size_t{0}, plan->points() / 2, plan->points() - 1}) {
    require(plan->values(point).size() == plan->parameters.size());
    for (const auto& [made, input] : plan->files_of(point)) {
      require(made.find('/') == std::string::npos);
      (void)plan->words(*input, point, made);
    }
    (void)plan->words(point, [](const std::string& input) { return "folder/" + input; });
    require(plan->is_of(point, {1, 2}) != plan->is_of(point, {2, 2}));
  }
  return 0;
}
