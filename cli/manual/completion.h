// SPDX-License-Identifier: Apache-2.0
/// Completion of the command line in shells, made from what the help says.
#pragma once

#include <string>

#include "cli/command.h"

namespace tactus::cli {

std::string bash_completion(const CommandText& program);
std::string zsh_completion(const CommandText& program);
std::string fish_completion(const CommandText& program);

}  // namespace tactus::cli
