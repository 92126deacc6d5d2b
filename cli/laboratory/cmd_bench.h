// SPDX-License-Identifier: Apache-2.0
/// `tactus bench`: studies of the simulation itself, each a subcommand of its own.
#pragma once

#include <map>
#include <string>

#include "cli/command.h"

namespace tactus::cli {

void setup_bench(Command& app, Action& action);

/// Where and with what figures came about; without date and host name, so that a report changes when its figures do.
///   machine   "2 cores of an AMD EPYC, virtual machine"
///   compiler  "g++ 12.2.0"
///   build     "Release"
std::map<std::string, std::string> bench_context();

/// Make the folder of a report.   err  it cannot be made
Outcome make_folder(const std::string& directory);

}  // namespace tactus::cli
