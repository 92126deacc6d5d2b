// SPDX-License-Identifier: Apache-2.0
#include "cli/laboratory/sweep_run.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <mutex>
#include <nlohmann/json.hpp>
#include <system_error>
#include <thread>

#include <tactus/base/shown.h>
#include "cli/figure/child_process.h"

namespace tactus::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr int kBoundsBroken = 3;  // exit status

/// A word as a POSIX shell takes it.
std::string quoted(const std::string& word) {
  constexpr std::string_view kBare = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_./,:=%+-";
  if (!word.empty() && word.find_first_not_of(kBare) == std::string::npos) return word;
  std::string out = "'";
  for (const char c : word) {
    if (c == '\'') out += "'\\''";
    else out += c;
  }
  return out + '\'';
}

/// A path that no command takes for an option.
std::string as_argument(const std::string& path) { return path.starts_with('-') ? "./" + path : path; }

/// What a command said on standard error, its error not as JSON.
std::string in_words(std::string said) {
  while (!said.empty() && said.back() == '\n') said.pop_back();
  const std::size_t start = said.starts_with('{') ? 0 : said.find("\n{\n");
  if (start == std::string::npos) return said;
  const Json report = Json::parse(said.begin() + static_cast<std::ptrdiff_t>(start), said.end(), nullptr, false);
  if (report.is_discarded() || !report.contains("error")) return said;
  const Json& error = report["error"];
  std::string out = said.substr(0, start) + (start > 0 ? "\n" : "") + "error: " + error.value("text", "");
  if (error.contains("remedy")) out += "\n       " + error.value("remedy", "");
  return out;
}

/// Run a command of this program. A report of broken bounds is one.   err  it failed: the command and what it said
tl::expected<std::string, Failure> run_command(const std::vector<std::string>& words) {
  std::vector<std::string> arguments{own_program()};
  arguments.insert(arguments.end(), words.begin(), words.end());
  auto done = run_child(arguments);
  if (!done)
    return refuse(arguments[0] + ": the program cannot be started: " + done.error().message(), "Check the installation.");
  if (done->status == 0 || done->status == kBoundsBroken) return std::move(done->out);
  return refuse(as_typed(words) + "\n" + in_words(done->error), "");
}

/// The plan's measures out of a command's report.
tl::expected<std::vector<std::string>, Failure> measure(const std::vector<SweepMeasure>& measures,
                                                        const std::vector<std::string>& words, const Json& report) {
  std::vector<std::string> out;
  for (const SweepMeasure& wanted : measures) {
    const Json::json_pointer place(wanted.place);
    if (!report.contains(place) || report[place].is_structured()) {
      return refuse(fmt::format("{}\n       its report has no value at {}", as_typed(words), wanted.place),
                    "Look at what the command prints with --json.");
    }
    const Json& value = report[place];
    out.push_back(value.is_string() ? value.get<std::string>() : value.dump());
  }
  return out;
}

std::string own_host() {
  char name[256] = {};
  return gethostname(name, sizeof name - 1) == 0 ? name : "unknown";
}

/// work(i) for all i below `count`, on threads that each wait for one process at a time.
template <class Work>
void run_side_by_side(std::size_t count, unsigned jobs, const Work& work) {
  std::atomic<std::size_t> next = 0;
  std::vector<std::thread> threads;
  for (unsigned t = 0; t < std::min<std::size_t>(jobs, count); ++t)
    threads.emplace_back([&] {
      for (std::size_t i = next++; i < count; i = next++) work(i);
    });
  for (std::thread& thread : threads) thread.join();
}

/// No exception leaves a thread: it would end the program.
template <class Work>
auto guarded(const std::vector<std::string>& words, const Work& work) -> decltype(work()) {
  try {
    return work();
  } catch (const std::exception& e) {
    return refuse(as_typed(words) + "\n       " + e.what(), "");
  }
}

struct Computed {
  std::vector<std::string> measures, timing;
};

tl::expected<Computed, Failure> compute_point(const SweepPlan& plan, const std::vector<std::string>& words) {
  auto arguments = words;
  arguments.insert(arguments.end(), {"--json", "--quiet"});
  const auto begin = std::chrono::steady_clock::now();
  TACTUS_TRY(const std::string text, run_command(arguments));
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const Json report = Json::parse(text, nullptr, false);
  if (report.is_discarded())
    return refuse(as_typed(words) + "\n       printed no JSON report", "Sweep a command that takes --json.");
  Computed out;
  TACTUS_TRY(out.measures, measure(plan.measures, words, report));
  TACTUS_TRY(const auto times, measure(plan.times, words, report));
  out.timing = {own_host(), fmt::format("{:.3f}", seconds)};
  out.timing.insert(out.timing.end(), times.begin(), times.end());
  return out;
}

struct Made {
  const SweepInput* input;
  std::size_t point;  // the first that uses it
};

/// The files that these points use.
std::map<std::string, Made> files_of(const SweepPlan& plan, const std::vector<std::size_t>& points) {
  std::map<std::string, Made> out;
  for (const std::size_t point : points)
    for (const auto& [file, input] : plan.files_of(point)) out.try_emplace(file, Made{input, point});
  return out;
}

}  // namespace

std::string as_typed(const std::vector<std::string>& words) {
  std::string out = "tactus";
  for (const std::string& word : words) out += ' ' + quoted(word);
  return shown(out, std::string::npos);
}

