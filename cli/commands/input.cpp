// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/input.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <span>
#include <string_view>

#include <tactus/base/shown.h>
#include <tactus/file/stream_file.h>
#include <tactus/thesis/if_built.h>
#include <tactus/trace/byte_source.h>
#include <tactus/trace/trace_scene.h>
#include "cli/output.h"
#include "cli/report/notes.h"
#include "cli/report/table.h"

namespace tactus::cli {

// ==== rereadable input ====

tl::expected<RereadableInput, Failure> RereadableInput::open(const std::string& path, std::uint64_t most) {
  RereadableInput input;
  input.path_ = path;
  std::error_code ignored;
  const auto status = std::filesystem::status(path, ignored);
  const bool is_pipe = path == "-" || std::filesystem::is_fifo(status) || std::filesystem::is_character_file(status);
  if (!is_pipe) return input;
  auto source = ByteSource::open_file(path);
  if (!source) return refuse(path, source.error());
  input.copy_.reset(std::tmpfile());
  if (!input.copy_) return refuse_io("a temporary file", "cannot be made", errno);
  std::array<std::uint8_t, 1 << 16> piece;
  for (std::uint64_t copied = 0;;) {
    const auto count = source->read(piece);
    if (!count) return refuse(path, count.error());
    if (*count == 0) break;
    copied += *count;
    if (copied > most)
      return refuse(fmt::format("{}: more than {} MiB from a pipe", shown_path(path), most >> 20), "Write it to a file first.");
    if (std::fwrite(piece.data(), 1, *count, input.copy_.get()) != *count)
      return refuse_io("a temporary file", "cannot be written", errno);
  }
  if (std::fflush(input.copy_.get()) != 0) return refuse_io("a temporary file", "cannot be written", errno);
  input.path_ = "/proc/self/fd/" + std::to_string(fileno(input.copy_.get()));
  return input;
}

// ==== traces ====

namespace {

/// All of a foreign recording is looked at before its first frame, which takes as long as reading it.
class LookAhead final : public ReadWatcher {
 public:
  explicit LookAhead(Visibility visibility) : visibility_(visibility) {}
  void on_read(std::uint64_t bytes, std::uint64_t all) override {
    if (!progress_) progress_.emplace("look ahead", all, visibility_);
    progress_->update(bytes);
  }

 private:
  Visibility visibility_;
  std::optional<Progress> progress_;
};

}  // namespace

tl::expected<TraceReader, Failure> open_trace(const std::string& path, const std::string& shown, Visibility progress,
                                              const ReadOptions& options) {
  ReadOptions watched = options;
  LookAhead look(progress);
  watched.watcher = &look;
  return TraceReader::open(path, watched).map_error([&](const Diagnostic& error) { return refuse(shown, error).value(); });
}

tl::expected<bool, Failure> next_frame(TraceReader& reader, TraceFrame& frame, const std::string& path) {
  return reader.next(frame).map_error([&](const Error& error) { return refuse(path, reader.explain(error)).value(); });
}

void warn_cut_stream(const std::string& path, const Error& error) {
  fmt::print(stderr, "warning: {}: the stream ends inside a record at {}; everything before the cut could be read\n",
             shown_path(path), location_of_bit(error.bit_offset));
}

Outcome check_ending(const std::string& path, const TraceReader& reader, std::uint64_t frames) {
  if (!reader.notes().empty()) std::fflush(stdout);
  print_notes(reader.notes(), path);
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

// ==== motion source ====

namespace {

constexpr std::string_view kStreamMagic = "\x89TCT";

}  // namespace

Outcome check_plausible_length(const std::string& path, std::span<const std::uint8_t> file, const std::string& remedy) {
  constexpr std::uint64_t kFreeTicks = 600000, kTicksByByte = 512;
  auto reader = StreamFileReader::open(file, {.thesis = thesis_if_built()});
  if (!reader) return refuse(path, reader.error());
  std::uint64_t last = 0, packets = 0, elements = reader->scene()->objects.size();
  while (const auto packet = reader->next().value_or(std::nullopt)) {
    last = static_cast<std::uint64_t>(packet->tick);
    packets += packet->bytes.size();
  }
  for (const DeformableObject& object : reader->scene()->deformables) elements += object.rest.size();
  if (last <= kFreeTicks / std::max<std::uint64_t>(elements, 1) + kTicksByByte * packets) return {};
  return refuse(fmt::format("{}: its last packet is at tick {}, implausibly far for packets of {} bytes in all", shown_path(path),
                            last, packets),
                remedy);
}

bool is_cut_stream(const Error& error) { return error.rule == std::string_view("R-FIL-2"); }

tl::expected<MotionSource, Failure> MotionSource::open(const std::string& path, Visibility progress) {
  MotionSource source(path);
  TACTUS_TRY(auto input, RereadableInput::open(path));
  source.input_ = std::make_unique<RereadableInput>(std::move(input));
  std::string magic(kStreamMagic.size(), '\0');
  std::ifstream(source.input_->path(), std::ios::binary).read(magic.data(), static_cast<std::streamsize>(magic.size()));
  if (magic != kStreamMagic) {  // what is neither is named there
    auto trace = open_trace(source.input_->path(), path, progress);
    if (!trace) return tl::unexpected(trace.error());
    source.trace_.emplace(std::move(*trace));
    return source;
  }
  TACTUS_TRY(auto bytes, read_file(source.input_->path()));
  source.bytes_ = std::make_unique<std::string>(std::move(bytes));
  const std::span file(reinterpret_cast<const std::uint8_t*>(source.bytes_->data()), source.bytes_->size());
  auto player = Player::open(file, {.limits = {.thesis = thesis_if_built()}});
  if (!player) return refuse(path, player.error());
  TACTUS_CHECK(check_plausible_length(path, file, "If that is right, decode it with `tactus decode --ticks N`."));
  source.info_ = replica_info(player->scene(), path);
  source.player_.emplace(std::move(*player));
  return source;
}

tl::expected<bool, Failure> MotionSource::next(TraceFrame& frame) {
  if (player_) return next_of_stream(frame);
  TACTUS_TRY(const bool more, next_frame(*trace_, frame, path_));
  if (more) ++frames_;
  else TACTUS_CHECK(check_ending(path_, *trace_, frames_));
  return more;
}

tl::expected<bool, Failure> MotionSource::next_of_stream(TraceFrame& frame) {
  if (frames_ == 0) frame = replica_frame(player_->scene());
  const auto end = [&](const Error& error) -> tl::expected<bool, Failure> {
    if (!is_cut_stream(error) || frames_ == 0) return refuse(path_, error);
    warn_cut_stream(path_, error);
    return false;
  };
  const auto waiting = player_->next_tick();
  if (!waiting) return end(waiting.error());
  if (!*waiting && frames_ > 0) return false;
  while (true) {
    const auto played = player_->play(tick_);
    if (!played) return end(played.error());
    if (!*played) break;
    packets_.push_back({tick_, (*played)->bytes});
  }
  frame.tick = tick_;
  take_shown(player_->replica(), player_->scene(), tick_++, frame);
  ++frames_;
  return true;
}

}  // namespace tactus::cli
