// SPDX-License-Identifier: Apache-2.0
#include "cli/report/trace_ending.h"

#include <fmt/format.h>

#include <cstdio>

#include <tactus/base/shown.h>
#include "cli/report/notes.h"
#include "cli/report/table.h"

namespace tactus::cli {

tl::expected<TraceReader, Failure> open_trace(const std::string& path, const std::string& shown, const ReadOptions& options) {
  auto reader = TraceReader::open(path, options);
  if (reader) return std::move(*reader);
  Diagnostic error = reader.error();
  if (error.detail.empty()) return refuse(shown, error.error);
  error.file = shown;
  return refuse(error);
}

void warn_cut_stream(const std::string& path, const Error& error) {
  fmt::print(stderr, "warning: {}: the stream ends inside a record at {}; everything before the cut could be read\n",
             shown_path(path), place_of_bit(error.bit_offset));
}

Outcome check_ending(const std::string& path, const TraceReader& reader, std::uint64_t frames) {
  if (!reader.notes().empty()) {
    std::fflush(stdout);
    Report unused;
    tell(reader.notes(), path, unused);
  }
  if (!reader.cut_short()) return {};
  if (frames == 0) {
    return refuse(shown_path(path) + ": the trace was cut before the end of its first chunk; no tick of it can be read",
                  "Copy it again from its source, or record it again.");
  }
  std::fflush(stdout);
  fmt::print(stderr, "warning: {}: the trace ends without its index; {} before the cut could be read\n", shown_path(path),
             counted(frames, "tick"));
  return {};
}

}  // namespace tactus::cli
