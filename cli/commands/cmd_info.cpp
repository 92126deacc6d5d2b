// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <tactus/base/shown.h>
#include <tactus/thesis/if_built.h>
#include <tactus/trace/trace_file.h>
#include "cli/commands/input.h"
#include "cli/options/options_codec.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "cli/report/info.h"
#include "cli/report/json.h"
#include "cli/report/notes.h"
#include "cli/report/report.h"
#include "cli/report/table.h"
#ifdef TACTUS_HAS_SIM
#include <tactus/sim/scene/scene.h>
#endif

namespace tactus::cli {
namespace {

ReceiverOptions receiver_options() { return {.limits = {.thesis = thesis_if_built()}}; }

struct InfoOptions {
  std::string input;
  std::string readable;  // where to read it, again and again
  bool packets = false;
  CommonOptions common;
};

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

/// The list of packets. They can be too many to be kept: the stream is played once for the widths, and again to print. Columns that no
/// packet has are left out.
class PacketTable {
 public:
  void look(const Json& packet) {
    const std::vector<std::string> row = cells(packet);
    for (std::size_t i = 0; i < row.size(); ++i) seen_[i] = seen_[i] || !row[i].empty();
    columns_.look(row, false);
  }
  void print(Bytes bytes) {
    std::vector<std::string> heading;
    for (const auto& [key, property] : properties_.items()) heading.push_back(property["title"]);
    for (std::size_t i = 0; i < seen_.size(); ++i)
      if (!seen_[i]) heading[i].clear();
    columns_.look(heading, true);
    fmt::print("\n");
    print_heading(stdout, columns_.aligned(heading));
    if (auto player = Player::open(bytes, receiver_options()))
      for_each_packet(*player, [&](const PlayedPacket& played) { print_row(packet_info_value(played, player->scene()).json); });
  }

 private:
  std::vector<std::string> cells(const Json& packet) const {
    std::vector<std::string> out;
    for (const auto& [key, property] : properties_.items()) {
      const auto member = packet.find(key);
      out.push_back(member == packet.end() ? "" : cell_of(*member, property));
    }
    return shown_cells(std::move(out));
  }
  void print_row(const Json& packet) const {
    std::vector<std::string> row = cells(packet);
    for (std::size_t i = 0; i < row.size(); ++i)
      if (seen_[i] && row[i].empty()) row[i] = "-";
    fmt::print("{}\n", columns_.aligned(row));
  }

  const Json& properties_ = schema("info")["oneOf"][0]["properties"]["packet_list"]["items"]["properties"];
  std::vector<bool> seen_ = std::vector<bool>(properties_.size());
  Columns columns_;
};

/// The same as the last member of the JSON object `info`.
void print_with_packets(Bytes bytes, const Json& info) {
  const auto indented = [](std::string text) {
    for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 5) text.insert(at + 1, "    ");
    return text;
  };
  auto player = Player::open(bytes, receiver_options());
  std::string head = text_of_json(info);
  head.erase(head.rfind("\n}"));
  fmt::print("{},\n  \"packet_list\": [", head);
  bool first = true;
  if (player)
    for_each_packet(*player, [&](const PlayedPacket& played) {
      fmt::print("{}\n    {}", std::exchange(first, false) ? "" : ",",
                 indented(text_of_json(packet_info_value(played, player->scene()).json)));
    });
  fmt::print("{}]\n}}\n", first ? "" : "\n  ");
}

Outcome info_stream(const InfoOptions& options) {
  TACTUS_TRY(const auto file, read_file(options.readable));
  const Bytes bytes(reinterpret_cast<const std::uint8_t*>(file.data()), file.size());
  auto player = Player::open(bytes, receiver_options());
  if (!player) return refuse(options.input, player.error());
  StreamTotals totals(player->scene());
  PacketTable table;
  const bool is_table = options.packets && !options.common.json;
  const std::optional<Error> error = for_each_packet(*player, [&](const PlayedPacket& played) {
    totals.add(played);
    if (is_table) table.look(packet_info_value(played, player->scene()).json);
  });
  const Value info = stream_info_value(*player, totals, bytes.size(), {error, player->complete()});
  if (options.packets && options.common.json) print_with_packets(bytes, info.json);
  else print(info, "info", options.common);
  if (is_table && !totals.is_empty()) table.print(bytes);
  return end_of(options, error);
}

Json topics_json(const std::vector<TraceTopic>& topics) {
  Json list = Json::array();
  for (const TraceTopic& topic : topics)
    list.push_back({{"topic", topic.topic}, {"type", topic.type.empty() ? "-" : topic.type}, {"messages", topic.messages}});
  return list;
}

/// Users who feel forces without any contact: for them a stream declares no bounds.
class UnboundForces {
 public:
  explicit UnboundForces(const TraceInfo& info) : info_(info), users_(info.users.size()) {}
  void add(const TraceFrame& frame) {
    for (std::size_t i = 0; i < users_.size(); ++i) {
      const UserSample& user = frame.users[i];
      users_[i].has_force = users_[i].has_force || norm(user.force) > 0 || norm(user.server_force) > 0;
      users_[i].has_contact = users_[i].has_contact || user.contact.kind != ContactKind::none || user.surface_contact;
    }
  }
  void write_to(Json& out) const {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < users_.size(); ++i)
      if (users_[i].has_force && !users_[i].has_contact) names.push_back(info_.users[i].name);
    if (names.empty()) return;
    out["users_without_force_bound"] = names;
    out["force_bound"] = missing_force_bound(names, info_.objects.size(), "`tactus encode --contact`");
  }

