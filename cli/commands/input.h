// SPDX-License-Identifier: Apache-2.0
/// What commands read: files that are read twice, traces that were cut, motion from either kind of file.
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <tactus/player.h>
#include <tactus/trace/trace_file.h>
#include "cli/output.h"
#include "cli/progress.h"
#include "cli/report/messages.h"

namespace tactus::cli {

// ==== rereadable input ====

/// An input that is read more than once. What can be read only once (a pipe, "-") is copied to a temporary file without a name.
class RereadableInput {
 public:
  /// in   most  [bytes] of what is copied
  /// err  it cannot be read, or the copy not written; there is more to copy than `most`
  static tl::expected<RereadableInput, Failure> open(const std::string& path, std::uint64_t most = kMostRead);
  const std::string& path() const noexcept { return path_; }  ///< to read from while this lives

 private:
  struct CloseFile {
    void operator()(std::FILE* file) const noexcept { std::fclose(file); }
  };
  std::string path_;
  std::unique_ptr<std::FILE, CloseFile> copy_;
};

// ==== traces ====
// How a trace is opened, and what is to be said when it was read to its end: notes of its reader, and that its writer did not finish.

/// Open a trace, or a recording of another program.   in  shown  name for messages
/// err  as TraceReader::open()
tl::expected<TraceReader, Failure> open_trace(const std::string& path, const std::string& shown, Visibility progress,
                                              const ReadOptions& options = {});
inline tl::expected<TraceReader, Failure> open_trace(const std::string& path, Visibility progress) {
  return open_trace(path, path, progress);
}

/// Read the next frame, as TraceReader::next().   err  the same, with chunk, topic and time
tl::expected<bool, Failure> next_frame(TraceReader& reader, TraceFrame& frame, const std::string& path);

/// How far a trace has been read: by its frames where it states their number, else by its bytes, where they are known.
class ReadProgress {
 public:
  /// in  reader  null: a stream   pre  it outlives this and is not moved
  ReadProgress(const char* label, const TraceReader* reader, Visibility visibility)
      : reader_(reader != nullptr && !reader->frame_count() && reader->bytes().all ? reader : nullptr),
        progress_(label,
                  reader_ != nullptr  ? reader_->bytes().all
                  : reader != nullptr ? reader->frame_count()
                                      : std::nullopt,
                  visibility) {}
  void update(std::uint64_t frames) {
    constexpr std::uint64_t kBetween = 64;  // frames: the position in a file is not asked for at each
    if (reader_ == nullptr) progress_.update(frames);
    else if (frames % kBetween == 0) progress_.update(reader_->bytes().read);
  }

 private:
  const TraceReader* reader_;  // null: frames count
  Progress progress_;
};

/// A stream ends inside a record: warns on standard error, quiet or not.
void warn_cut_stream(const std::string& path, const Error& error);

/// To be called when a trace was read to its end: prints the notes of its reader on standard error, and warns there, quiet or not, if it
/// was cut.
/// in   frames  so many were read
/// err  it was cut before its first tick
Outcome check_ending(const std::string& path, const TraceReader& reader, std::uint64_t frames);

// ==== motion source ====

/// Without a number of ticks, a stream is decoded to its last packet's tick, and a few bytes can name one that is hours away. Ten minutes
/// are free, shared among all objects and vertices; beyond that every byte of a packet earns half a second. A stream at rest takes ten
/// bytes a second.   in  remedy  what to do if the length is right after all
Outcome check_plausible_length(const std::string& path, std::span<const std::uint8_t> file, const std::string& remedy);

/// A stream that ends inside a record is decoded up to there, as a trace that was cut.
bool is_cut_stream(const Error& error);

/// A packet of a stream, as far as figures show it.
struct SourcePacket {
  std::int64_t tick = 0;
  std::size_t bytes = 0;
};

/// What moves, tick by tick: a trace, or a stream as a client shows it.
class MotionSource {
 public:
  /// path "-" is standard input.   err  as TraceReader and Player; the stream is implausibly long
  static tl::expected<MotionSource, Failure> open(const std::string& path, Visibility progress);

  const TraceInfo& info() const noexcept { return trace_ ? trace_->info() : info_; }
  bool is_stream() const noexcept { return player_.has_value(); }
  const TraceReader* trace() const noexcept { return trace_ ? &*trace_ : nullptr; }
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
