// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include <tactus/device/real_time.h>
#include "cli/commands/commands.h"
#include "cli/live/device_choice.h"
#include "cli/live/device_loop.h"
#include "cli/live/rendered.h"
#include "cli/options/options_codec.h"
#include "cli/options/units.h"
#include "cli/output.h"
#include "cli/report/json.h"

namespace tactus::cli {

// ==== cmd devices ====

namespace {

struct DevicesOptions {
  CommonOptions common;
};

struct Kind {
  std::string name, title;
  device::Backend::Listing listing;
  bool is_hardware = false;
};

/// What needs no hardware stands first.
std::vector<Kind> look() {
  std::vector<Kind> kinds{{"virtual", "A simulated hand: virtual, or virtual:SCENE", {}},
                          {"replay", "The hand of a recording: replay:TRACE", {}}};
  for (const auto& backend : backends()) kinds.push_back({backend->name(), backend->title(), backend->list(), true});
  return kinds;
}

Value devices_value(const std::vector<Kind>& kinds, const device::RealTime& real_time) {
  Json out{{"schema", "tactus.devices/1"}, {"backends", Json::array()}, {"privileges", Json::array()}};
  for (const Kind& kind : kinds) {
    Json devices = Json::array();
    for (const device::Capabilities& can : kind.listing.devices)
      devices.push_back({{"name", can.name},
                         {"model", can.model},
                         {"serial", can.serial},
                         {"force_axes", can.force_axes},
                         {"nominal_force_N", can.nominal_force},
                         {"rate_Hz", can.rate},
                         {"only_reports", can.report_descriptor.has_value()}});
    Json backend{{"name", kind.name}, {"title", kind.title}};
    if (kind.is_hardware && kind.listing.missing.empty()) backend["connected"] = !devices.empty();
    backend["devices"] = std::move(devices);
    backend["missing"] = kind.listing.missing;
    out["backends"].push_back(std::move(backend));
  }
  for (const device::Privilege& privilege : real_time.privileges())
    out["privileges"].push_back({{"name", privilege.name}, {"granted", privilege.granted}, {"remedy", privilege.remedy}});
  return out;
}

Outcome run_devices(const DevicesOptions& options) {
  const device::RealTime real_time;
  const std::vector<Kind> kinds = look();
  print(devices_value(kinds, real_time), "devices", options.common);
  return {};
}

}  // namespace

void setup_devices(Command& app, Action& action) {
  auto options = std::make_shared<DevicesOptions>();
  Command& command = app.add_command("devices", "List force-feedback devices, what they lack, and how to get it");
  add_report_options(command, options->common);
  command.footer("It opens no device and loads no firmware.");
  on_chosen<DevicesOptions>(command, action, options, run_devices);
}

// ==== cmd capture ====

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
  scale_device(*found, options.device);
  return std::optional(std::move(*scene));
}

