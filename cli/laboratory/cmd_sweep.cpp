// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>
#include <thread>

#include <tactus/base/shown.h>
#include "cli/laboratory/child_process.h"
#include "cli/laboratory/plot.h"
#include "cli/laboratory/sweep_plan.h"
#include "cli/laboratory/sweep_plots.h"
#include "cli/laboratory/sweep_results.h"
#include "cli/options/options_codec.h"
#include "cli/report/json_parts.h"
#include "cli/report/table.h"

namespace tactus::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr int kBoundsBroken = 3;                             // exit status
constexpr const char* kInsideSweep = "TACTUS_INSIDE_SWEEP";  // variable of the environment that a sweep's commands see

struct SweepOptions {
  std::string plan, folder;
  unsigned jobs = 0;  // 0: one per core
  bool list = false;
  CommonOptions common;
};

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

/// A command as it can be typed, whole; only control characters are escaped, for the terminal.
std::string as_typed(const std::vector<std::string>& words) {
  std::string out = "tactus";
  for (const std::string& word : words) out += ' ' + quoted(word);
  return shown(out, std::string::npos);
}

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

/// Inputs that are not there yet. Made aside and moved, so that a file with the right name is whole.
Outcome make_inputs(const SweepPlan& plan, const std::string& folder, Visibility visibility) {
  std::error_code failed;
  Progress progress("inputs", plan.inputs.size(), visibility);
  for (std::size_t i = 0; i < plan.inputs.size(); ++i) {
    const SweepInput& input = plan.inputs[i];
    const fs::path file = fs::path(folder) / input.file;
    progress.update(i);
    if (fs::exists(file, failed)) continue;
    TACTUS_TRY(const auto aside, AsideFolder::create(folder, "unfinished"));
    const fs::path made = fs::path(aside.path()) / input.file;
    TACTUS_CHECK(run_command(input.words(made.string())));
    fs::rename(made, file, failed);
    if (failed) {
      return refuse(fmt::format("input {}: the command left no file: {}", input.name, failed.message()),
                    "Let the command write to {file}.");
    }
  }
  return {};
}

