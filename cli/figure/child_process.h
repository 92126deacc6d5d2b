// SPDX-License-Identifier: Apache-2.0
/// Other programs, run with an argument vector and never through a shell.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <system_error>
#include <tl/expected.hpp>
#include <vector>

namespace tactus::cli {

struct ChildResult {
  int status = 0;     ///< exit status; 128 + n: ended by signal n
  std::string out;    ///< all of its standard output
  std::string error;  ///< all of its standard error
};

/// Run `arguments[0]`, looked up in PATH unless it holds a '/', and wait for its end.
/// May be called from several threads at once.
/// in   input  its standard input
///      limit  after which it is killed; none: never
/// err  why the program cannot be started; no_such_file_or_directory: it is not there; timed_out: it was killed
tl::expected<ChildResult, std::error_code> run_child(const std::vector<std::string>& arguments, const std::string& input = {},
                                                     std::optional<std::chrono::seconds> limit = std::nullopt);

/// The path of this program itself.
std::string own_program();

}  // namespace tactus::cli
