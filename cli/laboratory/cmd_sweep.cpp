// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include <tactus/base/shown.h>
#include "cli/figure/plot.h"
#include "cli/laboratory/sweep_plan.h"
#include "cli/laboratory/sweep_plots.h"
#include "cli/laboratory/sweep_results.h"
#include "cli/laboratory/sweep_run.h"
#include "cli/laboratory/sweep_table.h"
#include "cli/options/options_codec.h"
#include "cli/report/json_parts.h"
#include "cli/report/table.h"

namespace tactus::cli {
namespace {

constexpr const char* kInsideSweep = "TACTUS_INSIDE_SWEEP";  // variable of the environment that a sweep's commands see

struct SweepOptions {
  std::string plan, folder;
  std::vector<std::string> inputs;
  std::optional<SweepShard> shard;
  unsigned jobs = 0;  // 0: one per core
  bool list = false, merge = false;
  CommonOptions common;
};

/// "3/8"
std::optional<SweepShard> parse_shard(const std::string& typed) {
  SweepShard out;
  const char* end = typed.data() + typed.size();
  const auto index = std::from_chars(typed.data(), end, out.index);
  if (index.ec != std::errc() || index.ptr == end || *index.ptr != '/') return std::nullopt;
  const auto count = std::from_chars(index.ptr + 1, end, out.count);
  const bool is_whole = count.ec == std::errc() && count.ptr == end;
  return is_whole && out.index >= 1 && out.index <= out.count ? std::optional(out) : std::nullopt;
}

struct Summary {
  std::size_t points = 0, computed = 0, failed = 0;
  double seconds = 0;
  double point_seconds = 0;     // of the command of a point, the middle one; 0: none was computed
  std::size_t points_left = 0;  // of the whole plan
  std::vector<std::string> files{};

