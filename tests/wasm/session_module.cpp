// SPDX-License-Identifier: Apache-2.0
/// What is beyond a decoder in WebAssembly: the testee's answers (conformance/README.md) of both ends of sessions and of a client with a
/// device, for sessions.js.
#include <cstddef>
#include <cstdint>
#include <sstream>
#include <string>

#include "conformance/report.h"
#include "conformance/session_report.h"

namespace {
std::string answers;
}

/// The answers, good until the next call; null if the script cannot be read.
extern "C" const char* answer_session(const char* script) {
  std::ostringstream out;
  if (!tactus::conformance::report_session(script, out)) return nullptr;
  answers = std::move(out).str();
  return answers.c_str();
}

/// The answers of `--replica device` to a stream, good until the next call.
extern "C" const char* answer_with_device(const std::uint8_t* stream, std::size_t size) {
  std::ostringstream out;
  const auto done = tactus::conformance::report({stream, size}, {.replica = tactus::Interpolation::none, .device = true}, out);
  if (!done) tactus::conformance::report_error(tactus::errc_name(done.error().code), done.error().rule, out);
  answers = std::move(out).str();
  return answers.c_str();
}
