// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/commands/commands.h"
#include "cli/commands/input.h"
#include "cli/figure/time_figure.h"
#include "cli/report/report.h"

namespace tactus::cli {
namespace {

struct ExportFigureOptions {
  std::string input, output = "-";
  CommonOptions common;
};

/// What the figure shows, and in the report how much there was to see.
tl::expected<MotionFigure, Failure> read_all(MotionSource& source, const ExportFigureOptions& options, Report& report) {
  MotionFigure figure(source.info());
  ReadProgress progress("export", source.trace(), options.common.progress());
  TraceFrame frame;
  while (true) {
    TACTUS_TRY(const bool more, source.next(frame));
    if (!more) break;
    figure.add(frame);
    report.ticks.add(frame.tick);
    progress.update(report.ticks.count());
  }
  for (const SourcePacket& packet : source.packets()) figure.add_packet(packet.tick, packet.bytes);
  return figure;
}

Outcome run_export_figure(const ExportFigureOptions& options) {
  TACTUS_TRY(auto source, MotionSource::open(options.input, options.common.progress()));
  TACTUS_TRY(auto output, OutputFile::create(options.output, options.common.existing(), {options.input}));
  TACTUS_TRY(const auto stream, output.open());
  Report report{.command = "export figure",
                .files = {{source.is_stream() ? "stream" : "trace", options.input}, {"figure", options.output}}};
  report.describe(source.info());
  TACTUS_TRY(const auto figure, read_all(source, options, report));
  const std::string heading = std::filesystem::path(options.input).filename().string();
  *stream << text_of_figure(Figure{heading, figure.panels()});
  TACTUS_CHECK(output.keep());
  if (options.common.json || options.output != "-") print(report, options.common, beside(options.output));
  return {};
}

}  // namespace

void setup_export_figure(Command& group, Action& action) {
  auto options = std::make_shared<ExportFigureOptions>();
  Command& command = group.add_command("figure", "The numbers that `tactus plot` draws, as JSON");
  command.add_option("FILE", options->input, "Trace (MCAP), or stream, which is decoded; - is standard input")
      ->type_name("")
      ->required();
  command.add_option("-o,--output", options->output, "JSON to write [standard output]")->type_name("FILE");
  add_output_options(command, options->common);
  command.footer(
      "Positions, speeds, forces, deformation, and of a stream its packets, each in a panel. Of a long recording a line holds "
      "the\n"
      "extremes.\n"
      "Examples:\n"
      "  tactus export figure push.mcap -o push.json\n"
      "  tactus plot push.json -o push.pdf");
  on_chosen<ExportFigureOptions>(command, action, options, run_export_figure);
}

}  // namespace tactus::cli
