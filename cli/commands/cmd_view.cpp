// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <ostream>
#include <span>

#include <tactus/base/shown.h>
#include <tactus/player.h>
#include <tactus/thesis/if_built.h>
#include <tactus/trace/trace_scene.h>
#include "cli/commands/input.h"
#include "cli/report/json.h"
#include "cli/report/report.h"
#include "cli/report/table.h"
#include "cli/viewer/columns.h"
#include "cli/viewer/page.h"
#ifdef TACTUS_HAS_SIM
#include "cli/viewer/shapes.h"
#endif

namespace tactus::cli {
namespace {

constexpr std::uint64_t kMostPage = 96U << 20;              // [bytes] of data, before base64
constexpr std::int64_t kMostTicks = std::int64_t{1} << 32;  // of a stream
constexpr const char* kShorter = "Cut a piece out of the trace with `tactus cut` and encode that.";

struct ViewOptions {
  std::string input, truth, scene, output;
  CommonOptions common;
};

tl::unexpected<Failure> too_large(const std::string& path, const std::string& what) {
  return refuse(shown_path(path) + ": " + what + ", more than a page can hold", kShorter);
}

/// Play what is due at a tick.   out  the stream ends inside a record: where
tl::expected<std::optional<Error>, Failure> play(Player& player, std::int64_t tick, PacketTable& packets,
                                                 const ViewOptions& options) {
  while (true) {
    const auto played = player.play(tick);
    if (!played && std::string_view(played.error().rule) == "R-FIL-2") return std::optional(played.error());
    if (!played) return refuse(options.input, played.error());
    if (!*played) return std::optional<Error>();
    packets.add(**played);
  }
}

Outcome check_same_scene(const ViewOptions& options, const TraceInfo& truth, const Scene& scene) {
  const auto differ = [&](const std::string& what) {
    return refuse(shown_path(options.truth) + ": " + what + " as in " + shown_path(options.input),
                  "Give the trace that the stream was encoded from.");
  };
  if (truth.shows_past)
    return refuse(shown_path(options.truth) + ": is what a client showed, not the truth", "Give the server's trace.");
  if (truth.tick_rate != scene.tick_rate) return differ(fmt::format("the tick rate is not {} Hz", scene.tick_rate));
  if (truth.objects.size() != scene.objects.size()) return differ(fmt::format("there are not {} objects", scene.objects.size()));
  for (std::size_t i = 0; i < truth.objects.size(); ++i)
    if (truth.objects[i].name != scene.objects[i].name || truth.objects[i].dof != scene.objects[i].dof)
      return differ(fmt::format("object {} does not have the name and the degrees of freedom", i));
  if (truth.meshes.size() != scene.deformables.size())
    return differ(fmt::format("there are not {} meshes", scene.deformables.size()));
  for (std::size_t i = 0; i < truth.meshes.size(); ++i)
    if (truth.meshes[i].name != scene.deformables[i].name ||
        truth.meshes[i].rest.vertices.size() != scene.deformables[i].rest.size())
      return differ(fmt::format("mesh {} does not have the name and the vertices", i));
  return {};
}

/// Both side by side, up to the end of the trace.
tl::expected<Json, Failure> truth_json(const ViewOptions& options, TraceReader& reader, Player& player, PacketTable& packets,
                                       Report& report) {
  ReadProgress progress("view", &reader, options.common.progress());
  std::optional<TruthData> data;
  TraceFrame frame;
  while (true) {
    TACTUS_TRY(const bool more, next_frame(reader, frame, options.truth));
    if (!more) break;
    if (!data) {
      auto created = TruthData::create(reader.info(), frame, player.scene());
      if (!created) return refuse(options.truth, created.error());
      data.emplace(std::move(*created));
    }
    TACTUS_TRY(const auto cut, play(player, frame.tick, packets, options));
    if (cut && report.ticks.count() == 0) return refuse(options.input, *cut);
    if (cut) break;
    if (const auto added = data->add(frame, player.replica()); !added)
      return refuse(options.truth, location_of_tick(frame.tick), added.error());
    if (data->bytes() > kMostPage) return too_large(options.truth, "is too long to lie beside the stream");
    report.ticks.add(frame.tick);
    progress.update(report.ticks.count());
  }
  TACTUS_CHECK(check_ending(options.truth, reader, report.ticks.count()));
  if (!data) return refuse(shown_path(options.truth) + ": has no tick", "Give the trace that the stream was encoded from.");
  auto json = data->declare();
  if (!json) return refuse(options.truth, json.error());
  json->update(data->take());
  return std::move(*json);
}

tl::expected<Json, Failure> shapes_json([[maybe_unused]] const ViewOptions& options,
                                        [[maybe_unused]] const std::string& attached) {
#ifdef TACTUS_HAS_SIM
  if (!options.scene.empty()) return scene_shapes(options.scene);
  return attached_shapes(attached);
#else
  return Json{{"objects", Json::array()}};
#endif
}

std::string file_name(const std::string& path) {
  return path == "-" ? "standard input" : std::filesystem::path(path).filename().string();
}

tl::expected<Json, Failure> page_data(const ViewOptions& options, const std::string& bytes, Report& report) {
  const std::span file(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  auto player = Player::open(file, {.limits = {.thesis = thesis_if_built()}});
  if (!player) return refuse(options.input, player.error());
  Json data{{"version", 1}, {"name", file_name(options.input)}};
  PacketTable packets;
  Json truth;
  std::string attached;
  report.describe(replica_info(player->scene(), ""));
  if (!options.truth.empty()) {
    auto reader = open_trace(options.truth, options.common.progress());
    if (!reader) return tl::unexpected(reader.error());
    TACTUS_CHECK(check_same_scene(options, reader->info(), player->scene()));
    attached = reader->info().scene;
    report.describe(reader->info());
    TACTUS_TRY(truth, truth_json(options, *reader, *player, packets, report));
    truth["name"] = file_name(options.truth);
  }
  TACTUS_TRY(const auto cut, play(*player, kMostTicks, packets, options));
  if (cut) warn_cut_stream(options.input, *cut);
  data["last_tick"] = std::max(packets.last_tick(), report.ticks.count() > 0 ? report.ticks.last() : 0);
  data["packets"] = packets.take();
  TACTUS_TRY(data["shapes"], shapes_json(options, attached));
  if (!truth.is_null()) data["truth"] = std::move(truth);
  data["stream"] = base64(bytes);
  return data;
}

Outcome run_view(const ViewOptions& given) {
  ViewOptions options = given;
  if (options.output.empty() && options.input == "-")
    return refuse_arguments("-o is missing: a stream from standard input gives the page no name", "Name the page with -o.");
  if (options.output.empty()) options.output = std::filesystem::path(options.input).replace_extension(".html").string();
  TACTUS_CHECK(OutputFile::check_free(options.output, options.common.existing(), {options.input, options.truth}));
  TACTUS_TRY(const auto bytes, read_file(options.input));
  if (bytes.size() > kMostPage) return too_large(options.input, fmt::format("has {} MB", bytes.size() >> 20));
  Report report{.command = "view", .files = {{"stream", options.input}}};
  if (!options.truth.empty()) report.files.emplace_back("truth", options.truth);
  report.files.emplace_back("page", options.output);
  TACTUS_TRY(const Json data, page_data(options, bytes, report));
  TACTUS_TRY(auto output, OutputFile::create(options.output, options.common.existing(), {options.input, options.truth}));
  TACTUS_TRY(const auto stream, output.open());
  write_page(*stream, page_json(data));
  TACTUS_CHECK(output.keep());
  print(report, options.common, beside(options.output));
  return {};
}

}  // namespace

void setup_view(Command& app, Action& action) {
  auto options = std::make_shared<ViewOptions>();
  Command& command = app.add_command("view", "Write a page that shows a stream: a browser decodes and draws it");
  command.add_option("STREAM", options->input, "Stream to show, - is standard input")->type_name("")->required();
  command
      .add_option("--truth", options->truth,
                  "Trace that the stream was encoded from: a ghost, forces and errors beside the stream")
      ->type_name("TRACE");
#ifdef TACTUS_HAS_SIM
  command.add_option("--scene", options->scene, "Scene with the shapes of the objects [the one in the truth, boxes only]")
      ->type_name("SCENE");
#endif
  command.add_option("-o,--output", options->output, "Page to write (HTML), - is standard output [STREAM with .html]")
      ->type_name("FILE");
  add_output_options(command, options->common);
  command.footer(
      "The page is one file that needs no network; open it in a browser with WebGL 2. Keys and colours are explained in it. A "
      "link that\n"
      "ends in #t=3.25 opens it at 3.25 s. Errors are those of `tactus compare`. A stream holds where objects are, not what they "
      "look like:\n"
      "without a truth or a scene they are drawn as axes.\n"
      "Example:\n  tactus view push.tct --truth push.mcap -o push.html");
  on_chosen<ViewOptions>(command, action, options, run_view);
}

}  // namespace tactus::cli