 private:
  struct User {
    bool has_force = false, has_contact = false;
  };
  const TraceInfo& info_;
  std::vector<User> users_;
};

/// Ticks of a trace.
struct TickTotals {
  std::uint64_t frames = 0;
  std::int64_t first = 0, last = 0;
  std::vector<std::uint64_t> shapes;  ///< new ones, of each mesh
};

tl::expected<TickTotals, Failure> read_ticks(TraceReader& reader, const InfoOptions& options, UnboundForces& unbound) {
  constexpr std::uint64_t kFramesBetween = 256;  // two looks at the bytes read
  Progress progress("info", reader.bytes().all, Visibility::shown);
  TickTotals totals{.shapes = std::vector<std::uint64_t>(reader.info().meshes.size())};
  TraceFrame frame;
  while (true) {
    if (totals.frames % kFramesBetween == 0) progress.update(reader.bytes().read);
    TACTUS_TRY(const bool more, next_frame(reader, frame, options.input));
    if (!more) return totals;
    unbound.add(frame);
    for (std::size_t i = 0; i < totals.shapes.size(); ++i) totals.shapes[i] += frame.meshes[i].updated ? 1U : 0U;
    if (totals.frames++ == 0) totals.first = frame.tick;
    totals.last = frame.tick;
  }
}

Outcome info_trace(const InfoOptions& options) {
  auto reader = open_trace(options.readable, options.input, Visibility::shown);
  if (!reader) return tl::unexpected(reader.error());
  const TraceInfo& trace = reader->info();
  note_idle_options(*options.common.command, subjects_of(trace), "trace");
  UnboundForces unbound(trace);
  TACTUS_TRY(const TickTotals ticks, read_ticks(*reader, options, unbound));
  Value info = trace_info_value(trace, {ticks.frames, ticks.first, ticks.last, !reader->cut_short(), ticks.shapes});
  info.json["channels"] = topics_json(reader->topics());
  unbound.write_to(info.json);
  if (const auto notes = texts_of(reader->notes()); !notes.empty()) info.json["notes"] = notes;
  print(info, "info", options.common);
  return check_ending(options.input, *reader, ticks.frames);
}

#ifdef TACTUS_HAS_SIM
Outcome info_scene(const InfoOptions& options) {
  const auto scene = sim::load_scene(options.input);
  if (!scene) return refuse(scene.error());
  note_idle_options(*options.common.command, {}, "scene");
  print(scene_info_value(*scene), "info", options.common);
  return {};
}
#endif

Outcome run_info(const InfoOptions& options) {
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
  options->common.command = &command;
  command
      .add_option("FILE", options->input,
                  "Stream (.tct), trace (.mcap, or a bag's folder) or scene (.toml); - is a stream or trace on standard input")
      ->type_name("")
      ->required();
  command.add_flag("--packets", options->packets, "List every packet of a stream");
  command.add_flag("--json", options->common.json, "As JSON");
  command.footer("Example:\n  tactus info push.tct --packets");
  on_chosen<InfoOptions>(command, action, options, run_info);
}

}  // namespace tactus::cli
