// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <tactus/base/shown.h>
#include <tactus/metrics/errors.h>
#include <tactus/metrics/rates.h>
#include <tactus/trace/bag_folder.h>
#include <tactus/trace/mcap_reader.h>
#include <tactus/trace/trace_file.h>
#include "cli/commands/rereadable_input.h"
#include "cli/options/option_needs.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "cli/report/figures.h"
#include "cli/report/info_json.h"
#include "cli/report/json_parts.h"
#include "cli/report/table.h"
#include "cli/report/trace_ending.h"
#ifdef TACTUS_HAS_SIM
#include <tactus/sim/scene/scene.h>
#endif

namespace tactus::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kForces[] = {"felt, of the server", "felt", "of the server"};  // index: KnownForces

struct InfoOptions {
  std::string input;
  std::string readable;  // where to read it, again and again
  bool packets = false, json = false;
  const Command* command = nullptr;
};

std::string text_of(const Json& value) {
  if (value.is_number_float()) return fmt::format("{:.6g}", value.get<double>());
  if (value.is_null()) return "-";
  return value.is_string() ? value.get<std::string>() : value.dump();
}

/// Foreign names are cut, lists that this program made are not.
std::string cell_of(const std::string& name, const Json& value) {
  const bool is_list = name == "object:level" || name == "grid levels";
  return is_list ? text_of(value) : shown(text_of(value));
}

/// Scalars of an object as "name value" lines.
void print_scalars(const Json& object) {
  for (const auto& [name, value] : object.items()) {
    if (value.is_primitive()) fmt::print("{:<30} {}\n", name, cell_of(name, value));
  }
}

/// A list of equal objects as a table.
void print_list(const Json& list) {
  if (list.empty()) return;
  Table table;
  std::vector<std::string> cells;
  for (const auto& item : list.front().items()) cells.push_back(item.key());
  table.heading(cells);
  for (const Json& entry : list) {
    cells.clear();
    for (const auto& item : entry.items()) cells.push_back(cell_of(item.key(), item.value()));
    table.row(cells);
  }
  fmt::print("\n");
  table.print(stdout);
}

void print_info(const Json& info) {
  print_scalars(info);
  for (const auto& [name, value] : info.items()) {
    if (value.is_array()) print_list(value);
  }
}

std::string name_of_substream(const Scene& scene, std::size_t substream) {
  if (substream > scene.deformables.size()) return "loads";
  return substream == 0 ? "rigid objects" : scene.deformables[substream - 1].name;
}

Json packet_json(const PlayedPacket& played, const Scene& scene) {
  const bool is_rigid = played.substream == 0;
  Json out{{"tick", played.tick},
           {"byte", played.offset},
           {"sequence", played.sequence},
           {"bytes", played.bytes},
           {"key", played.key ? "key" : "-"}};
  if (!scene.deformables.empty() || scene.loads) out["substream"] = name_of_substream(scene, played.substream);
  out["reason"] = is_rigid ? kReasons[static_cast<std::size_t>(strongest_reason(played))] : "-";
  std::string updates;
  for (const RigidUpdate& u : played.updates) updates += fmt::format("{}{}:{}", updates.empty() ? "" : " ", u.object, u.level);
  out["object:level"] = updates.empty() ? "-" : updates;
  const bool is_shape = !is_rigid && played.loads == 0;
  if (!scene.deformables.empty()) {
    out["layer"] = !is_shape || played.layer == Layer::all ? "-" : kLayers[static_cast<std::size_t>(played.layer)];
    out["vertices"] = is_shape ? Json(played.vertices) : Json();
  }
  return out;
}

std::string text_of(const Sizes& sizes) {
  if (sizes.packets == 0) return "-";
  return fmt::format("{} to {}, mean {:.2f}", sizes.smallest, sizes.largest,
                     static_cast<double>(sizes.bytes) / static_cast<double>(sizes.packets));
}

