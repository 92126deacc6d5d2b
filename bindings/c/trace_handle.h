// SPDX-License-Identifier: Apache-2.0
/// A trace that is read, at its frame.
#pragma once

#include <span>
#include <string>

#include <tactus/trace/trace_file.h>

#include "handles.h"

struct tactus_trace {
  tactus::TraceReader reader;
  std::string path;                       // empty: read from `bytes`
  std::span<const std::uint8_t> bytes{};  // of the caller
  tactus::TraceFrame frame{};
  bool has_frame = false;  // `frame` is one
  bool is_first = true;    // ... which was read when the trace was opened, and not returned yet
};

namespace tactus::c {

/// What the last failing call of this thread has beyond its rule: tactus_trace_error_words().
std::string& error_words() noexcept;
/// The rule of an error whose words are kept.
tl::unexpected<Error> keep_words(const Diagnostic& error);

/// err  R-API-12 null
inline Result<const TraceInfo*> info_of(const tactus_trace* trace) noexcept {
  if (trace == nullptr) return refuse();
  return &trace->reader.info();
}

/// err  R-API-12 null, or before the first frame or after the last
inline Result<const TraceFrame*> frame_of(const tactus_trace* trace) noexcept {
  if (trace == nullptr || trace->is_first || !trace->has_frame) return refuse();
  return &trace->frame;
}

}  // namespace tactus::c
