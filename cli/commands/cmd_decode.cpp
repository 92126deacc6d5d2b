// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>

#include <tactus/base/shown.h>
#include <tactus/file/stream_file.h>
#include <tactus/player.h>
#include <tactus/thesis/if_built.h>
#include <tactus/trace/trace_file.h>
#include <tactus/trace/trace_scene.h>
#include "cli/commands/input.h"
#include "cli/commands/replica_errors.h"
#include "cli/figure/time_figure.h"
#include "cli/report/report.h"

namespace tactus::cli {
namespace {

struct DecodeOptions {
  std::string input, output, like, plot;
  std::optional<std::int64_t> ticks;
  ReplicaOptions replica;
  CommonOptions common;
};

/// The ticks to write, one after the other: those of another trace, a number of them, or all up to the last packet's, which are one at
/// least: without a packet all stays where it began.
class TickSource {
 public:
  static tl::expected<TickSource, Failure> create(const DecodeOptions& options) {
    TickSource source(options);
    if (options.like.empty()) return source;
    auto like = open_trace(options.like, options.common.progress());
    if (!like) return tl::unexpected(like.error());
    source.like_.emplace(std::move(*like));
    return source;
  }
  /// The trace whose ticks are written, and what it holds in the last one that next() returned; null: there is none.
  const TraceReader* like() const noexcept { return like_ ? &*like_ : nullptr; }
  const TraceFrame& truth() const noexcept { return frame_; }
  tl::expected<std::optional<std::int64_t>, Failure> next(Player& player) {
    if (like_) {
      TACTUS_TRY(const bool more, next_frame(*like_, frame_, options_->like));
      if (more) return ++frames_, std::optional(frame_.tick);
      TACTUS_CHECK(check_ending(options_->like, *like_, frames_));
      return std::nullopt;
    }
    if (options_->ticks) return tick_ < *options_->ticks ? std::optional(tick_++) : std::nullopt;
    const auto waiting = player.next_tick();
    if (!waiting && is_cut_stream(waiting.error()) && tick_ > 0) return std::nullopt;
    if (!waiting) return refuse(options_->input, waiting.error());
    return *waiting || tick_ == 0 ? std::optional(tick_++) : std::nullopt;
  }

