// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <filesystem>

#include <tactus/base/shown.h>
#include "cli/commands/commands.h"
#include "cli/commands/input.h"
#include "cli/figure/motion_figure.h"
#include "cli/report/report.h"

namespace tactus::cli {
namespace {

struct PlotOptions {
  std::string input, output;
  CommonOptions common;
};

Outcome run(const PlotOptions& options) {
  TACTUS_CHECK(check_plot_option(options.output, options.common, {options.input}));
  TACTUS_TRY(auto source, MotionSource::open(options.input));
  Report report{.command = "plot",
                .files = {{source.is_stream() ? "stream" : "trace", options.input}, {"figure", options.output}}};
  report.describe(source.info());
  MotionFigure figure(source.info());
  Progress progress("plot", source.frame_count(), options.common.progress());
  TraceFrame frame;
  while (true) {
    TACTUS_TRY(const bool more, source.next(frame));
    if (!more) break;
    figure.add(frame);
    report.ticks.add(frame.tick);
    progress.update(report.ticks.count());
  }
  const std::string heading = std::filesystem::path(options.input).filename().string();
  for (const SourcePacket& packet : source.packets()) figure.add_packet(packet.tick, packet.bytes);
  TACTUS_CHECK(draw_over_time(options.output, heading, figure.panels(), options.common));
  print(report, options.common, Destination::standard_output);
  return {};
}

}  // namespace

void setup_plot(Command& app, Action& action) {
  auto options = std::make_shared<PlotOptions>();
  Command& command = app.add_command("plot", "Draw a trace or a stream over time");
  command.add_option("FILE", options->input, "Trace (MCAP), or stream, which is decoded; - is standard input")
      ->type_name("")
      ->required();
  command.add_option("-o,--output", options->output, "Figure to draw (SVG)")
      ->required()
      ->check(svg_file())
      ->type_name("FILE.svg");
  add_output_options(command, options->common);
  command.footer(
      "Positions, speeds, forces, deformation, and of a stream its packets, each in a panel. Of a long recording a line shows "
      "the\n"
      "extremes.\n"
      "Examples:\n"
      "  tactus plot push.mcap -o push.svg\n"
      "  tactus plot push.tct -o packets.svg");
  on_chosen<PlotOptions>(command, action, options, run);
}

}  // namespace tactus::cli
