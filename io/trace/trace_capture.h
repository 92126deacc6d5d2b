// SPDX-License-Identifier: Apache-2.0
/// Circumstances of a capture as the metadata record "tactus_capture" of a trace: started_ns (since 1970-01-01 UTC), device, backend,
/// scheduling, subject, remarks.
#pragma once

#include <optional>

#include <tactus/trace/frame.h>
#include <tactus/trace/mcap.h>

namespace tactus {

inline constexpr const char* kCaptureMetadata = "tactus_capture";

mcap::TextMap entries_of(const TraceCapture& capture);

/// Nothing when an entry is missing or invalid.
std::optional<TraceCapture> capture_from(const mcap::TextMap& entries);

/// The start is not before 1970, and every text is UTF-8.
bool is_valid(const TraceCapture& capture) noexcept;

}  // namespace tactus