/// What is said of rigid objects' packets.
void show_rigid(const StreamTotals& totals, Json& out) {
  const RateMetrics& traffic = totals.traffic;
  out["packets"] = traffic.all_packets();
  out["updates"] = traffic.updates;
  out["key packets"] = traffic.keys;
  if (traffic.all_packets() == 0) return;
  for (std::size_t i = kReasons.size(); i-- > 0;) out[fmt::format("for {}", kReasons[i])] = traffic.packets[i];
  out["bytes"] = traffic.bytes;
  out["bytes per packet"] = text_of(totals.rigid);
  std::string text;
  for (std::size_t i = 0; i < totals.levels.size(); ++i) {
    if (totals.levels[i] > 0) text += fmt::format("{}{} x level {}", text.empty() ? "" : ", ", totals.levels[i], i);
  }
  out["grid levels"] = text;
}

/// How a mesh is coded, and what of it the stream holds.
Json mesh_json(const DeformableObject& mesh, const Scene& scene, const DeformableRates& t) {
  const bool is_main = mesh.profile == DeformableProfile::main;
  return {{"deformable", mesh.name},
          {"profile", is_main ? mesh.layered ? "main, layered" : "main"
                              : fmt::format("thesis, q {}{}", mesh.quant_bits, mesh.models_kept ? ", models kept" : "")},
          {"vertices", mesh.rest.size()},
          {"triangles", mesh.triangles.size()},
          {"rings", mesh.rings},
          {"modes", mesh.basis.steps.size()},
          {"clusters", mesh.cluster_basis.count},
          {"frame [ms]", is_main ? Json(1e3 / 256 * mesh.frame_period / scene.tick_rate) : Json("-")},
          {"packets", t.sizes.size()},
          {"keys", t.keys},
          {"bytes", t.bytes},
          {"p99", t.quantile(0.99)},
          {"largest", t.quantile(1)}};
}

/// What of a mesh went in which layer.
Json layers_json(const DeformableRates& t) {
  Json out;
  for (std::size_t i = 0; i < t.layers.size(); ++i) {
    out[fmt::format("{} packets", kLayers[i])] = t.layers[i].packets;
    out[fmt::format("{} bytes", kLayers[i])] = t.layers[i].bytes;
  }
  return out;
}

Json header_json(const Scene& h, std::uint64_t header_bytes, std::size_t size) {
  const auto step = [](std::uint8_t exponent) { return 1.0 / static_cast<double>(std::uint64_t{1} << exponent); };
  Json out{{"kind", "stream"}};
  if (!h.objects.empty() || h.deformables.empty()) out["rigid profile"] = "thesis";
  out["file bytes"] = size;
  out["header bytes"] = header_bytes;
  out["ticks per second"] = h.tick_rate;
  out["position grid [um]"] = 1e6 * step(h.grid.position);
  out["rotation grid [urad]"] = 4e6 * step(h.grid.rotation);
  out["extrapolation at most [ticks]"] = h.max_extrapolation;
  out["baselines kept"] = h.baseline_span;
  return out;
}

/// A truncated stream gives a warning, as a truncated trace does: everything before the cut is usable.
Outcome end_of(const InfoOptions& options, const std::optional<Error>& error) {
  if (!error) return {};
  if (error->rule != std::string_view("R-FIL-2")) return refuse(options.input, *error);
  std::fflush(stdout);
  warn_cut_stream(options.input, *error);
  return {};
}

using Bytes = std::span<const std::uint8_t>;

/// What a stream holds, packet by packet, and how it ends.
template <class OnPacket>
std::optional<Error> for_each_packet(Player& player, OnPacket on_packet) {
  while (true) {
    const auto played = player.play(INT64_MAX);
    if (!played) return played.error();
    if (!*played) return std::nullopt;
    on_packet(**played);
  }
}

std::vector<std::string> cells_of(const Json& packet) {
  std::vector<std::string> cells;
  for (const auto& item : packet.items()) cells.push_back(cell_of(item.key(), item.value()));
  return shown_cells(std::move(cells));
}

