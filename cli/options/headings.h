// SPDX-License-Identifier: Apache-2.0
/// Headings of the help: which option and which command stands under which.
#pragma once

#include <string>
#include <string_view>

namespace tactus::cli {

/// in   option  its long name: "--deadband";   out  "Options" for what only one command has
std::string heading_of(std::string_view option);

/// in   command  of the program, not of a group
std::string heading_of_command(std::string_view command);

}  // namespace tactus::cli
