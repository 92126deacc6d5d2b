// SPDX-License-Identifier: Apache-2.0
#include "cli/laboratory/sweep_results.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>
#include <thread>

#include <tactus/base/hash.h>
#include <tactus/base/shown.h>
#include "cli/report/json_parts.h"
#include "cli/version.h"

namespace tactus::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "tactus.sweep/3";
constexpr const char* kOtherFolder = "Give another folder with -o, or remove this one.";

/// The folder, held by this sweep alone until it ends. A file, because network file systems lock no folders.
tl::expected<Descriptor, Failure> hold(const std::string& folder) {
  const std::string path = folder + "/.lock";
  Descriptor lock(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0644));
  if (lock.is_open() && flock(lock.number(), LOCK_EX | LOCK_NB) == 0) return lock;
  const int why = errno;
  if (lock.is_open() && why == EWOULDBLOCK)
    return refuse(shown_path(folder) + ": another sweep is writing here", "Wait until it ends, or give another folder with -o.");
  return refuse(shown_path(path) + ": cannot be locked: " + std::generic_category().message(why), "Give another folder with -o.");
}

std::string program() { return "tactus " + version_and_commit(); }

/// What must not change between two runs into one folder.
Json identity(const SweepPlan& plan) {
  Json out{{"name", plan.name}, {"command", plan.command}};
  out["inputs"] = Json::array();
  for (const SweepInput& input : plan.inputs)
    out["inputs"].push_back({{"name", input.name}, {"file", input.file}, {"command", input.command}});
  out["measures"] = out["times"] = Json::object();
  for (const SweepMeasure& measure : plan.measures) out["measures"][measure.column] = measure.place;
  for (const SweepMeasure& time : plan.times) out["times"][time.column] = time.place;
  out["parameters"] = Json::array();
  for (const SweepParameter& parameter : plan.parameters) out["parameters"].push_back(parameter.name);
  return out;
}

Json context(const SweepPlan& plan, const SweepResults::Digests& digests) {
  return {{"schema", kSchema},       {"program", program()},
          {"compiler", __VERSION__}, {"cores", std::thread::hardware_concurrency()},
          {"sweep", identity(plan)}, {"inputs", digests},
          {"plan", plan.text}};
}

/// The digests that a folder's context.json names.   err  it is of another sweep or program
tl::expected<SweepResults::Digests, Failure> digests_of(const std::string& path, const SweepPlan& plan) {
  constexpr int kDeepest = 32;  // what lies deeper is left out: copies of it would take the whole stack
  TACTUS_TRY(const auto text, read_regular_file(path));
  const Json before = Json::parse(
      text, [](int depth, auto, const Json&) { return depth <= kDeepest; }, false);
  if (const Json schema = before.is_object() ? before.value("schema", Json()) : Json(); schema.is_string() && schema != kSchema) {
    return refuse(fmt::format("{}: is of the format {}, and this program writes {}", shown_path(path),
                              shown(schema.get<std::string>()), kSchema),
                  kOtherFolder);
  }
  if (!before.is_object() || before.value("sweep", Json()) != identity(plan)) {
    return refuse(shown_path(path) + ": this folder holds a sweep with another command, other inputs, parameters or measures",
                  kOtherFolder);
  }
  const Json by = before.value("program", Json());
  if (by != program()) {
    return refuse(fmt::format("{}: this folder was computed by {}, and this is {}", shown_path(path),
                              shown(by.is_string() ? by.get<std::string>() : by.dump()), program()),
                  kOtherFolder);
  }
  SweepResults::Digests out;
  if (const Json inputs = before.value("inputs", Json()); inputs.is_object())
    for (const auto& [file, digest] : inputs.items())
      if (digest.is_string()) out[file] = digest.get<std::string>();
  return out;
}

Outcome join(SweepResults::Digests& all, const SweepResults::Digests& more, const std::string& path) {
  for (const auto& [file, digest] : more)
    if (all.emplace(file, digest).first->second != digest)
      return refuse(shown_path(path) + ": other points were computed from another file " + shown(file), kOtherFolder);
  return {};
}

std::map<std::vector<std::string>, GrowingTable::Row> by_values(const SweepPlan& plan,
                                                                const std::vector<GrowingTable::Row>& rows) {
  const auto parameters = static_cast<std::ptrdiff_t>(plan.parameters.size());
  std::map<std::vector<std::string>, GrowingTable::Row> out;
  for (const GrowingTable::Row& row : rows) out[{row.begin(), row.begin() + parameters}] = {row.begin() + parameters, row.end()};
  return out;
}

GrowingTable::Row joined(const std::vector<std::string>& values, const GrowingTable::Row& rest) {
  GrowingTable::Row out = values;
  out.insert(out.end(), rest.begin(), rest.end());
  return out;
}

}  // namespace

std::string shard_folder(const std::string& folder, const SweepShard& shard) {
  return fmt::format("{}/shards/{}-of-{}", folder, shard.index, shard.count);
}

