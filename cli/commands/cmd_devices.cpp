// SPDX-License-Identifier: Apache-2.0
#include <tactus/device/real_time.h>
#include "cli/commands/commands.h"
#include "cli/live/device_choice.h"
#include "cli/options/options_codec.h"
#include "cli/report/json.h"
namespace tactus::cli {
namespace {

struct DevicesOptions {
  CommonOptions common;
};

struct Kind {
  std::string name, title;
  device::Backend::Listing listing;
};

/// What needs no hardware stands first.
std::vector<Kind> look() {
  std::vector<Kind> kinds{{"virtual", "A simulated hand: virtual, or virtual:SCENE", {}},
                          {"replay", "The hand of a recording: replay:TRACE", {}}};
  for (const auto& backend : backends()) kinds.push_back({backend->name(), backend->title(), backend->list()});
  return kinds;
}

Value value_of(const std::vector<Kind>& kinds, const device::RealTime& real_time) {
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
    out["backends"].push_back(
        {{"name", kind.name}, {"title", kind.title}, {"devices", std::move(devices)}, {"missing", kind.listing.missing}});
  }
  for (const device::Privilege& privilege : real_time.privileges())
    out["privileges"].push_back({{"name", privilege.name}, {"granted", privilege.granted}, {"remedy", privilege.remedy}});
  return out;
}

Outcome run(const DevicesOptions& options) {
  const device::RealTime real_time;
  const std::vector<Kind> kinds = look();
  print(value_of(kinds, real_time), "devices", options.common);
  return {};
}

}  // namespace

void setup_devices(Command& app, Action& action) {
  auto options = std::make_shared<DevicesOptions>();
  Command& command = app.add_command("devices", "List force-feedback devices, what they lack, and how to get it");
  add_report_options(command, options->common);
  command.footer("It opens no device and loads no firmware.");
  on_chosen<DevicesOptions>(command, action, options, run);
}

}  // namespace tactus::cli
