// SPDX-License-Identifier: Apache-2.0
/// What a command and its options say about themselves: of this manual pages and completions are made.
#pragma once

#include <string>
#include <vector>

namespace tactus::cli {

struct OptionText {
  std::vector<std::string> names;  ///< "-p", "--deadband"; a positional argument has one: "TRACE"
  std::string value;               ///< "FRACTION", empty for flags and positional arguments
  std::string help;
  std::string group;                         ///< title that it stands under
  std::string otherwise;                     ///< its default, where the help names it apart from the text
  std::vector<std::string> needs, excludes;  ///< other options
  std::vector<std::string> values;           ///< all that may be typed; empty: no list
  bool is_positional = false, is_required = false, is_repeated = false;
};

struct CommandText {
  std::string name;  ///< "tactus import mesh"
  std::string summary;
  std::string footer;  ///< examples and notes
  std::vector<OptionText> options;
  std::vector<CommandText> commands;
};

}  // namespace tactus::cli