tl::expected<std::string, Failure> digest_of_file(const std::string& path) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!file.is_open()) return refuse_io(path, "cannot be opened", errno);
  std::vector<std::uint8_t> piece(std::size_t{1} << 16);
  Fnv1a hash;
  std::uint64_t bytes = 0;
  while (true) {
    const ssize_t got = ::read(file.number(), piece.data(), piece.size());
    if (got < 0) return refuse_io(path, "cannot be read", errno);
    if (got == 0) return fmt::format("{} bytes, FNV-1a {:016x}", bytes, hash.value());
    for (ssize_t i = 0; i < got; ++i) hash.add_byte(piece[static_cast<std::size_t>(i)]);
    bytes += static_cast<std::uint64_t>(got);
  }
}

tl::expected<SweepResults, Failure> SweepResults::open(const std::string& folder, const SweepPlan& plan) {
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) return refuse(shown_path(folder) + ": cannot make this folder: " + failed.message(), "Give another one with -o.");
  TACTUS_TRY(auto lock, hold(folder));
  SweepResults results(folder, std::move(lock));
  TACTUS_CHECK(results.read_context(plan));
  TACTUS_CHECK(results.bind_inputs(plan, {}));
  TACTUS_CHECK(results.read(plan));
  return results;
}

Outcome SweepResults::read_context(const SweepPlan& plan) {
  std::error_code failed;
  if (fs::exists(context_path(), failed)) {
    TACTUS_TRY(digests_, digests_of(context_path(), plan));
  } else if (fs::exists(table_path(), failed)) {
    return refuse(shown_path(table_path()) + ": exists without the context.json that describes it",
                  "Give another folder with -o.");
  }
  return {};
}

Outcome SweepResults::read(const SweepPlan& plan) {
  TACTUS_TRY(table_, GrowingTable::open(table_path(), plan.columns()));
  TACTUS_TRY(times_table_, GrowingTable::open(times_path(), plan.time_columns()));
  rows_ = by_values(plan, table_->rows());
  times_ = by_values(plan, times_table_->rows());
  return {};
}

Outcome SweepResults::bind_inputs(const SweepPlan& plan, const Digests& digests) {
  TACTUS_CHECK(join(digests_, digests, context_path()));
  return write_file(context_path(), text_of_json(context(plan, digests_)) + "\n", OutputFile::Existing::replace);
}

Outcome SweepResults::absorb_shards(const SweepPlan& plan) {
  std::error_code failed;
  std::vector<std::string> folders;
  for (const auto& entry : fs::directory_iterator(folder_ + "/shards", failed)) folders.push_back(entry.path().string());
  std::ranges::sort(folders);
  for (const std::string& folder : folders)
    if (fs::exists(folder + "/context.json", failed)) TACTUS_CHECK(absorb(folder, plan));
  return folders.empty() ? Outcome() : bind_inputs(plan, {});
}

Outcome SweepResults::absorb(const std::string& folder, const SweepPlan& plan) {
  TACTUS_TRY(const SweepResults shard, open(folder, plan));
  TACTUS_CHECK(join(digests_, shard.digests_, shard.context_path()));
  for (const auto& [values, measures] : shard.rows_)
    if (rows_.emplace(values, measures).first->second != measures)
      return refuse(fmt::format("{}: has other measures of the point {} than another shard", shown_path(shard.table_path()),
                                shown(fmt::format("{}", fmt::join(values, ", ")))),
                    "Compute it again: the command depends on more than its options and inputs.");
  for (const auto& [values, timing] : shard.times_) times_.emplace(values, timing);
  return {};
}

Outcome SweepResults::add(const std::vector<std::string>& values, const Row& measures, const Row& timing) {
  TACTUS_CHECK(times_table_->add(joined(values, timing)));  // first: a point that is there has its times
  TACTUS_CHECK(table_->add(joined(values, measures)));
  rows_[values] = measures;
  times_[values] = timing;
  return {};
}

SweepResults::Row SweepResults::row(const SweepPlan& plan, std::size_t point) const {
  const auto values = plan.values(point);
  const auto found = rows_.find(values), timed = times_.find(values);
  if (found == rows_.end()) return {};
  return joined(joined(values, found->second), timed == times_.end() ? Row(plan.times.size() + 2) : timed->second);
}

std::vector<double> SweepResults::seconds() const {
  std::vector<double> out;
  for (const auto& [values, timing] : times_) {
    double value = 0;
    const std::string& text = timing[1];
    if (std::from_chars(text.data(), text.data() + text.size(), value).ec == std::errc()) out.push_back(value);
  }
  return out;
}

Outcome SweepResults::sort(const SweepPlan& plan) {
  const auto sorted = [&plan](Rows rows) {
    std::vector<Row> out;
    for (std::size_t point = 0; point < plan.points(); ++point)
      if (auto node = rows.extract(plan.values(point))) out.push_back(joined(node.key(), node.mapped()));
    for (const auto& [values, rest] : rows) out.push_back(joined(values, rest));
    return out;
  };
  TACTUS_CHECK(table_->replace(sorted(rows_)));
  return times_table_->replace(sorted(times_));
}

}  // namespace tactus::cli