std::vector<std::string> names_of(const Json& packet) {
  std::vector<std::string> names;
  for (const auto& item : packet.items()) names.push_back(item.key());
  return names;
}

/// Packets can be too many to be kept: `columns` has looked at them, and the stream is played again.
void print_packets(Bytes bytes, const Columns& columns) {
  auto player = Player::open(bytes);
  if (!player) return;
  bool first = true;
  for_each_packet(*player, [&](const PlayedPacket& played) {
    const Json packet = packet_json(played, player->scene());
    if (std::exchange(first, false)) {
      fmt::print("\n");
      print_heading(stdout, columns.aligned(names_of(packet)));
    }
    fmt::print("{}\n", columns.aligned(cells_of(packet)));
  });
}

/// The same as the last member of the JSON object `info`.
void print_with_packets(Bytes bytes, const Json& info) {
  const auto indented = [](std::string text) {
    for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 5) text.insert(at + 1, "    ");
    return text;
  };
  auto player = Player::open(bytes);
  std::string head = text_of_json(info);
  head.erase(head.rfind("\n}"));
  fmt::print("{},\n  \"packet_list\": [", head);
  bool first = true;
  if (player)
    for_each_packet(*player, [&](const PlayedPacket& played) {
      fmt::print("{}\n    {}", std::exchange(first, false) ? "" : ",", indented(text_of_json(packet_info_json(played))));
    });
  fmt::print("{}]\n}}\n", first ? "" : "\n  ");
}

Json summary_json(const Player& player, const StreamTotals& totals, std::size_t size, const std::optional<Error>& error) {
  Json info = header_json(player.scene(), player.header_bytes(), size);
  if (totals.traffic.all_packets() > 0 || totals.meshes.empty()) show_rigid(totals, info);
  if (player.scene().loads) {
    info["packets of loads"] = totals.loads.packets;
    info["bytes of loads"] = totals.loads.bytes;
  }
  info["last tick"] = totals.last_tick;
  info["ending"] = error               ? fmt::format("broken at {} ({})", place_of_bit(error->bit_offset), error->rule)
                   : player.complete() ? "complete"
                                       : "no trailer: the writer did not finish";
  for (const RigidObject& o : player.scene().objects) {
    const Pose pose = to_pose(o.initial, player.scene().grid.position);
    info["objects"].push_back(
        {{"object", o.name},
         {"moves along", dof_text(o.dof)},
         {"first position [m]", fmt::format("{:.4f} {:.4f} {:.4f}", pose.position.x, pose.position.y, pose.position.z)}});
  }
  const bool is_layered = std::ranges::any_of(totals.meshes, [](const DeformableRates& t) {
    return std::ranges::any_of(t.layers, [](const auto& h) { return h.packets > 0; });
  });
  for (std::size_t i = 0; i < totals.meshes.size(); ++i) {
    info["deformables"].push_back(mesh_json(player.scene().deformables[i], player.scene(), totals.meshes[i]));
    if (is_layered) info["deformables"].back().update(layers_json(totals.meshes[i]));
  }
  return info;
}

Outcome info_stream(const InfoOptions& options) {
  TACTUS_TRY(const auto file, read_file(options.readable));
  const Bytes bytes(reinterpret_cast<const std::uint8_t*>(file.data()), file.size());
  auto player = Player::open(bytes);
  if (!player) return refuse(options.input, player.error());
  StreamTotals totals(player->scene());
  Columns columns;  // of the list of packets
  const bool is_table = options.packets && !options.json;
  const std::optional<Error> error = for_each_packet(*player, [&](const PlayedPacket& played) {
    totals.add(played);
    if (!is_table) return;
    const Json packet = packet_json(played, player->scene());
    columns.look(names_of(packet), true);
    columns.look(cells_of(packet), false);
  });
  if (options.json) {
    const Json info = stream_info_json(*player, totals, bytes.size(), {error, player->complete()});
    if (options.packets) print_with_packets(bytes, info);
    else fmt::print("{}\n", text_of_json(info));
  } else {
    print_info(summary_json(*player, totals, bytes.size(), error));
    if (options.packets) print_packets(bytes, columns);
  }
  return end_of(options, error);
}

