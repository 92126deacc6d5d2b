// SPDX-License-Identifier: Apache-2.0
/// Options that can do nothing: because another one says otherwise, or because of what a file or scene holds. One table each.
#pragma once

#include <set>
#include <string>

namespace tactus {
struct TraceInfo;
}

namespace tactus::cli {

class Command;

/// What an option applies to; messages for a missing subject are in option_needs.cpp.
enum class Subject { rigid, user, mesh, touched_mesh, deformable, deformed, packets, surface, gltf, frames };

/// What a trace holds.
std::set<Subject> subjects_of(const TraceInfo& info);

/// Refuse options that others switch off: --tune alpha without --haptic cone. Ends the parsing, as a wrong value does.
void check_options_agree(const Command& command);

/// Say on standard error which of the options that were typed find nothing to work on.   in  place  "trace", "scene"
void note_idle_options(const Command& command, const std::set<Subject>& held, const std::string& source);

}  // namespace tactus::cli
