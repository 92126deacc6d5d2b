// SPDX-License-Identifier: Apache-2.0
/// Options that can do nothing: because another one says otherwise, or because of what a file or scene holds. One table each.
#pragma once

#include <CLI/CLI.hpp>
#include <set>
#include <string>

#include "codec/trace/trace_file.h"

namespace tactus::cli {

/// What options are about. The sentences that miss it stand beside the tables.
enum class Subject { rigid, user, mesh, touched_mesh, deformable, deformed, packets, surface };

/// What a trace holds.
std::set<Subject> subjects_of(const TraceInfo& info);

/// Refuse options that others switch off: --alpha without --haptic cone.   throws CLI::ValidationError, as CLI11's own checks do
void check_options_agree(const CLI::App& command);

/// Say on standard error which of the options that were typed find nothing to work on.   in  place  "trace", "scene"
void note_idle_options(const CLI::App& command, const std::set<Subject>& held, const std::string& place);

}  // namespace tactus::cli
