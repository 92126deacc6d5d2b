// SPDX-License-Identifier: Apache-2.0
/// A recording whose devices are played again.
#pragma once

#include <string>
#include <tl/expected.hpp>
#include <vector>

#include <tactus/trace/trace_file.h>
#include "cli/report/messages.h"

namespace tactus::cli {

/// A trace with users, a sample of each for every tick of a simulation.
tl::expected<TraceReader, Failure> open_replay(const std::string& path);

/// One sample per user. If the recording has no buttons, button 0 counts as pressed during a spring contact.
std::vector<DeviceSample> recorded_devices(const TraceReader& recording, const TraceFrame& frame);

}  // namespace tactus::cli