tl::expected<SweepInputs, Failure> SweepInputs::open(const SweepPlan& plan, std::string folder,
                                                     const std::vector<std::string>& given) {
  SweepInputs out(as_argument(folder));
  std::vector<std::size_t> all(plan.points());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
  const auto files = files_of(plan, all);
  std::error_code failed;
  for (const std::string& one : given) {
    if (fs::is_directory(one, failed)) {
      const std::size_t before = out.given_.size();
      for (const auto& [file, made] : files)
        if (const std::string path = as_argument(one) + "/" + file; fs::exists(path, failed)) out.given_[file] = path;
      if (out.given_.size() > before) continue;
      return refuse_arguments(fmt::format("--inputs {}: holds no file of an input of the plan", shown(one)),
                              "Give one with the files that the points use, named as `--list` shows them.");
    }
    const std::size_t equals = std::min(one.find('='), one.size());
    const SweepInput* input = plan.input_named(one.substr(0, equals));
    if (equals == one.size() || !input)
      return refuse_arguments(fmt::format("--inputs {}: is no folder, and no input of the plan with its file", shown(one)),
                              "Give a folder, or NAME=FILE with the name of an [[input]].");
    if (!files.contains(input->file))
      return refuse_arguments(fmt::format("--inputs {}: no point uses a file {}", shown(one), input->file),
                              "Give a folder with the files that the points use, named as `--list` shows them.");
    out.given_[input->file] = as_argument(one.substr(equals + 1));
  }
  return out;
}

std::string SweepInputs::path_of(const std::string& file) const {
  const auto found = given_.find(file);
  return found == given_.end() ? folder_ + "/" + file : found->second;
}

/// Made aside and linked to its name, so that a file with the right name is whole. Where two shards make the same, the first one stays.
Outcome SweepInputs::make_one(const SweepInput& input, const std::string& file, const SweepPlan& plan, std::size_t point) const {
  std::error_code failed;
  if (given_.contains(file) || fs::exists(path_of(file), failed)) return {};
  if (input.command.empty())
    return refuse(fmt::format("input {}: the plan has no command that makes it", input.name),
                  fmt::format("Give the file with --inputs {}=FILE.", input.name));
  TACTUS_TRY(const auto aside, AsideFolder::create(folder_, "unfinished"));
  const fs::path made = fs::path(aside.path()) / file;
  TACTUS_CHECK(run_command(plan.words(input, point, made.string())));
  fs::create_hard_link(made, path_of(file), failed);
  if (failed == std::errc::operation_not_permitted) fs::rename(made, path_of(file), failed);  // a file system without links
  if (!failed || failed == std::errc::file_exists) return {};
  return refuse(fmt::format("input {}: the command left no file: {}", input.name, failed.message()),
                "Let the command write to {file}.");
}

tl::expected<SweepResults::Digests, Failure> SweepInputs::make(const SweepPlan& plan, const std::vector<std::size_t>& points,
                                                               unsigned jobs, Visibility visibility) const {
  const auto files = files_of(plan, points);
  Progress progress("inputs", files.size(), visibility);
  std::vector<std::pair<std::string, Made>> list(files.begin(), files.end());
  std::vector<std::string> digests(list.size());
  std::map<std::size_t, Failure> failures;
  std::mutex mutex;
  std::size_t done = 0;
  run_side_by_side(list.size(), jobs, [&](std::size_t i) {
    const std::string& file = list[i].first;
    const Made& made = list[i].second;
    const auto digest = guarded({}, [&]() -> tl::expected<std::string, Failure> {
      TACTUS_CHECK(make_one(*made.input, file, plan, made.point));
      return digest_of_file(path_of(file));
    });
    const std::lock_guard lock(mutex);
    if (digest) digests[i] = *digest;
    else failures.emplace(i, digest.error());
    progress.update(++done);
  });
  if (!failures.empty()) return tl::unexpected(failures.begin()->second);
  SweepResults::Digests out;
  for (std::size_t i = 0; i < list.size(); ++i) out[list[i].first] = digests[i];
  return out;
}

std::vector<std::vector<std::string>> SweepInputs::commands(const SweepPlan& plan, const std::vector<std::size_t>& points) const {
  std::vector<std::vector<std::string>> out;
  for (const auto& [file, made] : files_of(plan, points))
    if (!given_.contains(file) && !made.input->command.empty()) out.push_back(plan.words(*made.input, made.point, path_of(file)));
  return out;
}

std::map<std::size_t, Failure> compute(const SweepPlan& plan, const SweepInputs& inputs, const std::vector<std::size_t>& points,
                                       SweepResults& results, unsigned jobs, Visibility visibility) {
  Progress progress("sweep " + plan.name, points.size(), visibility);
  std::map<std::size_t, Failure> failures;
  std::mutex mutex;  // for what lies outside of a thread
  std::atomic<bool> stop = false;
  std::size_t done = 0;
  run_side_by_side(points.size(), jobs, [&](std::size_t i) {
    if (stop) return;
    const auto words = plan.words(points[i], [&](const std::string& file) { return inputs.path_of(file); });
    const auto computed = guarded(words, [&] { return compute_point(plan, words); });
    const std::lock_guard lock(mutex);
    if (!computed) failures.emplace(points[i], computed.error());
    else if (auto kept = results.add(plan.values(points[i]), computed->measures, computed->timing); !kept) {
      failures.emplace(points[i], kept.error());
      stop = true;
    }
    progress.update(++done);
  });
  return failures;
}

}  // namespace tactus::cli
