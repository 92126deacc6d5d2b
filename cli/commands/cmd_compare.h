// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/command.h"

namespace tactus::cli {

void setup_compare(Command& app, Action& action);

}  // namespace tactus::cli
