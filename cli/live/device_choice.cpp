// SPDX-License-Identifier: Apache-2.0
#include "cli/live/device_choice.h"

#include <fmt/format.h>
#include <algorithm>
#include <cerrno>
#include <utility>

#include <tactus/device/recording.h>
#include "cli/options/options_codec.h"
#include "cli/options/units.h"

#ifdef TACTUS_HAS_FALCON
#include <tactus/device/falcon/falcon_device.h>
#endif

#ifdef TACTUS_HAS_HID
#include <tactus/device/hid/hid_device.h>
#endif

#ifdef TACTUS_HAS_INVERSE3
#include <tactus/device/inverse3/inverse3_device.h>
#endif

#ifdef TACTUS_HAS_OPENHAPTICS
#include <tactus/device/openhaptics/openhaptics_device.h>
#endif

namespace tactus::cli {

// ==== virtual device ====

namespace {

using device::kMillisecond;

constexpr double kReach = 0.1;            // [m] of its workspace round the start: what the path needs, and more
constexpr std::int64_t kMostSteps = 100;  // at once: after a longer pause the hand goes on where it was

device::Capabilities capabilities_of(const sim::SceneUser& user) {
  const Vec3 reach{kReach, kReach, kReach};
  device::Capabilities out;
  out.name = "virtual";
  out.model = "virtual hand";
  out.senses = {.velocity = false, .buttons = user.senses().buttons};
  out.buttons = out.senses.buttons ? 1 : 0;
  out.force_axes = 3;
  out.low = user.start - reach;
  out.high = user.start + reach;
  out.nominal_force = out.peak_force = user.device.max_force;
  out.rate = sim::kTickRate;
  return out;
}

}  // namespace

VirtualDevice::VirtualDevice(const sim::Scene& scene, std::size_t user, std::uint64_t seed)
    : capabilities_(capabilities_of(scene.users[user])),
      hand_(scene.users[user], scene.users[user].grip, sim::hand_seed(seed, user)),
      watched_(scene.users[user].object < scene.objects.size() ? scene.objects[scene.users[user].object].pose : Pose{}) {
  sample_.position = scene.users[user].start;
}

Result<device::Reading> VirtualDevice::read(device::Time deadline) noexcept {
  if (begin_ < 0) begin_ = deadline - kMillisecond;
  const std::int64_t due = (deadline - begin_) / kMillisecond;
  ticks_ = std::max(ticks_, due - kMostSteps);
  for (; ticks_ < due; ++ticks_) sample_ = hand_.step(is_halted_ ? Vec3{} : force_, watched_);
  return device::Reading{.sample = sample_, .taken = begin_ + ticks_ * kMillisecond};
}

Result<void> VirtualDevice::write(const device::GuardedForce& force) noexcept {
  force_ = force.value();
  is_halted_ = false;
  return {};
}

// ==== device choice ====

namespace {

constexpr const char* kVirtual = "virtual";
constexpr const char* kReplay = "replay";
constexpr const char* kUsualScene = "push-1dof";

/// BACKEND, and what is behind the colon.
std::pair<std::string, std::string> split(const std::string& name) {
  const std::size_t colon = name.find(':');
  return {name.substr(0, colon), colon == std::string::npos ? "" : name.substr(colon + 1)};
}

std::string known_backends() {
  std::string text = fmt::format("{}, {}", kVirtual, kReplay);
  for (const auto& backend : backends()) text.append(", ").append(backend->name());
  return text;
}

tl::expected<sim::Scene, Failure> scene_of(const std::string& name) {
  const auto path = sim::find_scene(name.empty() ? kUsualScene : name);
  if (!path) return refuse(path.error());
  auto scene = sim::load_scene(*path);
  if (!scene) return refuse(scene.error());
  if (scene->users.empty())
    return refuse_arguments("--device " + std::string(kVirtual) + ": nobody is in the scene " + name, "Give a scene with users.");
  return std::move(*scene);
}

tl::expected<ChosenDevice, Failure> open_virtual(const DeviceArguments& arguments, const std::string& which,
                                                 const sim::Scene* scene, std::size_t user) {
  if (scene != nullptr && !which.empty())
    return refuse_arguments("--device " + arguments.name + ": the hand is that of --scene", "Give --device virtual and --user.");
  std::optional<sim::Scene> own;
  if (scene == nullptr) {
    TACTUS_TRY(own, scene_of(which));
    scene = &*own;
  }
  auto hand = std::make_unique<VirtualDevice>(*scene, user, arguments.seed);
  VirtualDevice* const seen = hand.get();
  return ChosenDevice{std::move(hand), seen};
}

}  // namespace

const std::vector<std::unique_ptr<device::Backend>>& backends() {
  static const auto all = [] {
    std::vector<std::unique_ptr<device::Backend>> out;
#ifdef TACTUS_HAS_FALCON
    out.push_back(std::make_unique<device::falcon::FalconBackend>());
#endif
#ifdef TACTUS_HAS_HID
    out.push_back(std::make_unique<device::hid::HidBackend>());
#endif
#ifdef TACTUS_HAS_OPENHAPTICS
    out.push_back(std::make_unique<device::openhaptics::OpenHapticsBackend>());
#endif
#ifdef TACTUS_HAS_INVERSE3
    out.push_back(std::make_unique<device::inverse3::Inverse3Backend>());
#endif
    return out;
  }();
  return all;
}

void add_device_options(Command& command, DeviceArguments& arguments) {
  command.add_option("--device", arguments.name, fmt::format("{}; `tactus devices` lists what is connected", known_backends()))
      ->show_default()
      ->type_name("BACKEND[:WHICH]");
#ifdef TACTUS_HAS_FALCON
  command.add_option("--firmware", arguments.open.firmware, "Of a falcon that was just switched on: the file with its firmware")
      ->type_name("FILE");
#endif
#ifdef TACTUS_HAS_OPENHAPTICS
  command.add_option(key("runtime"), arguments.open.runtime, "Of openhaptics: the vendor's library [libHD.so]")
      ->type_name("FILE");
#endif
#ifdef TACTUS_HAS_INVERSE3
  command
      .add_option(key("service"), arguments.open.service, "Of inverse3: the vendor's service on this machine [127.0.0.1:10001]")
      ->type_name("HOST:PORT");
#endif
  add_quantity(command, "--force-limit", arguments.force, Dimension::force, "Largest force [what the device can hold]")
      ->check(above_zero(Dimension::force));
  command.add_flag("--passivity", arguments.passivity, "Damp what the virtual object would give to the hand beyond what it took");
  command.add_option("--playback-rate", arguments.playback_rate, "Of a recording: 0.5 is half as fast")
      ->check(number(0.001, 1000))
      ->show_default()
      ->type_name("FACTOR");
  command.add_switch(key("loop"), arguments.loops, "Play a recording again and again [off]");
  command.add_option("--seed", arguments.seed, "Seed of a virtual hand")
      ->check(whole_number(0, UINT64_MAX))
      ->show_default()
      ->type_name("N");
}

void add_scale(Command& command, DeviceArguments& arguments) {
  command
      .add_option("--scale", arguments.scale,
                  "The probe moves so many times as far as the device, and the device exerts so many times less [the scene's]")
      ->check(number(sim::kLeastDeviceScale, sim::kLargestDeviceScale))
      ->type_name("FACTOR");
}

void scale_device(sim::SceneUser& user, const DeviceArguments& arguments) {
  if (arguments.scale == 0) return;
  user.device.max_force *= arguments.scale / user.device.scale;
  user.device.scale = arguments.scale;
}

std::string replayed_file(const DeviceArguments& arguments) {
  const auto [backend, which] = split(arguments.name);
  return backend == kReplay ? which : "";
}

Outcome check_force(const DeviceArguments& arguments, const device::Capabilities& device) {
  if (arguments.force <= device.nominal_force) return {};
  if (device.force_axes == 0)
    return refuse_arguments(fmt::format("--force-limit: {} takes no force", device.name), "Leave it out.");
  return refuse_arguments(fmt::format("--force-limit: {} holds {:g} N", device.name, device.nominal_force), "Give at most that.");
}

Outcome check_position(const device::Capabilities& device) {
  if (!device.report_descriptor) return {};
  return refuse_arguments(fmt::format("{}: what it reports is no position in space", device.name),
                          "Record it with `tactus capture` without --scene.");
}

tl::unexpected<Failure> refuse_device(const std::string& name, const Error& error) {
  errno = 0;
  return refuse(name, error);
}

tl::expected<ChosenDevice, Failure> open_device(const DeviceArguments& arguments, const sim::Scene* scene, std::size_t user) {
  const auto [backend, which] = split(arguments.name);
  if (arguments.scale > 0 && (scene == nullptr || backend == kVirtual || backend == kReplay))
    return refuse_arguments(scene == nullptr ? "--scale: nothing is touched without --scene"
                                             : fmt::format("--scale: the probe is where the hand of --device {} is", backend),
                            "Leave it out.");
  if (backend == kVirtual) return open_virtual(arguments, which, scene, user);
  if (backend == kReplay) {
    auto device =
        device::open_replay_device(which, {.user = {}, .playback_rate = arguments.playback_rate, .loops = arguments.loops});
    if (!device) return refuse(device.error());
    return ChosenDevice{std::move(*device)};
  }
  const auto found = std::ranges::find(backends(), backend, [](const auto& known) { return known->name(); });
  if (found == backends().end())
    return refuse_arguments(fmt::format("--device {}: this program has no backend '{}'", arguments.name, backend),
                            fmt::format("Take one of {}.", known_backends()));
  auto device = (*found)->open(which, arguments.open);
  if (!device) return refuse(device.error());
  ChosenDevice chosen{std::move(*device)};
  if (scene == nullptr) return chosen;
  chosen.frame = {scene->users[user].start, scene->users[user].device.scale};
  return chosen;
}

}  // namespace tactus::cli
