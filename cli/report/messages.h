// SPDX-License-Identifier: Apache-2.0
/// What went wrong, in words: file, location, rule and a remedy. The sentences of rules are those of spec/rules.csv.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

#include <tactus/base/diagnostic.h>

namespace tactus::cli {

/// Why a command failed. Ready to print.
struct Failure {
  enum class Cause { work, arguments, bound, stopped };
  std::string text;    ///< "s.tct, byte 132: the check value of a record does not match (checksum, R-FIL-5)"
  std::string remedy;  ///< one sentence; may be empty
  Cause cause = Cause::work;
  int signal = 0;  ///< that stopped the work
  /// Of what the text says, as far as it says them: for --json.
  std::string file{}, location{}, error_class{}, rule{};
};
using Outcome = tl::expected<void, Failure>;

/// Escapes control characters in every line. Callers already escape foreign text; this is a second safeguard.
std::string printable(std::string_view message);

/// Location of a bit in a file: "byte 132" or "byte 132, bit 3"; empty for 0.
std::string location_of_bit(std::uint64_t bit_offset);
inline std::string location_of_tick(std::int64_t tick) { return "tick " + std::to_string(tick); }

/// A library's error about `file`, at `location` (may be empty).
tl::unexpected<Failure> refuse(const std::string& file, const std::string& location, const Error& error);
/// The same with the location that the error itself carries.
tl::unexpected<Failure> refuse(const std::string& file, const Error& error);
/// An error of a recording, with all that its reader knows of location, cause and remedy.
tl::unexpected<Failure> refuse(const std::string& file, const Diagnostic& error);
/// An error of a text or a simulation with its location: one line, the remedy included.
tl::unexpected<Failure> refuse(const Diagnostic& error);
/// What to do about an operation on a file that failed for this reason (errno).
std::string remedy_of(int cause);
/// A file cannot be read or written.   in  what  "cannot be written";  cause  errno
tl::unexpected<Failure> refuse_io(const std::string& file, const std::string& what, int cause);
/// A failure of the program's own, without a rule.
tl::unexpected<Failure> refuse(std::string text, std::string remedy);
/// Arguments that are wrong whatever the files hold: a mistake of usage, as those that are found while the line is parsed.
tl::unexpected<Failure> refuse_arguments(std::string text, std::string remedy);

}  // namespace tactus::cli
