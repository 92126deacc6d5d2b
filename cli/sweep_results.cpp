// SPDX-License-Identifier: Apache-2.0
#include "cli/sweep_results.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>
#include <thread>

#include <tactus/base/shown.h>
#include "cli/json_parts.h"

namespace tactus::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::string quoted(const std::string& cell) {
  if (cell.find_first_of(",\"\n\r") == std::string::npos) return cell;
  std::string out = "\"";
  for (const char c : cell) out.append(c == '"' ? 2 : 1, c);
  return out + '"';
}

std::string line_of(const std::vector<std::string>& cells) {
  std::string out;
  for (const std::string& cell : cells) out += quoted(cell) + ',';
  out.back() = '\n';
  return out;
}

/// Cells of one line (RFC 4180), `at` moves behind it; nothing when the line has no end.
std::optional<std::vector<std::string>> read_line(const std::string& text, std::size_t& at) {
  std::vector<std::string> cells(1);
  bool in_quotes = false;
  for (std::size_t i = at; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"' && in_quotes && i + 1 < text.size() && text[i + 1] == '"') cells.back() += text[++i];
    else if (c == '"') in_quotes = !in_quotes;
    else if (c == ',' && !in_quotes) cells.emplace_back();
    else if (c == '\n' && !in_quotes) {
      at = i + 1;
      return cells;
    } else cells.back() += c;
  }
  return std::nullopt;
}

/// The table of a sweep, open for writing. No link is followed, so that no other file is written to.
Descriptor open_table(const std::string& path, int how) {
  return Descriptor(::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW | how, 0644));
}

tl::unexpected<Failure> refuse_write(const std::string& path, int why) {
  auto refused = refuse_io(path, "cannot be written", why);
  if (why == ELOOP) refused.value().remedy = "It is a link: remove it, or give another folder with -o.";
  return refused;
}

/// Write or append, and wait until the disk has it.
Outcome store(const std::string& path, const std::string& text, int how) {
  const Descriptor file = open_table(path, how);
  bool stored = file.is_open();
  for (std::size_t at = 0; stored && at < text.size();) {
    const ssize_t wrote = ::write(file.number(), text.data() + at, text.size() - at);
    stored = wrote > 0;
    at += stored ? static_cast<std::size_t>(wrote) : 0;
  }
  stored = stored && fsync(file.number()) == 0;
  return stored ? Outcome() : refuse_write(path, errno);
}

/// The folder, held by this sweep alone until it ends.
tl::expected<Descriptor, Failure> hold(const std::string& folder) {
  Descriptor lock(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!lock.is_open())
    return refuse(shown_path(folder) + ": cannot be opened: " + std::generic_category().message(errno),
                  "Give another folder with -o.");
  if (flock(lock.number(), LOCK_EX | LOCK_NB) == 0) return lock;
  return refuse(shown_path(folder) + ": another sweep is writing here", "Wait for its end, or give another folder with -o.");
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
    return refuse(shown_path(results.table_path()) + ": there without the context.json that says what it is",
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
  const std::string heading = line_of(plan.columns());
  std::error_code failed;
  if (!fs::exists(table_path(), failed)) return store(table_path(), heading, O_TRUNC);
  TACTUS_TRY(const auto text, read_file(table_path()));
  std::size_t at = 0;
  const auto first = read_line(text, at);
  if (!first) return store(table_path(), heading, O_TRUNC);
  if (*first != plan.columns())
    return refuse(shown_path(table_path()) + ": its columns are not those of the plan", "Give another folder with -o.");
  const auto parameters = static_cast<std::ptrdiff_t>(plan.parameters.size());
  for (std::size_t line = 2;; ++line) {
    const auto cells = read_line(text, at);
    if (!cells) break;
    if (cells->size() != first->size())
      return refuse(shown_path(table_path()) + ", line " + std::to_string(line) + ": not as many cells as the heading has",
                    "Remove this line.");
    rows_[{cells->begin(), cells->begin() + parameters}] = {cells->begin() + parameters, cells->end()};
  }
  if (at == text.size()) return {};
  const Descriptor table = open_table(table_path(), 0);
  const bool cut = table.is_open() && ftruncate(table.number(), static_cast<off_t>(at)) == 0;  // a row that was cut off
  return cut ? Outcome() : refuse_write(table_path(), errno);
}

Outcome SweepResults::add(const std::vector<std::string>& values, const std::vector<std::string>& measures) {
  std::vector<std::string> cells = values;
  cells.insert(cells.end(), measures.begin(), measures.end());
  TACTUS_CHECK(store(table_path(), line_of(cells), O_APPEND));
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

Outcome SweepResults::sort(const SweepPlan& plan) const {
  std::string text = line_of(plan.columns());
  const auto wanted = rows(plan);
  if (wanted.size() != rows_.size()) return {};  // rows of values that the plan no longer names stay where they are
  for (const Row& row : wanted) text += line_of(row);
  return write_file(table_path(), text, OutputFile::Existing::replace);
}

}  // namespace tactus::cli
