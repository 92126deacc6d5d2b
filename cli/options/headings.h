// SPDX-License-Identifier: Apache-2.0
/// What the help says beside the options: headings, and what was probably meant.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace tactus::cli {

// ==== suggestion ====
// What was probably meant by a word that is not known.

/// ". Did you mean NAME?" with the name nearest to `typed`, or empty when none is near.
///   near: at most a third of its letters are missing, superfluous, other ones or swapped with the next
std::string did_you_mean(std::string_view typed, std::span<const std::string> names);

// ==== headings ====
// Headings of the help: which option and which command stands under which.

/// in   option  its long name: "--deadband", "--tune rings";  group  above its command: "import", or the program;   out  "Options" for what only one
///      command has
std::string heading_of(std::string_view option, std::string_view group);

/// What is typed now in place of an option that has become a key of --tune: "nugget=...".   in  keys  of the command
/// out  empty: it has none for it
std::string key_instead_of(std::string_view option, std::span<const std::string> keys);

/// in   command  of the program, not of a group
std::string heading_of_command(std::string_view command);

}  // namespace tactus::cli
