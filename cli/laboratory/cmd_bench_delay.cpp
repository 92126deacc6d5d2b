// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include <tactus/trace/csv_reader.h>
#include "cli/commands/commands.h"
#include "cli/figure/plot.h"
#include "cli/laboratory/cmd_bench.h"
#include "cli/laboratory/workers.h"
#include "cli/options/options_codec.h"
#include "cli/options/units.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "cli/report/json_parts.h"
#include "cli/report/table.h"
#include "lab/study/delay_sweep.h"

namespace tactus::cli {
namespace {

using Json = nlohmann::ordered_json;
namespace study = sim::study;
using study::DelayNumbers;

std::vector<std::string> all_scenes() {
  return {"push-cube", "rotate-6dof", "rotate-push-lift", "jenga-press", "jenga-together", "jenga-against", "msd-1d",
#ifdef TACTUS_HAS_FEM
          "membrane"
#endif
  };
}

struct DelayBenchOptions {
  std::vector<std::string> scenes = all_scenes();
  std::string round_trips = "25ms,50ms,75ms,100ms,150ms,200ms,300ms";
  std::uint32_t seeds = 3, first_seed = 1;
  double duration = 8;  // [s]
  std::string directory;
  CommonOptions common;
};

/// What a job yields.
struct Run {
  FlatError failure{};
  study::DelayResult result{};
};

/// A user of a scene at one round trip, network and kind of client: one number per seed.
struct Row {
  std::string scene, user;
  sim::Microseconds round_trip;
  bool varies;
  study::Clients clients;
  std::vector<DelayNumbers> seeds{};
};

struct Quantity {
  const char *name, *title;  // in CSV and JSON, in tables
  float DelayNumbers::*of;
  double scale;
  int digits;
};
constexpr Quantity kQuantities[]{
    {"mean_force_over_percent", "mean force [%]", &DelayNumbers::mean, 100, 0},
    {"peak_force_over_percent", "peak [%]", &DelayNumbers::peak, 100, 0},
    {"outside_10_percent_of_force_percent", "outside 10 % [%]", &DelayNumbers::outside, 100, 0},
    {"least_energy_mj", "energy [mJ]", &DelayNumbers::energy, 1e3, 0},
    {"same_motion_force_error_percent", "force error [%]", &DelayNumbers::force_error, 100, 1},
    {"same_motion_seen_away_rms_mm", "seen away [mm]", &DelayNumbers::seen, 1e3, 2},
    {"same_motion_seen_away_95_mm", "95 % of it", &DelayNumbers::most_seen, 1e3, 2},
    {"same_motion_users_apart_95_mm", "users apart [mm]", &DelayNumbers::apart, 1e3, 2},
};

struct Spread {
  double mean = NAN, worst = NAN;  // worst: farthest from zero
};
Spread spread(const Row& row, const Quantity& q) {
  double sum = 0, worst = 0;
  int count = 0;
  for (const DelayNumbers& numbers : row.seeds) {
    const double value = q.scale * static_cast<double>(numbers.*q.of);
    if (!std::isfinite(value)) continue;
    sum += value;
    ++count;
    if (std::abs(value) >= std::abs(worst)) worst = value;
  }
  return count > 0 ? Spread{sum / count, worst} : Spread{};
}

std::string cell(const Row& row, const Quantity& q) {
  const auto [mean, worst] = spread(row, q);
  if (!std::isfinite(mean)) return "-";
  const auto number = [&](double value) {
    return fmt::format("{:.{}f}", std::abs(value) < 0.5 * std::pow(10, -q.digits) ? 0 : value, q.digits);
  };
  return row.seeds.size() > 1 ? fmt::format("{} ({})", number(mean), number(worst)) : number(mean);
}

double ms(sim::Microseconds time) { return 1e-3 * static_cast<double>(time); }
const char* network_of(const Row& row) { return row.varies ? "gamma" : "constant"; }

tl::expected<std::vector<sim::Scene>, Failure> load(const DelayBenchOptions& options) {
  std::vector<sim::Scene> out;
  for (const std::string& name : options.scenes) {
    const auto path = sim::find_scene(name);
    if (!path) return refuse(path.error());
    auto scene = sim::load_scene(*path);
    if (!scene) return refuse(scene.error());
    if (scene->users.empty() || scene->users.size() > study::kMostSweepUsers)
      return refuse_arguments(fmt::format("{}: {} users", name, scene->users.size()), "Give a scene of one or two users.");
    scene->duration = std::min(scene->duration, options.duration);
    out.push_back(std::move(*scene));
  }
  return out;
}

tl::expected<std::vector<sim::Microseconds>, Failure> round_trips_of(const std::string& typed) {
  std::vector<sim::Microseconds> out;
  for (std::size_t from = 0; from <= typed.size();) {
    const std::size_t end = std::min(typed.find(',', from), typed.size());
    const auto time = parse_quantity(std::string_view(typed).substr(from, end - from), Dimension::time);
    if (!time) return refuse_arguments("--round-trip: " + time.error(), "Give times such as 50ms,100ms.");
    if (!(time->value >= 1e-3 && time->value <= 1))
      return refuse_arguments(fmt::format("--round-trip: {} s", time->value), "Give times of 1ms to 1s.");
    out.push_back(std::llround(1e6 * time->value));
    from = end + 1;
  }
  return out;
}

struct Job {
  std::size_t scene;
  study::DelayPoint point;
};

std::vector<Job> jobs_of(const DelayBenchOptions& options, const std::vector<sim::Microseconds>& round_trips) {
  std::vector<Job> out;
  for (std::size_t scene = 0; scene < options.scenes.size(); ++scene)
    for (const bool varies : {false, true})
      for (const sim::Microseconds round_trip : round_trips)
        for (std::uint64_t seed = 0; seed < options.seeds; ++seed)
          out.push_back({scene, {.round_trip = round_trip, .varies = varies, .seed = options.first_seed + seed}});
  return out;
}

tl::expected<std::vector<Row>, Failure> run_all(const std::vector<sim::Scene>& scenes, const DelayBenchOptions& options) {
  TACTUS_TRY(const auto round_trips, round_trips_of(options.round_trips));
  const std::vector<Job> jobs = jobs_of(options, round_trips);
  Progress progress("bench delay", jobs.size(), options.common.progress());
  const auto runs = run_in_workers<Run>(
      jobs.size(),
      [&](std::size_t i) {
        const auto result = study::run_point(scenes[jobs[i].scene], jobs[i].point);
        return result ? Run{{}, *result} : Run{FlatError::of(result.error().error, result.error().step), {}};
      },
      [&](std::size_t done) { progress.update(done); });
  if (!runs)
    return refuse_arguments("a worker process ended early", "Run the command again; give fewer scenes if memory is short.");
  std::vector<Row> rows;
  for (std::size_t i = 0; i < jobs.size(); i += options.seeds) {
    const sim::Scene& scene = scenes[jobs[i].scene];
    for (std::size_t user = 0; user < scene.users.size(); ++user)
      for (std::size_t c = 0; c < study::kClients.size(); ++c) {
        Row row{scene.name, scene.users[user].name, jobs[i].point.round_trip, jobs[i].point.varies, study::kClients[c]};
        for (std::size_t seed = 0; seed < options.seeds; ++seed) {
          const Run& run = (*runs)[i + seed];
          if (run.failure.failed)
            return refuse(options.scenes[jobs[i].scene], place_of_tick(run.failure.tick), run.failure.error());
          row.seeds.push_back(run.result[c][user]);
        }
        rows.push_back(std::move(row));
      }
  }
  return rows;
}

/// One table per scene, user and network.   out  by begins(): rows of the same
bool begins(const std::vector<Row>& rows, std::size_t i) {
  return i == 0 || rows[i].scene != rows[i - 1].scene || rows[i].user != rows[i - 1].user || rows[i].varies != rows[i - 1].varies;
}

/// Rows as tables want them: by scene, user, network, round trip, clients.
std::vector<Row> in_order(std::vector<Row> rows) {
  const auto scene_first = rows;
  std::ranges::stable_sort(rows, [&](const Row& a, const Row& b) {
    const auto place = [&](const Row& row) {
      return std::ranges::find_if(scene_first, [&](const Row& r) { return r.scene == row.scene && r.user == row.user; }) -
             scene_first.begin();
    };
    const auto pa = place(a), pb = place(b);
    return pa != pb ? pa < pb : a.varies < b.varies;
  });
  return rows;
}

std::vector<std::string> heading(const Row& row) {
  std::vector<std::string> out{fmt::format("{}, {}, {}", row.scene, row.user, network_of(row)), "clients"};
  for (const Quantity& q : kQuantities) out.emplace_back(q.title);
  return out;
}
std::vector<std::string> cells(const Row& row) {
  std::vector<std::string> out{fmt::format("{:g} ms", ms(row.round_trip)), study::name(row.clients)};
  for (const Quantity& q : kQuantities) out.push_back(cell(row, q));
  return out;
}

void print_table(const std::vector<Row>& rows) {
  Table table;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (begins(rows, i)) table.heading(heading(rows[i]));
    table.row(cells(rows[i]));
  }
  table.print(stdout);
}

std::string to_csv(const std::vector<Row>& rows, std::uint32_t first_seed) {
  std::string out = "scene,user,round_trip_ms,network,clients,seed";
  for (const Quantity& q : kQuantities) out += fmt::format(",{}", q.name);
  out += "\n";
  for (const Row& row : rows)
    for (std::size_t seed = 0; seed < row.seeds.size(); ++seed) {
      out += fmt::format("{},{},{},{},{},{}", csv_field(row.scene), csv_field(row.user), ms(row.round_trip), network_of(row),
                         csv_field(study::name(row.clients)), first_seed + seed);
      for (const Quantity& q : kQuantities) out += fmt::format(",{:.5g}", q.scale * static_cast<double>(row.seeds[seed].*q.of));
      out += "\n";
    }
  return out;
}

Json to_json(const std::vector<Row>& rows) {
  Json out{{"schema", "tactus.delay/1"}, {"context", bench_context()}, {"rows", Json::array()}};
  for (const Row& row : rows) {
    Json one{{"scene", row.scene},
             {"user", row.user},
             {"round_trip_ms", ms(row.round_trip)},
             {"network", network_of(row)},
             {"clients", study::name(row.clients)}};
    for (const Quantity& q : kQuantities)
      if (const auto [mean, worst] = spread(row, q); std::isfinite(mean)) one[q.name] = {{"mean", mean}, {"worst", worst}};
    out["rows"].push_back(std::move(one));
  }
  return out;
}

/// The command that makes the same report.
std::string command_of(const DelayBenchOptions& options) {
  const DelayBenchOptions usual;
  std::string out = "tactus bench delay";
  if (options.scenes != usual.scenes) out += fmt::format(" {}", fmt::join(options.scenes, " "));
  if (options.round_trips != usual.round_trips) out += fmt::format(" --round-trip {}", options.round_trips);
  if (options.seeds != usual.seeds) out += fmt::format(" --seeds {}", options.seeds);
  if (options.first_seed != usual.first_seed) out += fmt::format(" --first-seed {}", options.first_seed);
  if (options.duration != usual.duration) out += fmt::format(" --duration {:g}s", options.duration);
  return out;
}

std::string to_markdown(const std::vector<Row>& rows, const DelayBenchOptions& options, bool has_figure) {
  const auto context = bench_context();
  std::string out = fmt::format(
      "# Delay, and three kinds of clients\n\n"
      "`{} -o DIR` ({}, {} build). All of it is deterministic.\n\n"
      "Each user is behind a network of their own, *constant* or *gamma* (half of the round trip gamma distributed, a new value "
      "each "
      "0.5 s, behind adaptive playout); every state and device sample is sent, so that only the delay differs. Clients: *none* "
      "show the "
      "past as it comes; *stiffness* render it softer (thesis 4.2.3, 4.3.3); *simulation* simulate the scene themselves, and the "
      "server "
      "corrects them; *10 % off* do so with a mass, friction, stiffness and Young's modulus 10 % too high.\n\n"
      "Mean over the seeds and, in parentheses, the seed farthest from zero. Hands that feel the force, against the same hands "
      "without delay: "
      "*mean* and *peak* (99 %) *force* over that without delay, time *outside* of +-10 % of it, least *energy* that the device "
      "has "
      "put in. The same motion, that of the hands without delay: RMS of the *force error* over RMS of the force; how far *away* "
      "from its place "
      "without delay the touched point is *seen* (RMS, 95th percentile); how far *apart* two users see the object (95th "
      "percentile). The same rows, "
      "seed by seed, are in `delay.csv`.\n",
      command_of(options), context.at("compiler"), context.at("build"));
  if (has_figure) out += "\n![error of the force and of what is seen, over the round trip](delay.svg)\n";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (begins(rows, i)) {
      out += fmt::format("\n| {} |\n|---|---", fmt::join(heading(rows[i]), " | "));
      for ([[maybe_unused]] const Quantity& q : kQuantities) out += "|---:";
      out += "|\n";
    }
    out += fmt::format("| {} |\n", fmt::join(cells(rows[i]), " | "));
  }
  return out;
}

