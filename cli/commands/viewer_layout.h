// SPDX-License-Identifier: Apache-2.0
/// Layouts of panels for what `tactus export foxglove` writes.
#pragma once

#include <string>

#include <tactus/trace/frame.h>

namespace tactus::cli {

/// JSON for Foxglove and Lichtblick: a 3-D panel, and plots of the first user's force and the first object's position.
std::string foxglove_layout(const TraceInfo& info);

/// XML for PlotJuggler, which draws curves alone: of each user force and device, of each object the position. It fits the trace, too.
std::string plotjuggler_layout(const TraceInfo& info);

}  // namespace tactus::cli
