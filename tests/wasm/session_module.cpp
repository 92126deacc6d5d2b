// SPDX-License-Identifier: Apache-2.0
/// Both ends of a session in WebAssembly: the testee's answers to the scripts of sessions (conformance/README.md), for sessions.js.
#include <sstream>
#include <string>

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
