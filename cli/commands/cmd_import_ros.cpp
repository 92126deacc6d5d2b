// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/trace_file.h>
#include "cli/commands/commands.h"
#include "cli/commands/input.h"
#include "cli/report/report.h"

namespace tactus::cli {
namespace {

struct ImportRosOptions {
  std::string input, output;
  ReadOptions read;
  CommonOptions common;
};

Outcome copy(TraceReader& reader, TraceWriter& writer, const ImportRosOptions& options, Report& report) {
  constexpr std::uint64_t kTicksBetween = 256;  // two looks at the bytes read
  Progress progress("import", reader.bytes().all, options.common.progress());
  TraceFrame frame;
  while (true) {
    if (report.ticks.count() % kTicksBetween == 0) progress.update(reader.bytes().read);
    TACTUS_TRY(const bool more, next_frame(reader, frame, options.input));
    if (!more) return {};
    if (const auto written = writer.write(frame); !written)
      return refuse(options.output, location_of_tick(frame.tick), written.error());
    report.ticks.add(frame.tick);
  }
}

Outcome run_import_ros(const ImportRosOptions& options) {
  TACTUS_CHECK(check_no_terminal(options.output));
  TACTUS_TRY(auto reader, open_trace(options.input, options.input, options.common.progress(), options.read));
  TACTUS_TRY(auto output, OutputFile::create(options.output, options.common.existing(), {options.input}));
  auto writer = TraceWriter::create(output.working_path(), reader.info());
  if (!writer) return refuse(options.output, writer.error());
  Report report{.command = "import ros", .files = {{"recording", options.input}, {"trace", options.output}}};
  TACTUS_CHECK(copy(reader, *writer, options, report));
  TACTUS_CHECK(check_ending(options.input, reader, report.ticks.count()));
  if (const auto finished = writer->finish(); !finished) return refuse(options.output, finished.error());
  report.describe(reader.info());
  report.add(reader.notes());
  TACTUS_CHECK(output.keep());
  print(report, options.common, beside(options.output));
  return {};
}

}  // namespace

void setup_import_ros(Command& group, Action& action) {
  auto options = std::make_shared<ImportRosOptions>();
  Command& command =
      group.add_command("ros", "A ROS 2 recording (MCAP, or a bag's folder): poses, odometry, transforms, twists and wrenches");
  command.add_option("FILE", options->input, "Recording to read, - is standard input")->type_name("")->required();
  command.add_option("-o,--output", options->output, "Trace to write (MCAP), - is standard output")
      ->type_name("FILE")
      ->required();
  command.add_option("--topic", options->read.topics, "Topic to take [all]; may be repeated")->one_value()->type_name("NAME");
  command.add_option("--skip", options->read.skip, "Topic not to read, or object to leave out; may be repeated")
      ->one_value()
      ->type_name("NAME");
  command.add_flag("--strict", options->read.strict, "Refuse a recording with a missing sample");
  add_quantity(command, "--gap", options->read.gap, Dimension::time,
               "Longest time to interpolate over [3 median gaps of a topic, 100ms to 10s]")
      ->check(within(Dimension::time, "1us", "1000s"));
  command.add_option("--rate", options->read.tick_rate, "Ticks per second [from the recording]")
      ->check(whole_number(1, 1000000))
      ->type_name("HZ");
  command
      .add_option(
          "--stamps",
          [&stamps = options->read.stamps](const std::string& name) {
            stamps = name == "header" ? RosStamps::header : name == "log" ? RosStamps::log : RosStamps::automatic;
          },
          "Times of the samples: header stamps, log times, or auto: log times unless these come in bursts [auto]")
      ->one_of({"header", "log", "auto"})
      ->type_name("WHICH");
  add_output_options(command, options->common);
  command.footer(
      "Examples:\n"
      "  tactus import ros grasp.mcap -o grasp-trace.mcap\n"
      "  tactus import ros grasp.mcap --topic /cup/pose --stamps header -o cup.mcap\n"
      "Every other command reads a recording with the defaults.");
  on_chosen<ImportRosOptions>(command, action, options, run_import_ros);
}

}  // namespace tactus::cli
