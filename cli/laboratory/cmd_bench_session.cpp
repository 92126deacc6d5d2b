// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include <tactus/trace/csv_reader.h>
#include <tactus/trace/trace_file.h>
#include "cli/commands/commands.h"
#include "cli/figure/plot.h"
#include "cli/laboratory/cmd_bench.h"
#include "cli/options/options_codec.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "cli/report/figures.h"
#include "cli/report/json_parts.h"
#include "cli/report/table.h"
#include "cli/report/traffic_layers.h"
#include "lab/study/session.h"

namespace tactus::cli {
namespace {

using Json = nlohmann::ordered_json;
using sim::study::Motion;
using sim::study::SessionResult;

struct SessionBenchOptions {
  std::vector<std::string> traces;
  bool brief = false;
  std::uint64_t seed = 1;
  std::string directory;
  TriggerArguments triggers;
  MeshArguments meshes;
  CommonOptions common;
};

/// A motion and what became of it.
struct Study {
  Motion motion;
  double chain = 0;  // [bit/s]
  std::vector<SessionResult> results{};
};

constexpr std::size_t kMostBytes = std::size_t{1} << 30;  // of a trace: all of it is in memory

std::size_t size_of(const TraceFrame& frame) {
  std::size_t out = sizeof frame + frame.objects.size() * sizeof(RigidSample) + frame.users.size() * sizeof(UserSample);
  for (const DeformableSample& mesh : frame.meshes) out += sizeof mesh + mesh.displacements.size() * sizeof(float);
  return out;
}

tl::expected<Motion, Failure> read_motion(const std::string& path, const SessionBenchOptions& options) {
  auto reader = TraceReader::open(path);
  if (!reader) return refuse(path, reader.error());
  Motion out{.name = path,
             .info = reader->info(),
             .frames = {},
             .sender = options.meshes.sender(options.triggers),
             .coding = options.meshes.coding(options.triggers)};
  out.name = out.name.substr(out.name.rfind('/') + 1);
  if (out.info.objects.empty() && out.info.meshes.empty())
    return refuse_arguments(path + ": no object moves", "Give a trace with rigid or deformable objects.");
  TraceFrame frame;
  std::size_t bytes = 0;
  for (;;) {
    const auto more = reader->next(frame);
    if (!more) return refuse(path, more.error());
    if (!*more) break;
    TraceFrame kept = frame;
    for (DeformableSample& mesh : kept.meshes)
      if (!mesh.updated) mesh.displacements = {};
    kept.tick = static_cast<std::int64_t>(out.frames.size());  // a gap in a recording takes no time here
    bytes += size_of(kept);
    if (bytes > kMostBytes)
      return refuse_arguments(fmt::format("{}: more than 1 GiB from tick {} on", path, frame.tick), "Give a shorter trace.");
    out.frames.push_back(std::move(kept));
  }
  if (out.frames.empty()) return refuse_arguments(path + ": no frame", "Give a trace with at least one tick.");
  return out;
}

tl::expected<Study, Failure> run_study(Motion motion, const SessionBenchOptions& options) {
  Study study{.motion = std::move(motion)};
  const auto chain = sim::study::chain_payload(study.motion);
  if (!chain) return refuse(study.motion.name, chain.error());
  study.chain = *chain;
  const auto cases = sim::study::session_cases(options.brief, options.seed);
  Progress progress(study.motion.name, cases.size(), options.common.progress());
  const double seconds = static_cast<double>(study.motion.frames.size()) / study.motion.info.tick_rate;
  for (const sim::study::SessionCase& one : cases) {
    const auto outage = std::ranges::max_element(one.link.outages, {}, &sim::Outage::end);
    const bool fits = outage == one.link.outages.end() || 1e-6 * static_cast<double>(outage->end) + 1 < seconds;
    if (fits) {
      auto result = sim::study::run_session(study.motion, one);
      if (!result) return refuse(study.motion.name, result.error());
      study.results.push_back(std::move(*result));
    }
    progress.update(study.results.size());
  }
  return study;
}

struct Figures {
  double over, longest, mean, behind;               // share, [ms]
  double widest, widened;                           // factor; share of the time
  double payload, against_chain, session, headers;  // [kbit/s] down
  double up;                                        // [kbit/s] all
};
Figures figures_of(const Study& study, const SessionResult& r) {
  const TrafficLayers down = sent_layers(r.down, r.seconds), up = sent_layers(r.up, r.seconds);
  return {.over = per(static_cast<double>(r.over), static_cast<double>(r.ticks)),
          .longest = 1e3 * r.longest,
          .mean = 1e3 * r.mean,
          .behind = 1e3 * r.behind,
          .widest = r.widened.widest,
          .widened = per(1e-6 * static_cast<double>(r.widened.time), r.seconds),
          .payload = 1e-3 * down.payload,
          .against_chain = per(down.payload, study.chain),
          .session = 1e-3 * down.session,
          .headers = 1e-3 * down.headers,
          .up = 1e-3 * up.all()};
}

constexpr const char* kColumns[]{"over a bound", "longest [ms]", "mean [ms]", "shown behind [ms]", "payload [kbit/s]",
                                 "x chain",      "session",      "UDP/IPv4",  "all down",          "all up"};

std::vector<std::string> cells_of(const Study& study, const SessionResult& r) {
  const Figures f = figures_of(study, r);
  const auto one = [](double value) { return fmt::format("{:.1f}", value); };
  const auto two = [](double value) { return fmt::format("{:.2f}", value); };
  return {fmt::format("{:.3f} %", 100 * f.over),
          one(f.longest),
          one(f.mean),
          one(f.behind),
          two(f.payload),
          two(f.against_chain),
          two(f.session),
          two(f.headers),
          two(f.payload + f.session + f.headers),
          two(f.up)};
}

/// What else there is to say of a case.
std::string remarks(const SessionResult& r) {
  std::string out;
  if (r.recovery > 0) out += fmt::format("; mended {:.0f} ms after it", 1e3 * r.recovery);
  if (r.widened.time > 0) {
    const double share = per(1e-6 * static_cast<double>(r.widened.time), r.seconds);
    out += fmt::format("; bounds up to {:.1f} times as wide for {:.0f} % of the time", r.widened.widest, 100 * share);
  }
  return out;
}

void print_table(const std::vector<Study>& studies) {
  for (const Study& study : studies) {
    Table table;
    std::string group;
    for (const SessionResult& r : study.results) {
      if (r.of.group != group) {
        std::vector<std::string> head{study.motion.name + ": " + r.of.group};
        head.insert(head.end(), std::begin(kColumns), std::end(kColumns));
        table.heading(std::move(head));
        group = r.of.group;
      }
      std::vector<std::string> row{"  " + r.of.name + remarks(r)};
      for (std::string& cell : cells_of(study, r)) row.push_back(std::move(cell));
      table.row(std::move(row));
    }
    table.print(stdout);
    fmt::print("\n");
  }
}

std::string to_csv(const std::vector<Study>& studies) {
  std::string out =
      "motion,group,case,ticks,over,over_position,over_rotation,over_force,over_shape,longest_s,mean_s,behind_s,down_payload_bit_"
      "per_s,"
      "chain_payload_bit_per_s,down_session_bit_per_s,down_udp_ipv4_bit_per_s,up_bit_per_s,recovery_s,"
      "bounds_widest,bounds_widened_s,wrong_states\n";
  for (const Study& study : studies)
    for (const SessionResult& r : study.results) {
      const Figures f = figures_of(study, r);
      out += fmt::format(
          "{},{},{},{},{},{},{},{},{},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.4g},{:.6g},{}\n",
          csv_field(study.motion.name), csv_field(r.of.group), csv_field(r.of.name), r.ticks, r.over, r.position, r.rotation,
          r.force, r.shape, r.longest, r.mean, r.behind, 1e3 * f.payload, study.chain, 1e3 * f.session, 1e3 * f.headers,
          1e3 * f.up, r.recovery, f.widest, f.widened * r.seconds, r.down.wrong_states);
    }
  return out;
}

Json to_json(const std::vector<Study>& studies) {
  Json out{{"schema", "tactus.session/1"}, {"context", bench_context()}, {"motions", Json::array()}};
  for (const Study& study : studies) {
    Json motion{{"name", study.motion.name},
                {"seconds", static_cast<double>(study.motion.frames.size()) / study.motion.info.tick_rate},
                {"chain_payload_bit_per_s", study.chain},
                {"cases", Json::array()}};
    for (const SessionResult& r : study.results) {
      const Figures f = figures_of(study, r);
      Json one{{"group", r.of.group},
               {"case", r.of.name},
               {"ticks", r.ticks},
               {"ticks_over",
                {{"any", r.over}, {"position", r.position}, {"rotation", r.rotation}, {"force", r.force}, {"shape", r.shape}}},
               {"longest_run_s", r.longest},
               {"mean_run_s", r.mean},
               {"shown_behind_s", r.behind},
               {"down_bit_per_s", {{"payload", 1e3 * f.payload}, {"session", 1e3 * f.session}, {"udp_ipv4", 1e3 * f.headers}}},
               {"up_bit_per_s", 1e3 * f.up},
               {"bounds_widened", {{"widest", f.widest}, {"for_s", f.widened * r.seconds}}},
               {"wrong_states", r.down.wrong_states},
               {"coding_cpu_s", r.server_time}};
      if (r.recovery > 0) one["recovery_s"] = r.recovery;
      motion["cases"].push_back(std::move(one));
    }
    out["motions"].push_back(std::move(motion));
  }
  return out;
}

std::uint64_t wrong_states(const std::vector<Study>& studies) {
  std::uint64_t out = 0;
  for (const Study& study : studies)
    for (const SessionResult& r : study.results) out += r.down.wrong_states;
  return out;
}

std::string to_markdown(const std::vector<Study>& studies, const SessionBenchOptions& options, bool has_figure) {
  const auto context = bench_context();
  std::string out = fmt::format(
      "# Sessions over networks that delay, lose and reorder\n\n"
      "`tactus bench session{}` on {} ({}, {} build), seed {}. All but the times is deterministic.\n\n"
      "A client looks on over the network of each row: round trip 40 ms and 5 % duplicates unless said, the same network up and "
      "down. "
      "What it shows is judged against the truth of the tick that it shows. *Over a bound*: share of the ticks in which a "
      "position, "
      "rotation, contact force or vertex is off by more than its bound as given, however wide it was at the time (of deformable "
      "objects without rigid ones, share of the ticks with a new shape); *longest*, *mean*: runs of such ticks; *shown behind*: "
      "how far the tick shown lies behind the server's, delay of the network included. *x chain*: the payload as a multiple of "
      "that of packets that build on the one before over a network that loses nothing. The same rows are in `session.csv`. "
      "Of the hashes of states that the clients told, {} were not those of the server.\n",
      options.brief ? " --short" : "", context.at("machine"), context.at("compiler"), context.at("build"), options.seed,
      wrong_states(studies));
  if (has_figure) out += "\n![share of ticks over a bound, over loss](session-loss.svg)\n";
  for (const Study& study : studies) {
    double coding = 0;
    for (const SessionResult& r : study.results) coding = std::max(coding, r.server_time);
    out += fmt::format(
        "\n## {}\n\n{} ticks at {} Hz; chain {:.2f} kbit/s. Coding a tick and its datagrams takes {} (median, CPU).\n",
        study.motion.name, study.motion.frames.size(), study.motion.info.tick_rate, 1e-3 * study.chain, duration(coding));
    std::string group;
    for (const SessionResult& r : study.results) {
      if (r.of.group != group) {
        group = r.of.group;
        out += fmt::format("\n| {} | {} |\n|---{}|\n", group, fmt::join(kColumns, " | "),
                           "|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:");
      }
      out += fmt::format("| {}{} | {} |\n", r.of.name, remarks(r), fmt::join(cells_of(study, r), " | "));
    }
  }
  return out;
}

/// Share of the ticks over a bound, over the loss, a line for each of the kinds of loss of the first motion.
Plot loss_plot(const Study& study) {
  Plot plot{.name = "session-loss", .program = "session-loss"};
  const auto add = [&](const char* block, const char* group) {
    PlotData data{block, {}};
    for (const SessionResult& r : study.results)
      if (r.of.group == group) data.rows.push_back({100 * r.of.link.loss, 100 * figures_of(study, r).over});
    plot.data.push_back(std::move(data));
  };
  add("plain", "loss");
  add("jitter", "loss, jitter up to 30 ms");
  add("bursts", "loss in bursts of 5");
  return plot;
}

Outcome write_report(const std::vector<Study>& studies, const SessionBenchOptions& options) {
  bool drawn = false;
  if (!options.brief) {
    TACTUS_TRY(const auto figure, draw(loss_plot(studies.front()), options.directory, options.common.existing()));
    drawn = figure == Drawn::yes;
    if (!drawn) fmt::print(stderr, "note: {}\n", kNoGnuplot);
  }
  TACTUS_CHECK(write_file(options.directory + "/session.csv", to_csv(studies), options.common.existing()));
  return write_file(options.directory + "/report.md", to_markdown(studies, options, drawn), options.common.existing());
}

Outcome run(const SessionBenchOptions& options) {
  const bool writes = !options.directory.empty();
  if (writes) {
    TACTUS_CHECK(make_folder(options.directory));
    for (const char* file : {"/report.md", "/session.csv"})
      TACTUS_CHECK(OutputFile::check_free(options.directory + file, options.common.existing()));
  }
  constexpr std::int64_t kTicks = 120'000, kFewTicks = 10'000;
  std::vector<Motion> motions{sim::study::swinging_bodies(options.brief ? kFewTicks : kTicks)};
  for (const std::string& trace : options.traces) {
    TACTUS_TRY(auto motion, read_motion(trace, options));
    motions.push_back(std::move(motion));
  }
  std::vector<Study> studies;
  for (Motion& motion : motions) {
    TACTUS_TRY(auto study, run_study(std::move(motion), options));
    studies.push_back(std::move(study));
  }
  if (writes) TACTUS_CHECK(write_report(studies, options));
  if (options.common.json) fmt::print("{}\n", text_of_json(to_json(studies)));
  else if (!options.common.quiet) print_table(studies);
  return {};
}

}  // namespace

void setup_bench_session(Command& group, Action& action) {
  auto options = std::make_shared<SessionBenchOptions>();
  Command& command = group.add_command("session", "How sessions bear networks that lose, delay and reorder");
  command.add_option("TRACE", options->traces, "Also study these recordings, at the bounds given by options")->type_name("");
  command.add_flag("--short", options->brief, "Run two cases over 10 s");
  command.add_option("--seed", options->seed, "Seed of the networks")
      ->check(whole_number(0, UINT64_MAX))
      ->show_default()
      ->type_name("N");
  command.add_option("-o,--output", options->directory, "Folder for report.md, CSV and figure")->type_name("DIR");
  add_encoder_options(command, options->triggers, options->meshes);
  add_output_options(command, options->common);
  command.footer("Example:\n  tactus bench session truth.mcap -p 4% --visual 0.3mm,2deg -o session");
  on_chosen<SessionBenchOptions>(command, action, options, run);
}

}  // namespace tactus::cli
