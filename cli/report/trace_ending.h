// SPDX-License-Identifier: Apache-2.0
/// How a trace is opened, and what is to be said when it was read to its end: notes of its reader, and that its writer did not finish.
#pragma once

#include <cstdint>
#include <string>

#include <tactus/trace/trace_file.h>
#include "cli/report/messages.h"

namespace tactus::cli {

/// Open a trace, or a recording of another program.   in  shown  name for messages
/// err  as TraceReader::open(), with topic and time
tl::expected<TraceReader, Failure> open_trace(const std::string& path, const std::string& shown, const ReadOptions& options = {});
inline tl::expected<TraceReader, Failure> open_trace(const std::string& path) { return open_trace(path, path); }

/// A stream ends inside a record: warns on standard error, quiet or not.
void warn_cut_stream(const std::string& path, const Error& error);

/// To be called when a trace was read to its end: prints the notes of its reader on standard error, and warns there, quiet or not, if it
/// was cut.
/// in   frames  so many were read
/// err  it was cut before its first tick
Outcome check_ending(const std::string& path, const TraceReader& reader, std::uint64_t frames);

}  // namespace tactus::cli
