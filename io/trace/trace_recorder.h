// SPDX-License-Identifier: Apache-2.0
/// Writes a trace on a thread of its own: what happens at 1 kHz never waits for compression or for the disk.
///
///   real-time thread -> offer() -> ring of frames -> writing thread -> TraceWriter -> file
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <tactus/base/result.h>
#include <tactus/trace/frame.h>
#include <tactus/trace/trace_file.h>

namespace tactus {

struct TraceRecorderOptions {
  std::size_t frames = 4096;  ///< that the ring holds, 2 to 2^20: a disk may be silent for so many ticks
  double chunk_time = 0.08;   ///< [s] a crash or a full disk loses at most so much, and what the writing thread has not taken yet
};

class TraceRecorder {
 public:
  /// in   like  a frame of the trace: as many objects, users and vertices
  /// err  as TraceWriter::create; invalid_argument R-API-4: options, R-API-5: `like` is not of this trace; limit_exceeded R-API-11
  static Result<TraceRecorder> create(const std::string& path, const TraceInfo& info, const TraceFrame& like,
                                      const TraceRecorderOptions& options = {});

  /// Hand over a frame. False: the ring is full, or nothing can be written any more; this tick is lost, and a shape that was new in it
  /// goes with the next one. Reports beyond kMostReports or kMostReportBytes make a tick a lost one, too.
  /// pre  one thread offers; TraceFrame::marker and changed are ignored
  /// time O(what the frame holds), 0.1 us for one object and user; no allocation, no lock, no system call
  bool offer(const TraceFrame& frame) noexcept;

  /// Mark the next tick that is written. From any thread but the one that offers.   in  text  UTF-8; longer than 255 bytes is cut
  void mark(std::string_view text);

  struct Status {
    std::uint64_t lost = 0;          ///< frames
    std::size_t most_waiting = 0;    ///< frames in the ring, at most so far
    std::optional<Error> error{};    ///< of writing: everything after it is lost
    int cause = 0;                   ///< errno of that
    std::int64_t last_written = -1;  ///< tick
  };
  Status status() const noexcept;

  /// Write what waits, then the end of the file.   err  the first of TraceWriter::write or finish; errno is that of the error
  Result<void> finish();

  TraceRecorder(TraceRecorder&&) noexcept;
  TraceRecorder& operator=(TraceRecorder&&) = delete;
  ~TraceRecorder();  ///< without finish() what waits is written, and the file has no index

 private:
  struct Impl;
  explicit TraceRecorder(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tactus
