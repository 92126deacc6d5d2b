// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/commands.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include <tactus/base/shown.h>
#include <tactus/trace/trace_file.h>
#include "cli/options/units.h"
#include "cli/report/report.h"
#include "cli/report/trace_ending.h"

namespace tactus::cli {
namespace {

struct CutOptions {
  std::string input, output;
  double from = 0, to = std::numeric_limits<double>::infinity();  // [s]
  bool rebase = false;
  CommonOptions common;
};

/// The first tick at or after a time.
std::int64_t tick_at(double seconds, std::uint32_t rate) {
  const double tick = std::ceil(seconds * rate - 1e-6);
  return tick < 0x1p62 ? static_cast<std::int64_t>(tick) : std::int64_t{1} << 62;
}

/// A shape that was new before the cut is new at its first frame.
void begin_shapes(TraceFrame& frame) {
  for (DeformableSample& mesh : frame.meshes)
    for (const float u : mesh.displacements) mesh.updated = mesh.updated || u != 0;
}

Outcome copy(TraceReader& reader, TraceWriter& writer, const CutOptions& options, Report& report) {
  const std::uint32_t rate = reader.info().tick_rate;
  const std::int64_t from = tick_at(options.from, rate), to = tick_at(options.to, rate);
  Progress progress("cut", reader.frame_count(), options.common.progress());
  TraceFrame frame;
  std::optional<std::int64_t> base;
  for (std::uint64_t read = 1;; ++read) {
    const auto more = report.timings[0].times.measure([&] { return reader.next(frame); });
    if (!more) return refuse(options.input, more.error());
    if (!*more) return check_ending(options.input, reader, read - 1);
    progress.update(read);
    if (frame.tick < from) continue;
    if (frame.tick >= to) return {};
    if (!base) {
      base = options.rebase ? frame.tick : 0;
      begin_shapes(frame);
    }
    frame.tick -= *base;
    if (const auto written = writer.write(frame); !written)
      return refuse(options.output, place_of_tick(frame.tick), written.error());
    report.ticks.add(frame.tick);
  }
}

Outcome run(const CutOptions& options) {
  TACTUS_CHECK(check_no_terminal(options.output));
  if (options.to <= options.from) return refuse_arguments("--to: nothing lies between it and --from", "Give a later --to.");
  auto reader = open_trace(options.input);
  if (!reader) return tl::unexpected(reader.error());
  const TraceInfo& info = reader->info();
  if (options.rebase && info.shows_past)
    return refuse(shown_path(options.input) + ": a client's trace, whose ticks are those of the server", "Leave out --rebase.");
  TACTUS_TRY(auto output, OutputFile::create(options.output, options.common.existing(), {options.input}));
  auto writer = TraceWriter::create(output.working_path(), info);
  if (!writer) return refuse(options.output, writer.error());
  Report report{.command = "cut", .files = {{"trace", options.input}, {"cut", options.output}}};
  report.timings = {{"read", "read, per tick"}};
  TACTUS_CHECK(copy(*reader, *writer, options, report));
  if (report.ticks.count() == 0)
    return refuse(shown_path(options.input) + ": no tick lies between --from and --to",
                  "`tactus info` tells its first and last.");
  if (const auto finished = writer->finish(); !finished) return refuse(options.output, finished.error());
  TACTUS_CHECK(output.keep());
  report.describe(info);
  print(report, options.common, beside(options.output));
  return {};
}

}  // namespace

void setup_cut(Command& app, Action& action) {
  auto options = std::make_shared<CutOptions>();
  Command& command = app.add_command("cut", "Take a piece out of a trace");
  command.add_option("TRACE", options->input, "Trace to cut (MCAP), - is standard input")->type_name("")->required();
  command.add_option("-o,--output", options->output, "Trace to write (MCAP), - is standard output")
      ->required()
      ->type_name("FILE");
  add_quantity(command, "--from", options->from, Dimension::time, "Leave out what is before this time [the first tick]");
  add_quantity(command, "--to", options->to, Dimension::time, "Leave out this time and what is after it [the last tick]");
  command.add_flag("--rebase", options->rebase, "Let the first tick be tick 0");
  add_output_options(command, options->common);
  command.footer(
      "Times are those of the trace; they stay what they are unless --rebase is given.\n"
      "Example:\n  tactus cut push.mcap --from 2s --to 3.5s -o contact.mcap");
  on_chosen<CutOptions>(command, action, options, run);
}

}  // namespace tactus::cli
