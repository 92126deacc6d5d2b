// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/commands.h"

#include <fmt/format.h>

#include <filesystem>

#include <tactus/base/shown.h>
#include <tactus/trace/trace_file.h>
#include "cli/report/report.h"

namespace tactus::cli {
namespace {

struct RecoverOptions {
  std::string input, output;
  CommonOptions common;
};

/// What can be read, and why the rest cannot.
struct Rescue {
  std::optional<Error> damage{};
  bool cut_short = false;
};

tl::expected<Rescue, Failure> copy(TraceReader& reader, TraceWriter& writer, const RecoverOptions& options, Report& report) {
  Progress progress("recover", reader.frame_count(), options.common.progress());
  TraceFrame frame;
  for (;;) {
    const auto more = report.timings[0].times.measure([&] { return reader.next(frame); });
    if (!more) return Rescue{.damage = more.error()};
    if (!*more) return Rescue{.cut_short = reader.cut_short()};
    if (const auto written = writer.write(frame); !written)
      return refuse(options.output, place_of_tick(frame.tick), written.error());
    report.ticks.add(frame.tick);
    progress.update(report.ticks.count());
  }
}

/// What was written is what was read.
Outcome read_back(const std::string& path, const RecoverOptions& options, const TickSpan& ticks) {
  auto reader = TraceReader::open(path);
  if (!reader) return refuse(options.output, reader.error());
  TraceFrame frame;
  TickSpan read;
  for (;;) {
    const auto more = reader->next(frame);
    if (!more) return refuse(options.output, more.error());
    if (!*more) break;
    read.add(frame.tick);
  }
  if (read.count() == ticks.count() && read.length() == ticks.length() && !reader->cut_short()) return {};
  return refuse(fmt::format("{}: {} of {} ticks can be read back", shown_path(options.output), read.count(), ticks.count()),
                "Write it to another disk.");
}

Outcome run(const RecoverOptions& options) {
  auto reader = TraceReader::open(options.input);
  if (!reader) return refuse(options.input, reader.error());
  TACTUS_TRY(auto output, OutputFile::create(options.output, options.common.existing(), {options.input}));
  auto writer = TraceWriter::create(output.working_path(), reader->info());
  if (!writer) return refuse(options.output, writer.error());
  Report report{.command = "recover", .files = {{"trace", options.input}, {"recovered", options.output}}};
  report.timings = {{"read"}};
  TACTUS_TRY(const Rescue rescue, copy(*reader, *writer, options, report));
  if (report.ticks.count() == 0 && rescue.damage) return refuse(options.input, *rescue.damage);
  if (report.ticks.count() == 0)
    return refuse(shown_path(options.input) + ": no whole tick is in it", "Nothing can be recovered.");
  if (const auto finished = writer->finish(); !finished) return refuse(options.output, finished.error());
  if (output.is_temporary()) TACTUS_CHECK(read_back(output.working_path(), options, report.ticks));
  TACTUS_CHECK(output.keep());
  report.describe(reader->info());
  if (rescue.damage)
    report.warnings.push_back(
        fmt::format("what comes after tick {} is damaged ({}) and lost", report.ticks.last(), rescue.damage->rule));
  else if (rescue.cut_short)
    report.warnings.push_back(
        fmt::format("the trace ends inside a chunk; what came after tick {} is lost, at most a second or 1 MiB "
                    "of messages if nothing else was cut off",
                    report.ticks.last()));
  else report.warnings.emplace_back("nothing is missing: the trace is whole");
  print(report, options.common, beside(options.output));
  return {};
}

}  // namespace

void setup_recover(Command& app, Action& action) {
  auto options = std::make_shared<RecoverOptions>();
  Command& command = app.add_command("recover", "Save what can be read of a trace that was cut or damaged");
  command.add_option("TRACE", options->input, "Trace that was not finished, or is damaged (MCAP)")->type_name("")->required();
  command.add_option("-o,--output", options->output, "Trace to write (MCAP)")->required()->type_name("FILE");
  add_output_options(command, options->common);
  command.footer(
      "Writes all ticks before the cut or the first damage, with an index, and reads them back.\n"
      "Example:\n  tactus recover crashed.mcap -o rescued.mcap");
  on_chosen<RecoverOptions>(command, action, options, run);
}

}  // namespace tactus::cli
