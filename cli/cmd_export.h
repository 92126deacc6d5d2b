// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/command.h"

namespace tactus::cli {

void setup_export(CLI::App& app, Action& action);
/// `tactus export mesh`; only where surfaces can be written.
void setup_export_mesh(CLI::App& group, Action& action);

}  // namespace tactus::cli