/// Topics with their types and message counts, from the container alone.
tl::expected<Json, Failure> channels_json(const InfoOptions& options) {
  const std::string& path = options.input;
  auto files = files_of(options.readable);
  if (!files) return refuse(path, files.error());
  auto reader = mcap::Reader::open(*std::move(files));
  if (!reader) return refuse(path, reader.error());
  std::map<std::uint16_t, std::uint64_t> counts;
  while (true) {
    const auto item = reader->next();
    if (!item) return refuse(path, reader->explain(item.error()));
    if (*item == mcap::Item::end) break;
    if (*item == mcap::Item::message) ++counts[reader->message().channel_id];
  }
  Json list = Json::array();
  for (const auto& [id, channel] : reader->channels()) {
    const auto schema = reader->schemas().find(channel.schema_id);
    list.push_back({{"topic", channel.topic},
                    {"type", schema == reader->schemas().end() ? "-" : schema->second.name},
                    {"messages", counts[id]}});
  }
  return list;
}

Outcome info_trace(const InfoOptions& options) {
  auto reader = TraceReader::open(options.readable);
  if (!reader) return refuse(options.input, reader.error());
  const TraceInfo& trace = reader->info();
  note_idle_options(*options.command, subjects_of(trace), "trace");
  TraceFrame frame;
  std::uint64_t frames = 0;
  std::int64_t first = 0;
  std::vector<std::uint64_t> shapes(trace.meshes.size());
  constexpr std::uint64_t kFramesBetween = 256;  // two looks at the bytes read
  Progress progress("bytes", reader->bytes().all, Visibility::shown);
  while (true) {
    if (frames % kFramesBetween == 0) progress.update(reader->bytes().read);
    const auto more = reader->next(frame);
    if (!more) return refuse(options.input, more.error());
    if (!*more) break;
    for (std::size_t i = 0; i < shapes.size(); ++i) shapes[i] += frame.meshes[i].updated ? 1U : 0U;
    if (frames++ == 0) first = frame.tick;
  }
  TACTUS_TRY(auto channels, channels_json(options));
  if (options.json) {
    Json info = trace_info_json(trace, {frames, first, frame.tick, !reader->cut_short(), shapes});
    info["channels"] = std::move(channels);
    fmt::print("{}\n", text_of_json(info));
    return check_ending(options.input, *reader, frames);
  }
  Json info{{"kind", "trace"},
            {"source", trace.source},
            {"ticks per second", trace.tick_rate},
            {"frames", frames},
            {"first tick", first},
            {"last tick", frame.tick},
            {"seconds", static_cast<double>(frame.tick - first + (frames > 0 ? 1 : 0)) / trace.tick_rate},
            {"scene", trace.scene.empty() ? "none" : fmt::format("{} bytes of TOML", trace.scene.size())},
            {"ending", reader->cut_short() ? "truncated; everything before the cut was read" : "complete"}};
  if (trace.capture) {
    info["captured"] = text_of_wall_time(trace.capture->started);
    info["device"] = fmt::format("{} ({})", trace.capture->device, trace.capture->backend);
    info["real time"] = trace.capture->scheduling;
    if (!trace.capture->subject.empty()) info["subject"] = trace.capture->subject;
    if (!trace.capture->remarks.empty()) info["remarks"] = trace.capture->remarks;
  }
  for (const TraceObject& o : trace.objects) info["objects"].push_back({{"object", o.name}, {"moves along", dof_text(o.dof)}});
  for (std::size_t i = 0; i < trace.meshes.size(); ++i) {
    const TriMesh& rest = trace.meshes[i].rest;
    info["deformables"].push_back({{"deformable", trace.meshes[i].name},
                                   {"vertices", rest.vertices.size()},
                                   {"triangles", rest.triangles.size()},
                                   {"fixed", trace.meshes[i].fixed.size()},
                                   {"period [ticks]", trace.meshes[i].period},
                                   {"new shapes", shapes[i]}});
  }
  for (const TraceUser& user : trace.users)
    info["users"].push_back({{"user", user.name}, {"known forces", kForces[static_cast<std::size_t>(user.forces)]}});
  info["channels"] = std::move(channels);
  print_info(info);
  return check_ending(options.input, *reader, frames);
}