/// The plan's measures out of a command's report.
tl::expected<std::vector<std::string>, Failure> measure(const SweepPlan& plan, const std::vector<std::string>& words,
                                                        const std::string& text) {
  const Json report = Json::parse(text, nullptr, false);
  if (report.is_discarded())
    return refuse(as_typed(words) + "\n       printed no JSON report", "Sweep a command that takes --json.");
  std::vector<std::string> out;
  for (const SweepMeasure& wanted : plan.measures) {
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

/// The points that are still missing, spread over threads that each wait for one process at a time.
class Workers {
 public:
  Workers(const SweepPlan& plan, SweepResults& results, Progress& progress)
      : plan_(plan), results_(results), progress_(progress) {
    for (std::size_t point = 0; point < plan.points(); ++point)
      if (!results.has(plan.values(point))) missing_.push_back(point);
  }

  std::size_t missing() const { return missing_.size(); }
  std::size_t failed() const { return failures_.size(); }
  const Failure& first_failure() const { return failures_.begin()->second; }  ///< in the plan's order.   pre  failed() > 0

  void run(unsigned jobs) {
    std::vector<std::thread> threads;
    for (unsigned i = 0; i < std::min<std::size_t>(jobs, missing_.size()); ++i) threads.emplace_back([this] { work(); });
    for (std::thread& thread : threads) thread.join();
  }

 private:
  void work() {
    for (std::size_t i = next_++; i < missing_.size() && !stop_; i = next_++) {
      const auto words = plan_.words(missing_[i], results_.folder());
      auto arguments = words;
      arguments.insert(arguments.end(), {"--json", "--quiet"});
      auto measured = computed(words, arguments);
      const std::lock_guard lock(mutex_);
      if (!measured) failures_.emplace(missing_[i], measured.error());
      else if (auto kept = results_.add(plan_.values(missing_[i]), *measured); !kept) {
        failures_.emplace(missing_[i], kept.error());
        stop_ = true;
      }
      progress_.update(++done_);
    }
  }

  /// No exception leaves a thread: it would end the program.
  tl::expected<std::vector<std::string>, Failure> computed(const std::vector<std::string>& words,
                                                           const std::vector<std::string>& arguments) const {
    try {
      return run_command(arguments).and_then([&](const std::string& text) { return measure(plan_, words, text); });
    } catch (const std::exception& e) {
      return refuse(as_typed(words) + "\n       " + e.what(), "");
    }
  }

  const SweepPlan& plan_;
  SweepResults& results_;
  Progress& progress_;
  std::vector<std::size_t> missing_;
  std::atomic<std::size_t> next_ = 0;
  std::atomic<bool> stop_ = false;
  std::mutex mutex_;                         // for what follows, and for results_ and progress_
  std::map<std::size_t, Failure> failures_;  // point
  std::size_t done_ = 0;
};

void print_commands(const SweepPlan& plan, const std::string& folder) {
  for (const SweepInput& input : plan.inputs) fmt::print("{}\n", as_typed(input.words(folder + "/" + input.file)));
  for (std::size_t point = 0; point < plan.points(); ++point) fmt::print("{}\n", as_typed(plan.words(point, folder)));
}

struct Summary {
  std::size_t points = 0, computed = 0, failed = 0;
  double seconds = 0;
  std::vector<std::string> files;
};

void print_summary(const SweepOptions& options, const SweepPlan& plan, const Summary& s) {
  if (options.common.json) {
    fmt::print("{}\n", text_of_json(nlohmann::ordered_json{{"schema", "tactus.sweep-summary/2"},
                                                           {"plan", plan.name},
                                                           {"points", s.points},
                                                           {"computed", s.computed},
                                                           {"failed", s.failed},
                                                           {"time_s", s.seconds},
                                                           {"files", s.files}}));
    return;
  }
  if (options.common.quiet) return;
  Table table;
  table.heading({"sweep " + plan.name, "number"});
  table.row({"  points of the plan", fmt::to_string(s.points)});
  table.row({"  there before", fmt::to_string(s.points - s.computed - s.failed)});
  table.row({"  computed now", fmt::to_string(s.computed)});
  table.row({"  failed", fmt::to_string(s.failed)});
  table.row({"  time [s]", fmt::format("{:.1f}", s.seconds)});
  table.print(stdout);
  for (const std::string& file : s.files) fmt::print("  {}\n", shown_path(file));
}

Outcome run(const SweepOptions& options) {
  if (std::getenv(kInsideSweep) != nullptr)
    return refuse("a sweep cannot run within a sweep", "Use other commands than sweep in the plan.");
  TACTUS_TRY(const auto plan, load_plan(options.plan));
  const std::string folder = options.folder.empty() ? "out/" + plan.name : options.folder;
  if (options.list) {
    print_commands(plan, folder);
    return {};
  }
  const auto begin = std::chrono::steady_clock::now();
  setenv(kInsideSweep, "1", 1);  // for the commands of the plan; no thread is running yet
  TACTUS_TRY(auto results, SweepResults::open(folder, plan));
  TACTUS_CHECK(make_inputs(plan, folder, options.common.progress()));

  Summary summary{.points = plan.points(), .files = {folder + "/points.csv", folder + "/context.json"}};
  std::optional<Failure> first;
  {
    const std::size_t before = results.rows(plan).size();
    Progress progress("sweep " + plan.name, plan.points() - before, options.common.progress());
    Workers workers(plan, results, progress);
    workers.run(options.jobs > 0 ? options.jobs : std::max(1u, std::thread::hardware_concurrency()));
    summary.failed = workers.failed();
    summary.computed = workers.missing() - summary.failed;
    if (summary.failed > 0) first = workers.first_failure();
  }
  if (!first) {  // plots are of whole tables
    TACTUS_CHECK(results.sort(plan));
    TACTUS_TRY(auto drawn, draw_plots(plan, results));
    summary.files.insert(summary.files.end(), drawn.begin(), drawn.end());
    if (drawn.size() < plan.plots.size()) fmt::print(stderr, "note: {}\n", kNoGnuplot);
  }
  summary.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  print_summary(options, plan, summary);
  if (!first) return {};
  return refuse(fmt::format("{} of {} points failed, the first one:\n       {}", summary.failed, summary.points, first->text),
                first->remedy.empty() ? "Correct the cause and run the sweep again; finished points are kept." : first->remedy);
}

}  // namespace

void setup_sweep(Command& app, Action& action) {
  auto options = std::make_shared<SweepOptions>();
  Command& command = app.add_command("sweep", "Run a command over a grid of parameters into a table and figures");
  command.add_option("PLAN", options->plan, "TOML file: command, parameters, measures and figures")->type_name("")->required();
  command.add_option("-o,--output", options->folder, "Folder of the results; an existing one is resumed [out/NAME]")
      ->type_name("DIR");
  command.add_option("-j,--jobs", options->jobs, "Points computed in parallel [one per core]; give 1 where times matter")
      ->check(whole_number(1, 1024))
      ->type_name("N");
  command.add_flag("--list", options->list, "Print the commands without running them");
  add_report_options(command, options->common);
  command.footer(
      "A stopped sweep resumes when it is started again; finished points are kept.\n"
      "A plan is a program: its commands may write any file. Check a plan that you did not write with --list first.\n"
      "Examples:\n"
      "  tactus sweep reports/plans/deadband.toml\n"
      "  tactus sweep reports/plans/deadband.toml -o results/deadband -j 1");
  on_chosen<SweepOptions>(command, action, options, run);
}

}  // namespace tactus::cli
