// SPDX-License-Identifier: Apache-2.0
/// Man pages and shell completion, from the help of the commands.
#pragma once

#include <string>

#include "cli/command.h"

namespace tactus::cli {

// ==== completion ====
// Completion of the command line in shells, made from what the help says.

std::string bash_completion(const CommandText& program);
std::string zsh_completion(const CommandText& program);
std::string fish_completion(const CommandText& program);

// ==== man page ====
// Pages of the manual, in the macros of man(7), made from what the help says.

/// "tactus-import-csv.1"
std::string man_page_name(const CommandText& command);

/// in   text  a command, a group of commands or the program
std::string man_page(const CommandText& text);

}  // namespace tactus::cli
