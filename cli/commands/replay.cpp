// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/replay.h"
#include "cli/report/trace_ending.h"

#include <fmt/format.h>

#include <utility>

#include <tactus/base/shown.h>
#include <tactus/sim/scene/scene.h>

namespace tactus::cli {

tl::expected<TraceReader, Failure> open_replay(const std::string& path) {
  auto reader = open_trace(path);
  if (!reader) return tl::unexpected(reader.error());
  const TraceInfo& info = reader->info();
  if (info.users.empty()) return refuse(shown_path(path) + ": nobody is in this trace", "Give a trace with a user.");
  if (info.tick_rate != sim::kTickRate)
    return refuse(fmt::format("{}: {} ticks per second, not {}", shown_path(path), info.tick_rate, sim::kTickRate),
                  fmt::format("`tactus resample --rate {}` makes one that fits.", sim::kTickRate));
  return std::move(*reader);
}

std::vector<DeviceSample> recorded_devices(const TraceReader& recording, const TraceFrame& frame) {
  std::vector<DeviceSample> devices;
  for (std::size_t i = 0; i < frame.users.size(); ++i) {
    DeviceSample& device = devices.emplace_back(frame.users[i].device);
    if (!recording.info().users[i].senses.buttons) device.buttons = frame.users[i].contact.kind == ContactKind::spring ? 1 : 0;
  }
  return devices;
}

}  // namespace tactus::cli
