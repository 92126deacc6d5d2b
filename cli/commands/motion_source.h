// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <tactus/player.h>
#include <tactus/trace/trace_file.h>
#include "cli/commands/rereadable_input.h"
#include "cli/report/messages.h"

namespace tactus::cli {

/// Without a number of ticks, a stream is decoded to its last packet's tick, and a few bytes can name one that is hours away. Ten minutes
/// are free, shared among all objects and vertices; beyond that every byte of a packet earns half a second. A stream at rest takes ten
/// bytes a second.   in  remedy  what to do if the length is right after all
Outcome check_plausible_length(const std::string& path, std::span<const std::uint8_t> file, const std::string& remedy);

/// A stream that ends inside a record is decoded up to there, as a trace that was cut.
bool is_cut_stream(const Error& error);

/// A packet of a stream, as far as figures tell of it.
struct SourcePacket {
  std::int64_t tick = 0;
  std::size_t bytes = 0;
};

/// What moves, tick by tick: a trace, or a stream as a client shows it.
class MotionSource {
 public:
  /// path "-" is standard input.   err  as TraceReader and Player; the stream is implausibly long
  static tl::expected<MotionSource, Failure> open(const std::string& path);

  const TraceInfo& info() const noexcept { return trace_ ? trace_->info() : info_; }
  bool is_stream() const noexcept { return player_.has_value(); }
  std::optional<std::uint64_t> frame_count() const noexcept { return trace_ ? trace_->frame_count() : std::nullopt; }
  /// Read the next frame into that of the call before; false at the end, where a cut is warned of.   err  it is damaged
  tl::expected<bool, Failure> next(TraceFrame& frame);
  /// Those of a stream that came up to the last frame.
  const std::vector<SourcePacket>& packets() const noexcept { return packets_; }

 private:
  explicit MotionSource(std::string path) : path_(std::move(path)) {}
  tl::expected<bool, Failure> next_of_stream(TraceFrame& frame);

  std::string path_;
  std::unique_ptr<RereadableInput> input_;
  std::unique_ptr<std::string> bytes_;  // of a stream; stays where it is when the source is moved
  std::optional<TraceReader> trace_;
  std::optional<Player> player_;
  TraceInfo info_;  // of the stream
  std::vector<SourcePacket> packets_;
  std::int64_t tick_ = 0;
  std::uint64_t frames_ = 0;
};

}  // namespace tactus::cli