#ifdef TACTUS_HAS_SIM
Outcome info_scene(const InfoOptions& options) {
  const auto scene = sim::load_scene(options.input);
  if (!scene) return refuse(scene.error());
  note_idle_options(*options.command, {}, "scene");
  if (options.json) {
    fmt::print("{}\n", text_of_json(scene_info_json(*scene)));
    return {};
  }
  Json info{{"kind", "scene"},
            {"name", scene->name},
            {"seconds", scene->duration},
            {"floor", scene->floor ? fmt::format("at {} m", *scene->floor) : "none"}};
  if (scene->touch) info["touch stiffness"] = fmt::format("{} N/m", scene->touch->stiffness);
  for (const sim::SceneObject& o : scene->objects) {
    info["objects"].push_back(
        {{"object", o.name},
         {"moves along", dof_text(o.dof)},
         {"mass [kg]", o.mass},
         {"friction", o.friction},
         {"shape", o.surface.triangles.empty() ? "box" : fmt::format("{} triangles", o.surface.triangles.size())},
         {"size [m]", fmt::format("{:.6g} {:.6g} {:.6g}", o.size.x, o.size.y, o.size.z)}});
  }
  for (const sim::SceneMsd& m : scene->msds) {
    info["one-dimensional objects"].push_back({{"object", m.name},
                                               {"moves along", dof_text(m.dof())},
                                               {"stiffness [N/m]", m.object.stiffness},
                                               {"damping [N s/m]", m.object.damping},
                                               {"mass [kg]", m.object.mass},
                                               {"deformed", fmt::format("every {} ms", m.rate)}});
  }
  for (const sim::SceneDeformable& d : scene->deformables) {
    info["deformables"].push_back({{"deformable", d.name},
                                   {"vertices", d.mesh.vertices.size()},
                                   {"tetrahedra", d.mesh.tets.size()},
                                   {"fixed vertices", d.fixed.size()},
                                   {"deformed", fmt::format("every {} ms", d.rate)},
                                   {"coupling [N/m]", d.stiffness}});
  }
  for (const sim::SceneUser& u : scene->users) info["users"].push_back({{"user", u.name}, {"phases of the path", u.path.size()}});
  print_info(info);
  return {};
}
#endif

Outcome run(const InfoOptions& options) {
#ifdef TACTUS_HAS_SIM
  if (options.input.ends_with(".toml")) return info_scene(options);
#endif
  TACTUS_TRY(const auto input, RereadableInput::open(options.input));
  InfoOptions readable = options;
  readable.readable = input.path();
  std::ifstream file(readable.readable, std::ios::binary);
  std::string magic(4, '\0');
  file.read(magic.data(), static_cast<std::streamsize>(magic.size()));
  return magic == "\x89TCT" ? info_stream(readable) : info_trace(readable);  // what is neither is named there
}

}  // namespace

void setup_info(Command& app, Action& action) {
  auto options = std::make_shared<InfoOptions>();
  Command& command = app.add_command("info", "Show the contents of a stream, trace or scene");
  options->command = &command;
  command
      .add_option("FILE", options->input,
                  "Stream (.tct), trace (.mcap) or scene (.toml); - is a stream or trace on standard input")
      ->type_name("")
      ->required();
  command.add_flag("--packets", options->packets, "List every packet of a stream");
  command.add_flag("--json", options->json, "As JSON");
  command.footer("Example:\n  tactus info push.tct --packets");
  on_chosen<InfoOptions>(command, action, options, run);
}

}  // namespace tactus::cli
