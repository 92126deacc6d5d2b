// SPDX-License-Identifier: Apache-2.0
/// What is to be said about a trace whose writer did not finish.
#pragma once

#include <cstdint>
#include <string>

#include <tactus/trace/trace_file.h>
#include "cli/report/messages.h"

namespace tactus::cli {

/// A stream ends inside a record: warns on standard error, quiet or not.
void warn_cut_stream(const std::string& path, const Error& error);

/// To be called when a trace was read to its end: warns on standard error, quiet or not, if it was cut.
/// in   frames  so many were read
/// err  it was cut before its first tick
Outcome check_ending(const std::string& path, const TraceReader& reader, std::uint64_t frames);

}  // namespace tactus::cli
