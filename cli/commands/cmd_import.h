// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/command.h"

namespace tactus::cli {

void setup_import(Command& app, Action& action);
/// `tactus import mesh`; only where surfaces can be read.
void setup_import_mesh(Command& group, Action& action);

}  // namespace tactus::cli
