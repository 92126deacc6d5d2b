// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <optional>
#include <string_view>
#include <utility>

#include "cli/commands/commands.h"
#include "cli/live/device_choice.h"
#include "cli/live/device_report.h"
#include "cli/live/felt_recording.h"
#include "cli/options/units.h"
#include "cli/output.h"
#include "cli/report/json.h"

namespace tactus::cli {
namespace {

constexpr double kUsualRate = 1000;  // [Hz]

struct PlayOptions {
  std::string trace, user, output;
  DeviceArguments device;
  Exerted exerted = Exerted::nothing;
  double stiffness = 200;  // [N/m]
  double duration = 0;     // [s] 0: until the recording ends
  CommonOptions common;
};

const char* name_of(Exerted exerted) {
  switch (exerted) {
    case Exerted::nothing:
      return "nothing";
    case Exerted::force:
      return "force";
    case Exerted::path:
      return "path";
  }
  return "";
}

Outcome check_exerted(const PlayOptions& options, const device::Capabilities& device) {
  TACTUS_CHECK(check_place(device));
  TACTUS_CHECK(check_force(options.device, device));
  if (options.exerted == Exerted::nothing || device.force_axes > 0) return {};
  return refuse_arguments(fmt::format("--exert {}: {} takes no force", name_of(options.exerted), device.name), "Leave it out.");
}

tl::unexpected<Failure> refuse_recording(const PlayOptions& options, const Diagnostic& error) {
  if (error.error.rule != std::string_view("R-DEV-1")) return refuse(error);
  if (options.user.empty()) return refuse(options.trace + ": nobody is in this recording", "Play one with a user.");
  return refuse_arguments(fmt::format("--user {}: not a user of {}", options.user, options.trace),
                          "`tactus info` names those of a trace.");
}

Value value_of(const PlayOptions& options, const DeviceRun& run, const FeltRecording::Distance& distance) {
  Value out = Json{{"schema", "tactus.play/1"},
                   {"recording", options.trace},
                   {"exerted", name_of(options.exerted)},
                   {"distance", {{"mean_m", distance.mean}, {"largest_m", distance.largest}}}};
  add_to(out, run);
  return out;
}

Outcome run(const PlayOptions& options) {
  const std::vector<std::string> others{options.trace, replayed_file(options.device)};
  if (!options.output.empty()) TACTUS_CHECK(OutputFile::check_free(options.output, options.common.existing(), others));
  auto recording =
      device::Recording::read(options.trace, {.user = options.user, .pace = options.device.pace, .loops = options.device.loops});
  if (!recording) return refuse_recording(options, recording.error());
  TACTUS_TRY(auto chosen, open_device(options.device, nullptr, 0));
  const device::Capabilities& can = chosen.device->capabilities();
  TACTUS_CHECK(check_exerted(options, can));
  std::optional<OutputFile> output;
  if (!options.output.empty()) {
    TACTUS_TRY(auto created, OutputFile::create_growing(options.output, options.common.existing(), others));
    output.emplace(std::move(created));
  }
  FeltRecording felt(*std::move(recording), options.exerted, options.stiffness);
  const DevicePlan plan{.path = output ? output->working_path() : "",
                        .shown_path = options.output,
                        .command = "play",
                        .backend = options.device.backend(),
                        .servo = {.rate = can.rate > 0 ? can.rate : kUsualRate, .limits = options.device.limits()},
                        .duration = options.duration};
  DeviceLoop loop(plan, *chosen.device, felt);
  const Outcome worked = run_attended(loop, options.common);
  const DeviceRun run{can, loop.outcomes(), options.output, plan.servo.rate};
  if (!worked) {
    if (output && run.outcomes.last_tick < 0) output->discard();
    return failed(worked.error(), run);
  }
  if (output) TACTUS_CHECK(output->keep());
  print(value_of(options, run, felt.distance()), "play", options.common);
  return check_complete(run);
}

}  // namespace

void setup_play(Command& app, Action& action) {
  auto options = std::make_shared<PlayOptions>();
  Command& command = app.add_command("play", "Play a recording on a force-feedback device: its path, or the forces that it felt");
  command.add_option("TRACE", options->trace, "The recording (MCAP)")->type_name("")->required();
  command.add_option("--user", options->user, "Whose hand, if there are several [the first]")->type_name("NAME");
  add_device_options(command, options->device);
  command
      .add_option(
          "--exert",
          [&exerted = options->exerted](const std::string& name) {
            exerted = name == "path" ? Exerted::path : name == "force" ? Exerted::force : Exerted::nothing;
          },
          "What the device does: nothing, path (a spring draws the hand along), or force (what that hand felt) [nothing]")
      ->one_of({"nothing", "path", "force"})
      ->type_name("WHAT");
  command.add_option("--stiffness", options->stiffness, "Of the spring, in newtons per metre")
      ->check(number(1, 10'000))
      ->show_default()
      ->type_name("N/M");
  add_quantity(command, "--duration", options->duration, Dimension::time, "End after this long [when the recording ends]")
      ->check(above_zero(Dimension::time));
  command.add_option("-o,--output", options->output, "Trace to write of what the hand did (MCAP), in the recording's frame")
      ->type_name("FILE");
  add_output_options(command, options->common);
  command.footer(
      "Nothing is exerted without --exert. The recording begins where the handle is; q ends it. Recorded forces are right only\n"
      "where the hand was: hold the handle, and begin with a small --force-limit.\n"
      "Examples:\n  tactus play hand.mcap --device falcon --exert path --pace 0.5\n"
      "  tactus play hand.mcap --device openhaptics --exert force --force-limit 1N -o felt.mcap");
  on_chosen<PlayOptions>(command, action, options, run);
}

}  // namespace tactus::cli
