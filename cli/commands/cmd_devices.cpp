// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>


#include <tactus/device/real_time.h>
#include "cli/commands/commands.h"
#include "cli/live/device_choice.h"
#include "cli/options/options_codec.h"
#include "cli/report/json.h"
#include "cli/report/table.h"

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

Json to_json(const std::vector<Kind>& kinds, const device::RealTime& real_time) {
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

void print_text(const std::vector<Kind>& kinds, const device::RealTime& real_time) {
  Table table;
  table.heading({"backend", "what it is"});
  for (const Kind& kind : kinds) {
    table.row({"  " + kind.name, kind.title});
    for (const device::Capabilities& can : kind.listing.devices)
      table.row({"    " + can.name, fmt::format("{}{}{}{}", can.model, can.serial.empty() ? "" : ", serial ", can.serial,
                                                can.report_descriptor ? ", recorded report by report" : "")});
    for (const std::string& missing : kind.listing.missing) table.row({"", "missing: " + missing});
  }
  table.heading({"real time", ""});
  for (const device::Privilege& privilege : real_time.privileges())
    table.row({"  " + privilege.name, privilege.granted ? "granted" : "not granted: " + privilege.remedy});
  table.print(stdout);
}

Outcome run(const DevicesOptions& options) {
  const device::RealTime real_time;
  const std::vector<Kind> kinds = look();
  if (options.common.json) fmt::print("{}\n", text_of_json(to_json(kinds, real_time)));
  else if (!options.common.quiet) print_text(kinds, real_time);
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
