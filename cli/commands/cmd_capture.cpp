// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "cli/commands/commands.h"
#include "cli/live/device_choice.h"
#include "cli/live/device_report.h"
#include "cli/live/felt_scene.h"
#include "cli/options/units.h"
#include "cli/output.h"
#include "cli/report/json.h"

namespace tactus::cli {
namespace {

struct CaptureOptions {
  std::string output, scene, user, subject, remarks;
  DeviceArguments device;
  double rate = 0;      // [Hz] 0: the device's
  double duration = 0;  // [s] 0: until interrupted
  CommonOptions common;
};

tl::expected<std::optional<sim::Scene>, Failure> scene_of(const CaptureOptions& options, std::size_t& user) {
  if (options.scene.empty()) {
    if (!options.user.empty()) return refuse_arguments("--user: nothing is touched without --scene", "Give --scene.");
    return std::nullopt;
  }
  const auto path = sim::find_scene(options.scene);
  if (!path) return refuse(path.error());
  auto scene = sim::load_scene(*path);
  if (!scene) return refuse(scene.error());
  const auto found =
      options.user.empty() ? scene->users.begin() : std::ranges::find(scene->users, options.user, &sim::SceneUser::name);
  if (found == scene->users.end())
    return refuse_arguments(fmt::format("--user {}: not a user of {}", options.user, options.scene), "Give a user of the scene.");
  user = static_cast<std::size_t>(found - scene->users.begin());
  return std::optional(std::move(*scene));
}

/// With a scene the loop runs as fast as the scene, and a device that paces must.
Outcome check_rate(const CaptureOptions& options, const device::Capabilities& device) {
  if (options.scene.empty()) return {};
  const bool paces_otherwise = device.paces && std::abs(device.rate - sim::kTickRate) > 0.05 * sim::kTickRate;
  if (options.rate == 0 && !paces_otherwise) return {};
  return refuse_arguments(
      options.rate != 0 ? "--rate: a scene has 1000 ticks per second"
                        : fmt::format("--scene: {} has {:.0f} samples per second, a scene 1000 ticks", device.name, device.rate),
      "Capture without --rate, or without --scene.");
}

/// [Hz] as typed, the scene's, the device's own, or the usual.
double rate_of(const CaptureOptions& options, const device::Capabilities& device) {
  if (options.rate > 0) return options.rate;
  return !options.scene.empty() || device.rate == 0 ? sim::kTickRate : device.rate;
}

Outcome run(const CaptureOptions& options) {
  const std::vector<std::string> others{options.scene, replayed_file(options.device)};
  TACTUS_CHECK(OutputFile::check_free(options.output, options.common.existing(), others));
  std::size_t user = 0;
  TACTUS_TRY(const auto scene, scene_of(options, user));
  TACTUS_TRY(auto chosen, open_device(options.device, scene ? &*scene : nullptr, user));
  const device::Capabilities& can = chosen.device->capabilities();
  if (scene) TACTUS_CHECK(check_place(can));
  TACTUS_CHECK(check_rate(options, can));
  TACTUS_CHECK(check_force(options.device, can));
  TACTUS_TRY(auto output, OutputFile::create_growing(options.output, options.common.existing(), others));
  std::unique_ptr<Felt> felt = std::make_unique<FeltNothing>();
  if (scene) felt = std::make_unique<FeltScene>(*scene, user, options.device.seed, chosen);
  const DevicePlan plan{.path = output.working_path(),
                        .shown_path = options.output,
                        .command = "capture",
                        .backend = options.device.backend(),
                        .subject = options.subject,
                        .remarks = options.remarks,
                        .servo = {.rate = rate_of(options, can), .limits = options.device.limits()},
                        .duration = options.duration};
  DeviceLoop loop(plan, *chosen.device, *felt);
  const Outcome worked = run_attended(loop, options.common);
  const DeviceRun run{can, loop.outcomes(), options.output, plan.servo.rate};
  if (!worked) {
    if (run.outcomes.last_tick < 0) output.discard();
    return failed(worked.error(), run);
  }
  TACTUS_CHECK(output.keep());
  Value report = Json{{"schema", "tactus.capture/1"}};
  add_to(report, run);
  print(report, "capture", options.common);
  return check_complete(run);
}

}  // namespace

void setup_capture(Command& app, Action& action) {
  auto options = std::make_shared<CaptureOptions>();
  Command& command = app.add_command("capture", "Record what a hand does on a force-feedback device, and let it feel a scene");
  command.add_option("-o,--output", options->output, "Trace to write (MCAP)")->type_name("FILE")->required();
  add_device_options(command, options->device);
  command.add_option("--scene", options->scene, "What the hand touches, simulated here at 1 kHz [nothing: motion alone]")
      ->type_name("SCENE");
  command
      .add_option("--user", options->user, "The user of the scene whose hand it is [the first]; the others have virtual hands")
      ->type_name("NAME");
  command.add_option("--rate", options->rate, "Ticks per second, of a device that does not pace [its own]")
      ->check(number(1, 10'000))
      ->type_name("HZ");
  add_quantity(command, "--duration", options->duration, Dimension::time, "End after this long [until q or Ctrl-C]")
      ->check(above_zero(Dimension::time));
  command.add_option("--subject", options->subject, "Who it is, for the trace")->type_name("TEXT");
  command.add_option("--remarks", options->remarks, "Anything else, for the trace")->type_name("TEXT");
  add_output_options(command, options->common);
  command.footer(
      "While it runs, each key marks the tick, and q ends it. A device's own axes become x to the right, y away from the user, z "
      "up;\n"
      "with --scene its middle is where the scene has the user begin. Any other HID device is recorded report by report, by its "
      "path.\n"
      "Example:\n  tactus capture -o hand.mcap --scene rotate-push-lift --subject 7\n"
      "  tactus capture -o hand.mcap --device falcon --firmware nvent.bin\n"
      "  tactus capture -o glove.mcap --device hid:/dev/hidraw3");
  on_chosen<CaptureOptions>(command, action, options, run);
}

}  // namespace tactus::cli