/// Of the first user of each scene, constant delay: round trip, then the error of the force and what is seen away, by clients.
Plot plot_of(const std::vector<Row>& rows, const DelayBenchOptions& options) {
  Plot plot{
      .name = "delay", .program = "delay-sweep", .width = 960, .height = 60 + 230 * static_cast<int>(options.scenes.size())};
  std::vector<std::string> scenes;
  PlotData data{"errors", {}};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].varies) continue;
    if (scenes.empty() || scenes.back() != rows[i].scene) {
      if (!scenes.empty()) data.rows.insert(data.rows.end(), {{}, {}});
      scenes.push_back(rows[i].scene);
    } else if (rows[i].user != rows[i - 1].user) {
      while (i + 1 < rows.size() && rows[i + 1].scene == scenes.back()) ++i;
      continue;
    }
    if (rows[i].clients != study::Clients::plain) continue;
    std::vector<double> row{ms(rows[i].round_trip)};
    for (const std::size_t q : {std::size_t{4}, std::size_t{6}})
      for (std::size_t c = 0; c < study::kClients.size(); ++c) row.push_back(spread(rows[i + c], kQuantities[q]).mean);
    data.rows.push_back(std::move(row));
  }
  plot.data.push_back(std::move(data));
  plot.set("scenes", scenes);
  return plot;
}

