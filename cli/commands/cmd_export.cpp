// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/commands.h"

#include <tactus/trace/csv.h>
#include <tactus/trace/trace_file.h>
#include "cli/report/report.h"
#include "cli/report/trace_ending.h"

namespace tactus::cli {
namespace {

struct ExportOptions {
  std::string input, output = "-";
  CommonOptions common;
};

Outcome run(const ExportOptions& options) {
  auto reader = open_trace(options.input);
  if (!reader) return tl::unexpected(reader.error());
  TACTUS_TRY(auto output, OutputFile::create(options.output, options.common.existing(), {options.input}));
  TACTUS_TRY(const auto stream, output.open());
  Report report{.command = "export csv", .files = {{"trace", options.input}, {"table", options.output}}};
  report.timings = {{"export", "export, whole file"}};
  const auto rows = report.timings[0].times.measure([&] { return export_csv(*reader, *stream); });
  if (!rows) return refuse(stream->fail() ? options.output : options.input, rows.error());
  TACTUS_CHECK(check_ending(options.input, *reader, rows->count()));
  TACTUS_CHECK(output.keep());
  report.describe(reader->info());
  report.ticks = *rows;
  if (options.common.json || options.output != "-") print(report, options.common, beside(options.output));
  return {};
}

}  // namespace

void setup_export(Command& app, Action& action) {
  auto options = std::make_shared<ExportOptions>();
  Command& group = app.add_command("export", "Write a trace in another format");
  group.footer("Example:\n  tactus export csv push.mcap -o push.csv");
  Command& command = group.add_command(
      "csv", "One row per tick, numbers in the shortest digits that read back equal; rigid objects and users, no meshes");
  command.add_option("TRACE", options->input, "Trace to export (MCAP), - is standard input")->type_name("")->required();
  command.add_option("-o,--output", options->output, "CSV to write [standard output]")->type_name("FILE");
  add_output_options(command, options->common);
  command.footer(
      "A force that the trace does not know has no columns: serve is not told what a hand felt; join, capture and play know\n"
      "nothing else.\n"
      "Example:\n  tactus export csv push.mcap -o push.csv");
  on_chosen<ExportOptions>(command, action, options, run);
}

}  // namespace tactus::cli
