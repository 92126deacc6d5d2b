// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/commands.h"

#include <fmt/format.h>

#include <tactus/base/shown.h>
#include <tactus/trace/resampler.h>
#include <tactus/trace/trace_file.h>
#include "cli/options/units.h"
#include "cli/report/report.h"
#include "cli/report/trace_ending.h"

namespace tactus::cli {
namespace {

struct ResampleOptions {
  std::string input, output;
  std::uint32_t rate = 1000;
  double gap = 0.1;  // [s]
  CommonOptions common;
};

Outcome write_due(Resampler& resampler, TraceFrame& frame, TraceWriter& writer, const ResampleOptions& options, Report& report) {
  while (resampler.next(frame)) {
    if (const auto written = writer.write(frame); !written)
      return refuse(options.output, place_of_tick(frame.tick), written.error());
    report.ticks.add(frame.tick);
  }
  return {};
}

Outcome resample(TraceReader& reader, Resampler& resampler, TraceWriter& writer, const ResampleOptions& options, Report& report) {
  Progress progress("resample", reader.frame_count(), options.common.progress());
  TraceFrame in, out;
  for (std::uint64_t read = 0;; ++read) {
    const auto more = reader.next(in);
    if (!more) return refuse(options.input, more.error());
    if (!*more) {
      resampler.end();
      TACTUS_CHECK(write_due(resampler, out, writer, options, report));
      return check_ending(options.input, reader, read);
    }
    const auto worked = report.timings[0].times.measure([&] {
      resampler.add(in);
      return write_due(resampler, out, writer, options, report);
    });
    TACTUS_CHECK(worked);
    progress.update(read + 1);
  }
}

Outcome run(const ResampleOptions& options) {
  TACTUS_CHECK(check_no_terminal(options.output));
  auto reader = open_trace(options.input);
  if (!reader) return tl::unexpected(reader.error());
  if (reader->info().shows_past)
    return refuse(shown_path(options.input) + ": a client's trace, whose ticks are those of the server",
                  "Resample the recordings that it was made from.");
  TACTUS_TRY(auto output, OutputFile::create(options.output, options.common.existing(), {options.input}));
  Resampler resampler(reader->info(), options.rate, options.gap);
  auto writer = TraceWriter::create(output.working_path(), resampler.info());
  if (!writer) return refuse(options.output, writer.error());
  Report report{.command = "resample", .files = {{"trace", options.input}, {"resampled", options.output}}};
  report.timings = {{"resample", "resample, per tick read"}};
  TACTUS_CHECK(resample(*reader, resampler, *writer, options, report));
  if (report.ticks.count() == 0)
    return refuse(shown_path(options.input) + ": too short for a tick at this rate", "Give a higher --rate.");
  if (const auto finished = writer->finish(); !finished) return refuse(options.output, finished.error());
  TACTUS_CHECK(output.keep());
  report.describe(resampler.info());
  print(report, options.common, beside(options.output));
  return {};
}

}  // namespace

void setup_resample(Command& app, Action& action) {
  auto options = std::make_shared<ResampleOptions>();
  Command& command = app.add_command("resample", "Write a trace at another rate");
  command.add_option("TRACE", options->input, "Trace to resample (MCAP), - is standard input")->type_name("")->required();
  command.add_option("-o,--output", options->output, "Trace to write (MCAP), - is standard output")
      ->required()
      ->type_name("FILE");
  command.add_option("--rate", options->rate, "Ticks per second")
      ->check(whole_number(1, 1'000'000))
      ->show_default()
      ->type_name("HZ");
  add_quantity(command, "--gap", options->gap, Dimension::time, "A pause longer than this stays one [100ms]");
  add_output_options(command, options->common);
  command.footer(
      "Positions, velocities and forces follow straight lines between samples, rotations arcs; contacts, buttons and shapes\n"
      "are those of the sample before. Nothing is filtered.\n"
      "Example:\n  tactus resample handwriting.mcap --rate 1000 -o at-1kHz.mcap");
  on_chosen<ResampleOptions>(command, action, options, run);
}

}  // namespace tactus::cli