Outcome run(const DelayBenchOptions& options) {
  const bool writes = !options.directory.empty();
  if (writes) {
    TACTUS_CHECK(make_folder(options.directory));
    for (const char* file : {"/report.md", "/delay.csv", "/delay.svg"})
      TACTUS_CHECK(OutputFile::check_free(options.directory + file, options.common.existing()));
  }
  TACTUS_TRY(const auto scenes, load(options));
  TACTUS_TRY(auto made, run_all(scenes, options));
  const std::vector<Row> rows = in_order(std::move(made));
  if (writes) {
    TACTUS_TRY(const auto figure, draw(plot_of(rows, options), options.directory, options.common.existing()));
    if (figure == Drawn::no) fmt::print(stderr, "note: {}\n", kNoGnuplot);
    TACTUS_CHECK(write_file(options.directory + "/delay.csv", to_csv(rows, options.first_seed), options.common.existing()));
    TACTUS_CHECK(write_file(options.directory + "/report.md", to_markdown(rows, options, figure == Drawn::yes),
                            options.common.existing()));
  }
  if (options.common.json) fmt::print("{}\n", text_of_json(to_json(rows)));
  else if (!options.common.quiet) print_table(rows);
  return {};
}

}  // namespace

void setup_bench_delay(Command& group, Action& action) {
  auto options = std::make_shared<DelayBenchOptions>();
  Command& command = group.add_command("delay", "What delay does to force and picture, and what clients can do about it");
  command.add_option("SCENE", options->scenes, "Scenes of one or two users [those that come with Tactus]")->type_name("");
  command.add_option("--round-trip", options->round_trips, "Round trips")->show_default()->type_name("TIME,..");
  command.add_option("--seeds", options->seeds, "Hands and networks: so many seeds")
      ->check(whole_number(1, 1000))
      ->show_default()
      ->type_name("N");
  command.add_option("--first-seed", options->first_seed, "The first of them")
      ->check(whole_number(0, 1'000'000))
      ->show_default()
      ->type_name("N");
  add_quantity(command, "--duration", options->duration, Dimension::time, "At most so much of each scene [8s]")
      ->check(within(Dimension::time, "100ms", "3600s"));
  command.add_option("-o,--output", options->directory, "Folder for report.md, CSV and figure")->type_name("DIR");
  add_output_options(command, options->common);
  command.footer("Example:\n  tactus bench delay push-cube --round-trip 50ms,100ms,200ms -o delay");
  on_chosen<DelayBenchOptions>(command, action, options, run);
}

}  // namespace tactus::cli
