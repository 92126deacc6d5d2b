// SPDX-License-Identifier: Apache-2.0
/// What our ends of a session do with the datagrams of a script, in the words of the testee contract (conformance/README.md).
#pragma once

#include <iosfwd>
#include <span>
#include <string>

namespace tactus::conformance {

/// in   script  lines of JSON: who it is for, then what comes and when      out  a line for each of them
/// True if the script could be read.
bool report_session(const std::string& script, std::ostream& out);
/// The same for the server's end.
bool report_server(std::istream& script, std::ostream& out);

}  // namespace tactus::conformance
