// SPDX-License-Identifier: Apache-2.0
/// Other programs, run with an argument vector and never through a shell.
#pragma once

#include <string>
#include <vector>

#include "cli/messages.h"

namespace tactus::cli {

struct ChildResult {
  int status = 0;     ///< exit status; 128 + n: ended by signal n
  std::string out;    ///< all of its standard output
  std::string error;  ///< all of its standard error
};

/// Run `arguments[0]`, looked up in PATH unless it holds a '/', without standard input, and wait for its end.
/// May be called from several threads at once.   err  the program cannot be started
tl::expected<ChildResult, Failure> run_child(const std::vector<std::string>& arguments);

/// The path of this program itself.
std::string own_program();

}  // namespace tactus::cli
