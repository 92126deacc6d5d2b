// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <vector>

#include <tactus/trace/csv_reader.h>
#include <tactus/trace/trace_file.h>
#include "cli/commands/commands.h"
#include "cli/laboratory/cmd_bench.h"
#include "cli/options/options_codec.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "cli/report/figures.h"
#include "cli/report/json_parts.h"
#include "cli/report/table.h"
#include "lab/study/signals.h"

namespace tactus::cli {
namespace {

using Json = nlohmann::ordered_json;
using sim::study::Signal;
using sim::study::SignalResult;

struct SignalBenchOptions {
  std::vector<std::string> traces;
  std::string directory;
  CommonOptions common;
};

/// A recording and what became of it.
struct Recording {
  std::string name;
  TraceInfo info{};
  TickSpan ticks{};
  std::vector<SignalResult> results{};

  double seconds() const { return per(static_cast<double>(ticks.length()), info.tick_rate); }
};

tl::expected<Recording, Failure> study(const std::string& path, const CommonOptions& common) {
  auto reader = TraceReader::open(path);
  if (!reader) return refuse(path, reader.error());
  Recording out{.name = path.substr(path.rfind('/') + 1), .info = reader->info()};
  auto signals = sim::study::SignalStudy::create(out.info);
  if (!signals) return refuse(path, signals.error());
  Progress progress(out.name, reader->frame_count().value_or(0), common.progress());
  TraceFrame frame;
  for (;;) {
    const auto more = reader->next(frame);
    if (!more) return refuse(path, more.error());
    if (!*more) break;
    if (const auto added = signals->add(frame); !added) return refuse(path, place_of_tick(frame.tick), added.error());
    out.ticks.add(frame.tick);
    progress.update(out.ticks.count());
  }
  out.results = signals->results();
  if (out.results.empty())
    return refuse_arguments(path + ": no device moves and no force acts",
                            "Give a trace with a user: `tactus import csv --map device=x,y,z` or `--map force=x,y,z` makes one.");
  return out;
}

const char* name_of(Signal signal) {
  constexpr const char* kNames[]{"device", "contact", "force"};
  return kNames[static_cast<std::size_t>(signal)];
}
const char* title_of(Signal signal) {
  constexpr const char* kTitles[]{"position within", "force in contact and position within", "force within"};
  return kTitles[static_cast<std::size_t>(signal)];
}
/// Whether a row begins a table: of another user or signal than the one before.
bool begins(const std::vector<SignalResult>& results, std::size_t row) {
  return row == 0 || results[row].user != results[row - 1].user || results[row].signal != results[row - 1].signal;
}

std::vector<std::string> columns_of(Signal signal) {
  const char* unit = signal == Signal::force ? "N" : "mm";
  return {title_of(signal),
          "packets/s",
          "payload [kbit/s]",
          fmt::format("largest error [{}]", unit),
          fmt::format("RMS [{}]", unit),
          "of the permitted",
          "samples over",
          "time per sample"};
}
std::vector<std::string> cells_of(const Recording& recording, const SignalResult& r) {
  const double scale = r.signal == Signal::force ? 1 : 1e3, seconds = recording.seconds();
  return {r.name,
          fmt::format("{:.1f}", per(static_cast<double>(r.packets), seconds)),
          fmt::format("{:.2f}", 8e-3 * per(static_cast<double>(r.bytes), seconds)),
          significant(scale * r.largest),
          significant(scale * r.rms),
          fmt::format("{:.3f}", r.worst),
          fmt::to_string(r.over),
          duration(r.time)};
}
std::string heading_of(const Recording& recording, const SignalResult& r) {
  return recording.name + ": " + recording.info.users[r.user].name;
}

void print_tables(const std::vector<Recording>& recordings) {
  for (const Recording& recording : recordings) {
    Table table;
    for (std::size_t i = 0; i < recording.results.size(); ++i) {
      const SignalResult& r = recording.results[i];
      std::vector<std::string> row = cells_of(recording, r);
      if (begins(recording.results, i)) {
        std::vector<std::string> head = columns_of(r.signal);
        head[0] = heading_of(recording, r) + ", " + head[0];
        table.heading(std::move(head));
      }
      row[0] = "  " + row[0];
      table.row(std::move(row));
    }
    table.print(stdout);
    fmt::print("\n");
  }
}

std::string to_csv(const std::vector<Recording>& recordings) {
  std::string out =
      "recording,user,signal,within,samples,seconds,packets,payload_bytes,largest_error,rms_error,share_of_permitted,samples_"
      "over\n";
  for (const Recording& recording : recordings)
    for (const SignalResult& r : recording.results)
      out += fmt::format("{},{},{},{},{},{:.6g},{},{},{:.6g},{:.6g},{:.6g},{}\n", csv_field(recording.name),
                         csv_field(recording.info.users[r.user].name), name_of(r.signal), csv_field(r.name), r.samples,
                         recording.seconds(), r.packets, r.bytes, r.largest, r.rms, r.worst, r.over);
  return out;
}

Json to_json(const std::vector<Recording>& recordings) {
  Json out{{"schema", "tactus.signals/1"}, {"context", bench_context()}, {"recordings", Json::array()}};
  for (const Recording& recording : recordings) {
    const double seconds = recording.seconds();
    Json one{{"name", recording.name}, {"tick_rate_hz", recording.info.tick_rate}, {"seconds", seconds}, {"rows", Json::array()}};
    for (const SignalResult& r : recording.results)
      one["rows"].push_back({{"user", recording.info.users[r.user].name},
                             {"signal", name_of(r.signal)},
                             {"within", r.name},
                             {"samples", r.samples},
                             {"packets_per_s", per(static_cast<double>(r.packets), seconds)},
                             {"payload_bit_per_s", 8 * per(static_cast<double>(r.bytes), seconds)},
                             {"largest_error", r.largest},
                             {"rms_error", r.rms},
                             {"share_of_permitted", r.worst},
                             {"samples_over", r.over},
                             {"time_per_sample_s", r.time}});
    out["recordings"].push_back(std::move(one));
  }
  return out;
}

std::string to_markdown(const std::vector<Recording>& recordings) {
  const auto context = bench_context();
  std::string out = fmt::format(
      "# Devices and forces on their way\n\n"
      "`tactus bench signals` on {} ({}, {} build). All but the times is deterministic.\n\n"
      "Each sample goes through the coders of [spec/65](../../spec/65-signal.md), over a network that loses nothing; devices are "
      "acknowledged {:.0f} ms later. What the other end shows is compared with the sample at once. *Of the permitted*: the "
      "largest "
      "error as a share of what is permitted at that sample; *samples over*: those off by more; *every sample*: each is sent, "
      "and "
      "the grid is what is permitted; *time per sample*: at the sender, median. The same rows are in `signals.csv`, in SI "
      "units.\n",
      context.at("machine"), context.at("compiler"), context.at("build"), 1e3 * sim::study::SignalStudy::kRoundTrip);
  for (const Recording& recording : recordings)
    for (std::size_t i = 0; i < recording.results.size(); ++i) {
      const SignalResult& r = recording.results[i];
      if (i == 0)
        out += fmt::format("\n## {}\n\n{} samples at {} Hz, {:.1f} s.\n", recording.name, recording.ticks.count(),
                           recording.info.tick_rate, recording.seconds());
      if (begins(recording.results, i))
        out += fmt::format("\n| {}: {} |\n|---|---:|---:|---:|---:|---:|---:|---:|\n", recording.info.users[r.user].name,
                           fmt::join(columns_of(r.signal), " | "));
      out += fmt::format("| {} |\n", fmt::join(cells_of(recording, r), " | "));
    }
  return out;
}

Outcome run(const SignalBenchOptions& options) {
  const std::string &folder = options.directory, csv = folder + "/signals.csv", report = folder + "/report.md";
  const auto existing = options.common.existing();
  if (!folder.empty()) {
    TACTUS_CHECK(make_folder(folder));
    for (const std::string& file : {csv, report}) TACTUS_CHECK(OutputFile::check_free(file, existing));
  }
  std::vector<Recording> recordings;
  for (const std::string& trace : options.traces) {
    TACTUS_TRY(auto recording, study(trace, options.common));
    recordings.push_back(std::move(recording));
  }
  if (!folder.empty()) {
    TACTUS_CHECK(write_file(csv, to_csv(recordings), existing));
    TACTUS_CHECK(write_file(report, to_markdown(recordings), existing));
  }
  if (options.common.json) fmt::print("{}\n", text_of_json(to_json(recordings)));
  else if (!options.common.quiet) print_tables(recordings);
  return {};
}

}  // namespace

void setup_bench_signals(Command& group, Action& action) {
  auto options = std::make_shared<SignalBenchOptions>();
  Command& command = group.add_command("signals", "What the devices and forces of recordings cost on their way");
  command.add_option("TRACE", options->traces, "Recordings with users")->type_name("")->required();
  command.add_option("-o,--output", options->directory, "Folder for report.md and CSV")->type_name("DIR");
  add_output_options(command, options->common);
  command.footer(
      "Examples:\n"
      "  tactus bench signals truth.mcap\n"
      "  tactus import csv pen.csv --time t --map device=x,y,0 -o pen.mcap && tactus bench signals pen.mcap -o signals");
  on_chosen<SignalBenchOptions>(command, action, options, run);
}

}  // namespace tactus::cli
