// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/motion_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <span>
#include <string_view>

#include <tactus/base/shown.h>
#include <tactus/file/stream_file.h>
#include <tactus/trace/trace_scene.h>
#include "cli/output.h"
#include "cli/report/trace_ending.h"

namespace tactus::cli {
namespace {

constexpr std::string_view kStreamMagic = "\x89TCT";

}  // namespace

Outcome check_plausible_length(const std::string& path, std::span<const std::uint8_t> file, const std::string& remedy) {
  constexpr std::uint64_t kFreeTicks = 600000, kTicksByByte = 512;
  auto reader = StreamFileReader::open(file);
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

tl::expected<MotionSource, Failure> MotionSource::open(const std::string& path) {
  MotionSource source(path);
  TACTUS_TRY(auto input, RereadableInput::open(path));
  source.input_ = std::make_unique<RereadableInput>(std::move(input));
  std::string magic(kStreamMagic.size(), '\0');
  std::ifstream(source.input_->path(), std::ios::binary).read(magic.data(), static_cast<std::streamsize>(magic.size()));
  if (magic != kStreamMagic) {  // what is neither is named there
    auto trace = TraceReader::open(source.input_->path());
    if (!trace) return refuse(path, trace.error());
    source.trace_.emplace(std::move(*trace));
    return source;
  }
  TACTUS_TRY(auto bytes, read_file(source.input_->path()));
  source.bytes_ = std::make_unique<std::string>(std::move(bytes));
  const std::span file(reinterpret_cast<const std::uint8_t*>(source.bytes_->data()), source.bytes_->size());
  auto player = Player::open(file);
  if (!player) return refuse(path, player.error());
  TACTUS_CHECK(check_plausible_length(path, file, "If that is right, decode it with `tactus decode --ticks N`."));
  source.info_ = replica_info(player->scene(), path);
  source.player_.emplace(std::move(*player));
  return source;
}

tl::expected<bool, Failure> MotionSource::next(TraceFrame& frame) {
  if (player_) return next_of_stream(frame);
  const auto more = trace_->next(frame);
  if (!more) return refuse(path_, more.error());
  if (*more) ++frames_;
  else TACTUS_CHECK(check_ending(path_, *trace_, frames_));
  return *more;
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
