// SPDX-License-Identifier: Apache-2.0
/// Pages of the manual, in the macros of man(7), made from what the help says.
#pragma once

#include <string>

#include "cli/command.h"

namespace tactus::cli {

/// "tactus-import-csv.1"
std::string man_page_name(const CommandText& command);

/// in   text  a command, a group of commands or the program
std::string man_page(const CommandText& text);

}  // namespace tactus::cli
