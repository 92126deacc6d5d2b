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
#include <tactus/trace/mcap_reader.h>
#include <tactus/trace/trace_file.h>
#include "cli/commands/input.h"
#include "cli/options/options_codec.h"
#include "cli/output.h"
#include "cli/report/info.h"
#include "cli/report/json.h"
#include "cli/report/table.h"
#ifdef TACTUS_HAS_SIM
#include <tactus/sim/scene/scene.h>
#endif

namespace tactus::cli {
namespace {

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
    if (auto player = Player::open(bytes))
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
  auto player = Player::open(bytes);
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
  auto player = Player::open(bytes);
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

/// Topics with their types and message counts, from the container alone.
tl::expected<Json, Failure> channels_json(const InfoOptions& options) {
  const std::string& path = options.input;
  auto source = ByteSource::open_file(options.readable);
  if (!source) return refuse(path, source.error());
  auto reader = mcap::Reader::open(std::move(*source));
  if (!reader) return refuse(path, reader.error());
  std::map<std::uint16_t, std::uint64_t> counts;
  while (true) {
    const auto item = reader->next();
    if (!item) return refuse(path, item.error());
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
  auto reader = open_trace(options.readable, options.input);
  if (!reader) return tl::unexpected(reader.error());
  const TraceInfo& trace = reader->info();
  note_idle_options(*options.common.command, subjects_of(trace), "trace");
  TraceFrame frame;
  std::uint64_t frames = 0;
  std::int64_t first = 0;
  std::vector<std::uint64_t> shapes(trace.meshes.size());
  while (true) {
    const auto more = reader->next(frame);
    if (!more) return refuse(options.input, more.error());
    if (!*more) break;
    for (std::size_t i = 0; i < shapes.size(); ++i) shapes[i] += frame.meshes[i].updated ? 1U : 0U;
    if (frames++ == 0) first = frame.tick;
  }
  TACTUS_TRY(auto channels, channels_json(options));
  Value info = trace_info_value(trace, {frames, first, frame.tick, !reader->cut_short(), shapes});
  info.json["channels"] = std::move(channels);
  print(info, "info", options.common);
  return check_ending(options.input, *reader, frames);
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

Outcome run(const InfoOptions& options) {
#ifdef TACTUS_HAS_SIM
  if (options.input.ends_with(".toml")) return info_scene(options);
#endif
  TACTUS_TRY(const auto input, RereadableInput::open(options.input));
  InfoOptions readable = options;
  readable.readable = input.path();
  std::ifstream file(readable.readable, std::ios::binary);
  std::string magic(mcap::kMagic.size(), '\0');
  file.read(magic.data(), static_cast<std::streamsize>(magic.size()));
  if (magic.substr(0, 5) == "\x89MCAP") return info_trace(readable);
  return info_stream(readable);
}

}  // namespace

void setup_info(Command& app, Action& action) {
  auto options = std::make_shared<InfoOptions>();
  Command& command = app.add_command("info", "Show the contents of a stream, trace or scene");
  options->common.command = &command;
  command
      .add_option("FILE", options->input,
                  "Stream (.tct), trace (.mcap) or scene (.toml); - is a stream or trace on standard input")
      ->type_name("")
      ->required();
  command.add_flag("--packets", options->packets, "List every packet of a stream");
  command.add_flag("--json", options->common.json, "As JSON");
  command.footer("Example:\n  tactus info push.tct --packets");
  on_chosen<InfoOptions>(command, action, options, run);
}

}  // namespace tactus::cli
