// SPDX-License-Identifier: Apache-2.0
/// Trace files: MCAP with zstd chunks and ROS 2 CDR messages. DESIGN 7.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "codec/base/result.h"
#include "codec/trace/frame.h"

namespace tactus {

/// Writes a trace as it happens. A process that dies leaves a file that reads up to its last whole chunk.
class TraceWriter {
 public:
  /// path "-" is standard output.   err  io R-TRC-1
  static Result<TraceWriter> create(const std::string& path, const TraceInfo& info);
  /// Ticks increase strictly.   err  invalid_argument R-API-1 (not finite), R-API-5 (count, order); io R-TRC-1
  Result<void> write(const TraceFrame& frame);
  /// Summary, index and footer. A writer destroyed without it leaves a readable but unindexed file.
  Result<void> finish();

  TraceWriter(TraceWriter&&) noexcept;
  TraceWriter& operator=(TraceWriter&&) noexcept;
  ~TraceWriter();

 private:
  struct Impl;
  explicit TraceWriter(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

/// Reads a trace front to back, one frame at a time.
class TraceReader {
 public:
  /// path "-" is standard input.   err  io R-TRC-1; malformed, truncated, unsupported, checksum, limit_exceeded: R-TRC-n
  static Result<TraceReader> open(const std::string& path);
  const TraceInfo& info() const noexcept;
  /// Number of frames if the file's summary tells it.
  std::optional<std::uint64_t> frame_count() const noexcept;
  /// Next frame into `frame` (its vectors are reused); false at the end.
  Result<bool> next(TraceFrame& frame);
  /// The file had no whole ending (crash, cut): everything up to its last whole chunk was delivered.
  bool cut_short() const noexcept;

  TraceReader(TraceReader&&) noexcept;
  TraceReader& operator=(TraceReader&&) noexcept;
  ~TraceReader();

 private:
  struct Impl;
  explicit TraceReader(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

} // namespace tactus
