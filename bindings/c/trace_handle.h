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

/// What the last failing call of this thread has beyond its rule: tactus_error::detail.
std::string& error_words() noexcept;

template <>
tactus_errors_options defaults<tactus_errors_options>() noexcept;

/// As call(), of a recording: the error has its words.
template <class Body>
tactus_status call_with_words(tactus_error* error, Body&& body) noexcept {
  error_words().clear();
  const tactus_status status = call(error, std::forward<Body>(body));
  if (status != TACTUS_OK && status != TACTUS_NOTHING && error != nullptr) error->detail = error_words().c_str();
  return status;
}
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
