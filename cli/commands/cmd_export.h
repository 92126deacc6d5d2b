// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/command.h"

namespace tactus::cli {

void setup_export(Command& app, Action& action);
/// `tactus export mesh`; only where surfaces can be written.
void setup_export_mesh(Command& group, Action& action);

}  // namespace tactus::cli