/// With a scene the loop runs as fast as the scene, and a device with a clock of its own must.
Outcome check_rate(const CaptureOptions& options, const device::Capabilities& device) {
  if (options.scene.empty()) return {};
  const bool has_other_rate = device.has_clock && std::abs(device.rate - sim::kTickRate) > 0.05 * sim::kTickRate;
  if (options.rate == 0 && !has_other_rate) return {};
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

Outcome run_capture(const CaptureOptions& options) {
  const std::vector<std::string> others{options.scene, replayed_file(options.device)};
  TACTUS_CHECK(OutputFile::check_free(options.output, options.common.existing(), others));
  std::size_t user = 0;
  TACTUS_TRY(const auto scene, scene_of(options, user));
  TACTUS_TRY(auto chosen, open_device(options.device, scene ? &*scene : nullptr, user));
  const device::Capabilities& can = chosen.device->capabilities();
  if (scene) TACTUS_CHECK(check_position(can));
  TACTUS_CHECK(check_rate(options, can));
  TACTUS_CHECK(check_force(options.device, can));
  TACTUS_TRY(auto output, OutputFile::create_growing(options.output, options.common.existing(), others));
  std::unique_ptr<Rendered> rendered = std::make_unique<RenderedNothing>();
  if (scene) rendered = std::make_unique<RenderedScene>(*scene, user, options.device.seed, chosen);
  const DevicePlan plan{.path = output.working_path(),
                        .shown_path = options.output,
                        .command = "capture",
                        .backend = options.device.backend(),
                        .subject = options.subject,
                        .remarks = options.remarks,
                        .servo = {.rate = rate_of(options, can), .limits = options.device.limits()},
                        .duration = options.duration};
  DeviceLoop loop(plan, *chosen.device, *rendered);
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
  add_scale(command, options->device);
  command.add_option("--scene", options->scene, "What the hand touches, simulated here at 1 kHz [nothing: motion alone]")
      ->type_name("SCENE");
  command
      .add_option("--user", options->user, "The user of the scene whose hand it is [the first]; the others have virtual hands")
      ->type_name("NAME");
  command.add_option("--rate", options->rate, "Ticks per second, of a device without a clock [its own]")
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
  on_chosen<CaptureOptions>(command, action, options, run_capture);
}

// ==== cmd play ====

namespace {

constexpr double kUsualRate = 1000;  // [Hz]

struct PlayOptions {
  std::string trace, user, output;
  DeviceArguments device;
  Exerted exerted = Exerted::nothing;
  double stiffness = 200;  // [N/m]
  double scale = 1;        // of the recording
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
  TACTUS_CHECK(check_position(device));
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

Value play_value(const PlayOptions& options, const DeviceRun& run, const RenderedRecording::Distance& distance) {
  Value out = Json{{"schema", "tactus.play/1"},
                   {"recording", options.trace},
                   {"exerted", name_of(options.exerted)},
                   {"distance", {{"mean_m", distance.mean}, {"largest_m", distance.largest}}}};
  add_to(out, run);
  return out;
}

Outcome run_play(const PlayOptions& options) {
  const std::vector<std::string> others{options.trace, replayed_file(options.device)};
  if (!options.output.empty()) TACTUS_CHECK(OutputFile::check_free(options.output, options.common.existing(), others));
  auto recording = device::Recording::read(
      options.trace, {.user = options.user, .playback_rate = options.device.playback_rate, .loops = options.device.loops});
  if (!recording) return refuse_recording(options, recording.error());
  TACTUS_TRY(auto chosen, open_device(options.device, nullptr, 0));
  const device::Capabilities& can = chosen.device->capabilities();
  TACTUS_CHECK(check_exerted(options, can));
  std::optional<OutputFile> output;
  if (!options.output.empty()) {
    TACTUS_TRY(auto created, OutputFile::create_growing(options.output, options.common.existing(), others));
    output.emplace(std::move(created));
  }
  RenderedRecording rendered(*std::move(recording), options.exerted, options.stiffness, options.scale);
  const DevicePlan plan{.path = output ? output->working_path() : "",
                        .shown_path = options.output,
                        .command = "play",
                        .backend = options.device.backend(),
                        .servo = {.rate = can.rate > 0 ? can.rate : kUsualRate, .limits = options.device.limits()},
                        .duration = options.duration};
  DeviceLoop loop(plan, *chosen.device, rendered);
  const Outcome worked = run_attended(loop, options.common);
  const DeviceRun run{can, loop.outcomes(), options.output, plan.servo.rate};
  if (!worked) {
    if (output && run.outcomes.last_tick < 0) output->discard();
    return failed(worked.error(), run);
  }
  if (output) TACTUS_CHECK(output->keep());
  print(play_value(options, run, rendered.distance()), "play", options.common);
  return check_complete(run);
}

}  // namespace

void setup_play(Command& app, Action& action) {
  auto options = std::make_shared<PlayOptions>();
  Command& command = app.add_command("play", "Play a recording on a force-feedback device: its path, or the forces of its hand");
  command.add_option("TRACE", options->trace, "The recording (MCAP)")->type_name("")->required();
  command.add_option("--user", options->user, "Whose hand, if there are several [the first]")->type_name("NAME");
  add_device_options(command, options->device);
  command
      .add_option(
          "--exert",
          [&exerted = options->exerted](const std::string& name) {
            exerted = name == "path" ? Exerted::path : name == "force" ? Exerted::force : Exerted::nothing;
          },
          "What the device does: nothing, path (a spring draws the hand along), or force (as rendered to that hand) [nothing]")
      ->one_of({"nothing", "path", "force"})
      ->type_name("WHAT");
  command.add_option("--stiffness", options->stiffness, "Of the spring, in newtons per metre")
      ->check(number(1, 10'000))
      ->show_default()
      ->type_name("N/M");
  command
      .add_option(
          "--scale", options->scale,
          "The hand of the recording moves so many times as far as the device, which exerts so many times less: that of its "
          "scene, or of the `capture` or `join` that made it")
      ->check(number(sim::kLeastDeviceScale, sim::kLargestDeviceScale))
      ->show_default()
      ->type_name("FACTOR");
  add_quantity(command, "--duration", options->duration, Dimension::time, "End after this long [when the recording ends]")
      ->check(above_zero(Dimension::time));
  command.add_option("-o,--output", options->output, "Trace to write of what the hand did (MCAP), in the recording's frame")
      ->type_name("FILE");
  add_output_options(command, options->common);
  command.footer(
      "Nothing is exerted without --exert. The recording begins where the handle is; q ends it. Recorded forces are right only\n"
      "where the hand was: hold the handle, and begin with a small --force-limit.\n"
      "Examples:\n  tactus play hand.mcap --device falcon --exert path --playback-rate 0.5\n"
      "  tactus play hand.mcap --device openhaptics --exert force --force-limit 1N -o played.mcap");
  on_chosen<PlayOptions>(command, action, options, run_play);
}

}  // namespace tactus::cli
