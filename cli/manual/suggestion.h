// SPDX-License-Identifier: Apache-2.0
/// The name that somebody meant.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tactus::cli {

inline constexpr const char* kSeeHelp = "Run with --help for more information.";

/// "Did you mean --haptic? ", or nothing: no name is near what was typed. Near is a beginning, or one slip (a letter too many, too few,
/// another, two exchanged) in three letters.
std::string did_you_mean(std::string_view typed, const std::vector<std::string>& names);

}  // namespace tactus::cli