 private:
  explicit TickSource(const DecodeOptions& options) : options_(&options) {}
  const DecodeOptions* options_;
  std::optional<TraceReader> like_;
  TraceFrame frame_;
  std::uint64_t frames_ = 0;
  std::int64_t tick_ = 0;
};

void count(const PlayedPacket& played, Report& report) {
  if (played.substream > report.meshes.size()) report.loads->add(played.bytes, played.loads);
  else if (played.substream > 0)
    report.meshes[played.substream - 1].traffic->add(played.bytes, played.vertices, played.key, played.layer);
  else if (report.traffic) report.traffic->add(strongest_reason(played), played.updates.size(), played.bytes, played.key);
}

/// Bring the player to `tick` and take over what it shows there.
Result<void> decode_tick(Player& player, std::int64_t tick, TraceFrame& frame, Report& report, MotionFigure* figure) {
  while (true) {
    TACTUS_TRY(const auto played, player.play(tick));
    if (!played) break;
    count(*played, report);
    if (figure != nullptr) figure->add_packet(tick, played->bytes);
  }
  frame.tick = tick;
  take_shown(player.replica(), player.scene(), tick, frame);
  return {};
}

/// A stream that is broken at a tick can be decoded up to there.
tl::unexpected<Failure> refuse_at(std::int64_t tick, const Error& error, const DecodeOptions& options) {
  auto refused = refuse(options.input, error);
  if (tick > 0) refused.value().remedy += fmt::format(" The part before it can be decoded with --ticks {}.", tick);
  return refused;
}

/// Whether the trace whose ticks are written is the truth of this stream: then the replica is held against it.
bool may_compare(const TraceInfo& like, const TraceInfo& replica, const DecodeOptions& options, Report& report) {
  if (const auto same = check_same_scene(options.like, like, options.input, replica); !same) {
    report.warnings.push_back("no errors are reported: " + same.error().text);
    return false;
  }
  judge_by(nullptr, like, replica.bounds, report);
  report.timings.push_back({"compare"});
  return true;
}

/// in   figure  may be null
Outcome decode_all(Player& player, TraceWriter& writer, const TraceInfo& info, const DecodeOptions& options, Report& report,
                   MotionFigure* figure) {
  TACTUS_TRY(auto ticks, TickSource::create(options));
  std::optional<ShownByReplica> shown;
  if (ticks.like() != nullptr && may_compare(ticks.like()->info(), info, options, report)) shown.emplace(info);
  TraceFrame frame = replica_frame(player.scene());
  const auto total = options.ticks ? std::optional(static_cast<std::uint64_t>(*options.ticks)) : std::nullopt;
  Progress progress("decode", total, options.common.progress());
  while (true) {
    TACTUS_TRY(const auto tick, ticks.next(player));
    if (!tick) break;
    const auto decoded = report.timings[0].times.measure([&] { return decode_tick(player, *tick, frame, report, figure); });
    if (!decoded && is_cut_stream(decoded.error()) && report.ticks.count() > 0) break;
    if (!decoded) return refuse_at(*tick, decoded.error(), options);
    if (const auto written = writer.write(frame); !written)
      return refuse(options.output, location_of_tick(frame.tick), written.error());
    if (figure != nullptr) figure->add(frame);
    if (shown) {
      shown->take(frame);
      report.timings[1].times.measure([&] { return add_errors(ticks.truth(), *shown, report), true; });
    }
    report.ticks.add(*tick);
    progress.update(report.ticks.count());
  }
  if (const auto done = writer.finish(); !done) return refuse(options.output, done.error());
  return {};
}

Outcome run_decode(const DecodeOptions& options) {
  TACTUS_CHECK(check_no_terminal(options.output));
  TACTUS_TRY(const auto bytes, read_file(options.input));
  const std::span file(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  auto player = Player::open(file, {.replica = options.replica, .limits = {.thesis = thesis_if_built()}});
  if (!player && options.replica.interpolation != Interpolation::none && std::string_view(player.error().rule) == "R-API-4")
    return refuse(shown_path(options.input) + ": the stream signals how a client passes over to its updates",
                  "Leave out --interpolate, or encode with --profile thesis.");
  if (!player) return refuse(options.input, player.error());
  if (!options.ticks && options.like.empty())
    TACTUS_CHECK(
        check_plausible_length(options.input, file, "If that is right, give the number of ticks to write with --ticks N."));
  TACTUS_CHECK(check_plot_option(options.plot, options.common, {options.input, options.output, options.like}));
  TACTUS_TRY(auto output, OutputFile::create(options.output, options.common.existing(), {options.input, options.like}));
  const TraceInfo info = replica_info(player->scene(), "decode " + options.input);
  note_idle_options(*options.common.command, subjects_of(info), "stream");
  auto writer = TraceWriter::create(output.working_path(), info);
  if (!writer) return refuse(options.output, writer.error());

  Report report{.command = "decode", .files = {{"stream", options.input}, {"replica", options.output}}};
  report.describe(info);
  if (report.moving > 0 || info.meshes.empty()) report.traffic.emplace();
  for (const TraceDeformable& mesh : info.meshes)
    report.meshes.push_back({.name = mesh.name, .vertices = mesh.rest.vertices.size(), .traffic = DeformableRates{}});
  if (player->scene().loads) report.loads.emplace();
  report.timings = {{"decode"}};
  report.stream = {player->header_bytes(), bytes.size()};
  if (report.traffic) report.client = display_of_client(options.replica.interpolation, player->scene().is_smoothed);
  std::optional<MotionFigure> figure;
  if (!options.plot.empty()) figure.emplace(info);
  TACTUS_CHECK(decode_all(*player, *writer, info, options, report, figure ? &*figure : nullptr));
  const auto rest = player->next_tick();
  if (!rest && is_cut_stream(rest.error())) {
    warn_cut_stream(options.input, rest.error());
    report.warnings.emplace_back("the stream ends inside a record; everything before the cut was decoded");
  }
  if (rest && !*rest && !player->complete()) {
    report.warnings.emplace_back("the stream has no trailer: its writer did not finish");
  }
  TACTUS_CHECK(output.keep());
  if (figure) TACTUS_CHECK(draw(options.plot, Figure{shown_path(options.input), figure->panels()}, options.common));
  print(report, options.common, beside(options.output));
  return {};
}

}  // namespace

void setup_decode(Command& app, Action& action) {
  auto options = std::make_shared<DecodeOptions>();
  Command& command = app.add_command("decode", "Decode a stream into the trace that a client shows");
  command.add_option("STREAM", options->input, "Stream to decode, - is standard input")->type_name("")->required();
  command.add_option("-o,--output", options->output, "Trace of the replica to write, - is standard output")
      ->required()
      ->type_name("FILE");
  add_interpolation(command, options->replica);
  Option* like = command
                     .add_option("--like", options->like,
                                 "Write the ticks of this trace, and report the errors against it if it is what was encoded")
                     ->type_name("TRACE");
  command.add_option("--ticks", options->ticks, "Number of ticks to write [up to the last packet]")
      ->check(whole_number(1, 0xffffffff))
      ->excludes(like);
  add_plot_option(command, options->plot, "what the client shows, and the packets, over time");
  add_output_options(command, options->common);
  command.footer(
      "With --like the errors are those of `tactus compare`, which also takes other bounds; only its exit status says whether "
      "they "
      "hold.\n"
      "Examples:\n"
      "  tactus decode push.tct -o replica.mcap --like push.mcap\n"
      "  tactus decode thesis.tct -o smooth.mcap --interpolate");
  on_chosen<DecodeOptions>(command, action, options, run_decode);
}

}  // namespace tactus::cli