  double seconds_left() const { return point_seconds * static_cast<double>(points_left); }
};

void print_summary(const SweepOptions& options, const SweepPlan& plan, const Summary& s) {
  if (options.common.json) {
    fmt::print("{}\n", text_of_json(nlohmann::ordered_json{{"schema", "tactus.sweep-summary/3"},
                                                           {"plan", plan.name},
                                                           {"points", s.points},
                                                           {"computed", s.computed},
                                                           {"failed", s.failed},
                                                           {"time_s", s.seconds},
                                                           {"point_p50_s", s.point_seconds},
                                                           {"points_left", s.points_left},
                                                           {"work_left_s", s.seconds_left()},
                                                           {"files", s.files}}));
    return;
  }
  if (options.common.quiet) return;
  Table table;
  table.heading({"sweep " + plan.name, "number"});
  table.row({options.shard ? "  points of the shard" : "  points of the plan", fmt::to_string(s.points)});
  table.row({"  there before", fmt::to_string(s.points - s.computed - s.failed)});
  table.row({"  computed now", fmt::to_string(s.computed)});
  table.row({"  failed", fmt::to_string(s.failed)});
  table.row({"  time [s]", fmt::format("{:.1f}", s.seconds)});
  table.row({"  time of a point, median [s]", fmt::format("{:.2f}", s.point_seconds)});
  if (s.points_left > 0) {
    table.row({"  points of the plan that are missing here", fmt::to_string(s.points_left)});
    table.row({"  time of these on one core, estimated [s]", fmt::format("{:.0f}", s.seconds_left())});
  }
  table.print(stdout);
  for (const std::string& file : s.files) fmt::print("  {}\n", shown_path(file));
}

std::vector<std::size_t> points_of(const SweepPlan& plan, const std::optional<SweepShard>& shard) {
  std::vector<std::size_t> out;
  for (std::size_t point = 0; point < plan.points(); ++point)
    if (!shard || plan.is_of(point, *shard)) out.push_back(point);
  return out;
}

void print_commands(const SweepPlan& plan, const SweepInputs& inputs, const std::vector<std::size_t>& points) {
  for (const auto& words : inputs.commands(plan, points)) fmt::print("{}\n", as_typed(words));
  for (const std::size_t point : points)
    fmt::print("{}\n", as_typed(plan.words(point, [&](const std::string& file) { return inputs.path_of(file); })));
}

Outcome refuse_missing(const SweepPlan& plan, const std::string& folder, const std::vector<std::size_t>& missing) {
  const auto values = plan.values(missing.front());
  return refuse(fmt::format("{}: {} of {} points are missing, the first one is {}", shown_path(folder), missing.size(),
                            plan.points(), shown(fmt::format("{}", fmt::join(values, ", ")))),
                "Run the shards that were stopped again, or leave --merge out: the missing points are then computed here.");
}

/// Tables in the plan's order, and figures: of whole sweeps alone.
Outcome finish(const SweepPlan& plan, SweepResults& results, Summary& summary) {
  TACTUS_CHECK(results.sort(plan));
  TACTUS_TRY(const auto tables, write_table(plan, results));
  TACTUS_TRY(const auto drawn, draw_plots(plan, results));
  summary.files.insert(summary.files.end(), tables.begin(), tables.end());
  summary.files.insert(summary.files.end(), drawn.files.begin(), drawn.files.end());
  for (const std::string& note : drawn.notes) fmt::print(stderr, "note: {}\n", note);
  return {};
}

Outcome run(const SweepOptions& options) {
  if (std::getenv(kInsideSweep) != nullptr)
    return refuse("a sweep cannot run within a sweep", "Use other commands than sweep in the plan.");
  TACTUS_TRY(const auto plan, load_plan(options.plan));
  const std::string folder = options.folder.empty() ? "out/" + plan.name : options.folder;
  TACTUS_TRY(const auto inputs, SweepInputs::open(plan, folder, options.inputs));
  const auto points = points_of(plan, options.shard);
  if (options.list) {
    print_commands(plan, inputs, points);
    return {};
  }
  const auto begin = std::chrono::steady_clock::now();
  setenv(kInsideSweep, "1", 1);  // for the commands of the plan; no thread is running yet
  TACTUS_TRY(auto results, SweepResults::open(options.shard ? shard_folder(folder, *options.shard) : folder, plan));
  if (!options.shard) TACTUS_CHECK(results.absorb_shards(plan));
  auto missing = points;
  std::erase_if(missing, [&](std::size_t point) { return results.has(plan.values(point)); });
  if (options.merge && !missing.empty()) return refuse_missing(plan, folder, missing);

  const unsigned jobs = options.jobs > 0 ? options.jobs : std::max(1u, std::thread::hardware_concurrency());
  TACTUS_TRY(const auto digests, inputs.make(plan, missing, jobs, options.common.progress()));
  TACTUS_CHECK(results.bind_inputs(plan, digests));
  const auto failures = compute(plan, inputs, missing, results, jobs, options.common.progress());

  Summary summary{.points = points.size(), .computed = missing.size() - failures.size(), .failed = failures.size()};
  for (const char* file : {"/points.csv", "/times.csv", "/context.json"}) summary.files.push_back(results.folder() + file);
  if (const auto seconds = results.seconds(); !seconds.empty()) summary.point_seconds = spread_of(seconds).median;
  summary.points_left = plan.points() - points.size() + failures.size();
  if (failures.empty() && !options.shard) TACTUS_CHECK(finish(plan, results, summary));
  summary.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  print_summary(options, plan, summary);
  if (failures.empty()) return {};
  const Failure& first = failures.begin()->second;
  return refuse(fmt::format("{} of {} points failed, the first one:\n       {}", summary.failed, summary.points, first.text),
                first.remedy.empty() ? "Correct the cause and run the sweep again; finished points are kept." : first.remedy);
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
  command
      .add_option("--inputs", options->inputs,
                  "Inputs that are there already: a folder with files of the plan, or NAME=FILE; may be repeated")
      ->one_value()
      ->type_name("DIR|NAME=FILE");
  Option* shard = command
                      .add_option(
                          "--shard", [options](const std::string& typed) { options->shard = parse_shard(typed); },
                          "Compute the I-th of N parts of the points, from 1, into DIR/shards: one per machine")
                      ->check([](const std::string& typed) {
                        return parse_shard(typed) ? "" : shown(typed) + ": give I/N, I from 1 to N: 3/8";
                      })
                      ->type_name("I/N");
  command.add_flag("--merge", options->merge, "Compute nothing: put what the shards computed into one table, once all is there")
      ->excludes(shard);
  command.add_flag("--list", options->list, "Print the commands without running them");
  add_report_options(command, options->common);
  command.footer(
      "A stopped sweep or shard resumes when it is started again; finished points are kept.\n"
      "A plan is a program: its commands may write any file. Check a plan that you did not write with --list first.\n"
      "Examples:\n"
      "  tactus sweep reports/plans/deadband.toml\n"
      "  tactus sweep reports/plans/deadband.toml -o results/deadband -j 1\n"
      "  tactus sweep reports/plans/deadband.toml --inputs my-recordings\n"
      "  parallel tactus sweep reports/plans/deadband.toml -j 1 --shard {}/8 ::: $(seq 8)\n"
      "  tactus sweep reports/plans/deadband.toml --merge");
  on_chosen<SweepOptions>(command, action, options, run);
}

}  // namespace tactus::cli
