// SPDX-License-Identifier: Apache-2.0
/// What the subcommands of `tactus bench` share.
#pragma once

#include <map>
#include <string>

#include "cli/report/messages.h"

namespace tactus::cli {

/// Where and with what figures came about; without date and host name, so that a report changes when its figures do.
///   machine   "2 cores of an AMD EPYC, virtual machine"
///   compiler  "g++ 12.2.0"
///   build     "Release"
std::map<std::string, std::string> bench_context();

/// Make the folder of a report.   err  it cannot be made
Outcome make_folder(const std::string& directory);

}  // namespace tactus::cli
