// SPDX-License-Identifier: Apache-2.0
#include "cli/laboratory/sweep_results.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>
#include <thread>

#include <tactus/base/shown.h>
#include "cli/report/json_parts.h"

namespace tactus::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// The folder, held by this sweep alone until it ends.
tl::expected<Descriptor, Failure> hold(const std::string& folder) {
  Descriptor lock(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!lock.is_open())
    return refuse(shown_path(folder) + ": cannot be opened: " + std::generic_category().message(errno),
                  "Give another folder with -o.");
  if (flock(lock.number(), LOCK_EX | LOCK_NB) == 0) return lock;
  return refuse(shown_path(folder) + ": another sweep is writing here", "Wait until it ends, or give another folder with -o.");
}

/// What must not change between two runs into one folder.
Json identity(const SweepPlan& plan) {
  Json out{{"name", plan.name}, {"command", plan.command}};
  out["inputs"] = Json::array();
  for (const SweepInput& input : plan.inputs)
    out["inputs"].push_back({{"name", input.name}, {"file", input.file}, {"command", input.command}});
  out["measures"] = Json::object();
  for (const SweepMeasure& measure : plan.measures) out["measures"][measure.column] = measure.place;
  out["parameters"] = Json::array();
  for (const SweepParameter& parameter : plan.parameters) out["parameters"].push_back(parameter.name);
  return out;
}

Json context(const SweepPlan& plan) {
  return {{"schema", "tactus.sweep/1"}, {"program", "tactus " TACTUS_VERSION},
          {"compiler", __VERSION__},    {"cores", std::thread::hardware_concurrency()},
          {"sweep", identity(plan)},    {"plan", plan.text}};
}

}  // namespace

tl::expected<SweepResults, Failure> SweepResults::open(const std::string& folder, const SweepPlan& plan) {
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) return refuse(shown_path(folder) + ": cannot make this folder: " + failed.message(), "Give another one with -o.");
  TACTUS_TRY(auto lock, hold(folder));
  SweepResults results(folder, std::move(lock));
  if (fs::exists(folder + "/context.json", failed)) {
    TACTUS_CHECK(results.check_context(plan));
  } else if (fs::exists(results.table_path(), failed)) {
    return refuse(shown_path(results.table_path()) + ": exists without the context.json that describes it",
                  "Give another folder with -o.");
  }
  TACTUS_CHECK(write_file(folder + "/context.json", text_of_json(context(plan)) + "\n", OutputFile::Existing::replace));
  TACTUS_CHECK(results.read(plan));
  return results;
}

Outcome SweepResults::check_context(const SweepPlan& plan) const {
  const std::string path = folder_ + "/context.json";
  TACTUS_TRY(const auto text, read_file(path));
  const Json before = Json::parse(text, nullptr, false);
  if (before.is_discarded() || !before.is_object() || before.value("sweep", Json()) != identity(plan)) {
    return refuse(shown_path(path) + ": this folder holds a sweep with another command, other inputs, parameters or measures",
                  "Give another folder with -o, or remove this one.");
  }
  return {};
}

Outcome SweepResults::read(const SweepPlan& plan) {
  TACTUS_TRY(table_, GrowingTable::open(table_path(), plan.columns()));
  const auto parameters = static_cast<std::ptrdiff_t>(plan.parameters.size());
  for (const Row& row : table_->rows()) rows_[{row.begin(), row.begin() + parameters}] = {row.begin() + parameters, row.end()};
  return {};
}

Outcome SweepResults::add(const std::vector<std::string>& values, const std::vector<std::string>& measures) {
  std::vector<std::string> cells = values;
  cells.insert(cells.end(), measures.begin(), measures.end());
  TACTUS_CHECK(table_->add(std::move(cells)));
  rows_[values] = measures;
  return {};
}

std::vector<SweepResults::Row> SweepResults::rows(const SweepPlan& plan) const {
  std::vector<Row> out;
  for (std::size_t point = 0; point < plan.points(); ++point) {
    Row row = plan.values(point);
    const auto found = rows_.find(row);
    if (found == rows_.end()) continue;
    row.insert(row.end(), found->second.begin(), found->second.end());
    out.push_back(std::move(row));
  }
  return out;
}

Outcome SweepResults::sort(const SweepPlan& plan) {
  auto wanted = rows(plan);
  if (wanted.size() != rows_.size()) return {};  // rows of values that the plan no longer names stay where they are
  return table_->replace(std::move(wanted));
}

}  // namespace tactus::cli
