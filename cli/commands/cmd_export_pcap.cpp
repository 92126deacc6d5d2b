// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <tactus/base/shown.h>
#include <tactus/thesis/if_built.h>
#include <tactus/trace/trace_file.h>
#include <tactus/trace/trace_scene.h>
#include "cli/commands/commands.h"
#include "cli/commands/input.h"
#include "cli/commands/session_capture.h"
#include "cli/live/live_report.h"
#include "cli/options/option_needs.h"
#include "cli/options/options_codec.h"
#include "cli/options/options_link.h"
#include "cli/report/held_log.h"
#include "cli/report/json.h"
#include "cli/report/messages.h"

namespace tactus::cli {
namespace {

struct ExportPcapOptions {
  std::string input, output, at = "client";
  sim::LinkOptions link;
  std::optional<sim::LinkOptions> uplink;  // to the server, if it differs
  bool observe = false;
  TriggerArguments triggers;
  MeshArguments meshes;
  MotionArguments motion;
  CommonOptions common;
};

constexpr std::uint8_t kBaselines = 64;  // as the simulation and `serve` declare

/// A trace on its way through sessions.
struct Playback {
  TraceReader reader;
  TraceFrame frame;
  std::unique_ptr<sim::SessionNetwork> network;
  FrameTruth truth;
  std::vector<DeviceSample> devices{};  // of the clients that have one
  std::vector<std::optional<DeviceContact>> contacts{};
  HeldLog held{};
};

bool are_participants(const ExportPcapOptions& options, const TraceInfo& info) { return !options.observe && !info.users.empty(); }

Result<std::unique_ptr<sim::SessionNetwork>> connect(const TraceInfo& info, const TraceFrame& first,
                                                     const ExportPcapOptions& options, SessionCapture& capture) {
  const SenderOptions sender = options.meshes.sender(options.triggers);
  TACTUS_TRY(SceneBuilder builder, scene_builder(info, first, options.meshes.coding(options.triggers), sender));
  TACTUS_TRY(SharedScene scene,
             builder.motion(options.motion.physics()).baselines(kBaselines).build({.thesis = thesis_if_built()}));
  sim::NetworkOptions network;
  network.downlink = options.link;
  network.uplink = options.uplink.value_or(options.link);
  network.role = are_participants(options, info) ? Role::participant : Role::observer;
  network.observer = capture.observer();
  const std::size_t clients = network.role == Role::participant ? info.users.size() : 1;
  return sim::SessionNetwork::create(std::move(scene), clients, sender, network);
}

/// What the device of a recorded user feels: the proxy is where the recorded force pulls it.
std::optional<DeviceContact> recorded_contact(const UserSample& user, const TraceFrame& frame) {
  if (const auto& surface = user.surface_contact) return DeviceContact{surface->proxy, surface->stiffness};
  const Contact& contact = user.contact;
  if (contact.kind == ContactKind::none || contact.object >= frame.objects.size() || contact.stiffness <= 0) return std::nullopt;
  const Vec3 force = contact_force(contact, frame.objects[contact.object].pose);
  return DeviceContact{contact.device + (1 / contact.stiffness) * force, contact.stiffness};
}

Result<void> play_frame(Playback& play, std::int64_t tick) {
  const TraceFrame& frame = play.frame;
  for (std::size_t i = 0; i < play.devices.size(); ++i) {
    play.devices[i] = frame.users[i].device;
    play.contacts[i] = recorded_contact(frame.users[i], frame);
  }
  TACTUS_CHECK(play.network->to_server(tick, play.devices, play.contacts));
  TACTUS_CHECK(play.network->to_clients(tick, play.truth.of(frame)));
  play.held.look(tick, play.network->held());
  return {};
}

/// Ticks count from the first of the trace, and pauses of the recording take their time.
Outcome play_all(Playback& play, const ExportPcapOptions& options, TickSpan& ticks) {
  ReadProgress progress("export", &play.reader, options.common.progress());
  const std::int64_t first = play.frame.tick;
  for (;;) {
    const std::int64_t tick = play.frame.tick;
    if (const auto done = play_frame(play, tick - first); !done)
      return refuse(options.input, location_of_tick(tick), done.error());
    ticks.add(tick);
    progress.update(ticks.count());
    TACTUS_TRY(const bool more, next_frame(play.reader, play.frame, options.input));
    if (!more) break;
  }
  if (const Receiver* const receiver = play.network->view(0).receiver)
    for (const std::string& line : play.held.lines(*receiver->scene()))
      fmt::print(stderr, "warning: {}: {}\n", shown_path(options.input), printable(line));
  play.network->leave();
  return {};
}

Json count_json(const SessionCapture::Count& count) { return {{"datagrams", count.datagrams}, {"bytes", count.bytes}}; }

Value pcap_value(const ExportPcapOptions& options, const Playback& play, const SessionCapture& capture, const TickSpan& ticks) {
  const TraceInfo& info = play.reader.info();
  const double seconds = static_cast<double>(ticks.length()) / info.tick_rate;
  const bool participants = are_participants(options, info);
  Json out{{"schema", "tactus.pcap/1"},
           {"trace", options.input},
           {"capture", options.output},
           {"at", options.at},
           {"seconds", seconds},
           {"start_us", play.network->start()},
           {"server", SessionCapture::text_of(SessionCapture::server())}};
  out["clients"] = Json::array();
  const std::size_t clients = participants ? info.users.size() : 1;
  for (std::size_t i = 0; i < clients; ++i) {
    const SessionCapture::Client captured = capture.count(i);
    const SessionStatus status = play.network->status(i);
    Json client{{"user", participants ? info.users[i].name : ""},
                {"role", participants ? "participant" : "observer"},
                {"address", SessionCapture::text_of(SessionCapture::client(i))},
                {"captured", {{"up", count_json(captured.up)}, {"down", count_json(captured.down)}}},
                {"declaration_bytes", status.declaration},
                {"traffic", traffic_value(status.traffic, seconds, {})}};
    if (status.round_trip) client["round_trip"] = round_trip_value(*status.round_trip);
    out["clients"].push_back(std::move(client));
  }
  return out;
}

Outcome run_export_pcap(const ExportPcapOptions& options) {
  TACTUS_CHECK(check_no_terminal(options.output));
  auto reader = open_trace(options.input, options.common.progress());
  if (!reader) return tl::unexpected(reader.error());
  TraceFrame first;
  TACTUS_TRY(const bool any, next_frame(*reader, first, options.input));
  if (!any) {
    TACTUS_CHECK(check_ending(options.input, *reader, 0));
    return refuse(shown_path(options.input) + ": the trace has no frames", "Record or simulate at least one tick.");
  }
  const TraceInfo info = reader->info();
  note_idle_options(*options.common.command, subjects_of(info), "trace");
  const auto end = options.at == "server" ? SessionCapture::End::server : SessionCapture::End::client;
  TACTUS_TRY(const auto capture, SessionCapture::create(options.output, options.common.existing(), {options.input}, end));
  auto network = connect(info, first, options, *capture);
  if (!network) return refuse(options.input, network.error());
  Playback play{
      .reader = std::move(*reader), .frame = std::move(first), .network = std::move(*network), .truth = FrameTruth(info)};
  if (are_participants(options, info)) {
    play.devices.resize(info.users.size());
    play.contacts.resize(info.users.size());
  }
  TickSpan ticks;
  TACTUS_CHECK(play_all(play, options, ticks));
  TACTUS_CHECK(check_ending(options.input, play.reader, ticks.count()));
  TACTUS_CHECK(capture->keep());
  print(pcap_value(options, play, *capture, ticks), "pcap", options.common, options.output == "-" ? stderr : stdout);
  return {};
}

}  // namespace

void setup_export_pcap(Command& group, Action& action) {
  auto options = std::make_shared<ExportPcapOptions>();
  Command& command = group.add_command("pcap", "The datagrams of a session over an emulated network, for Wireshark");
  command.add_option("TRACE", options->input, "Trace whose objects the server sends (MCAP), - is standard input")
      ->type_name("")
      ->required();
  command.add_option("-o,--output", options->output, "Capture to write (pcap, UDP over IPv4), - is standard output")
      ->required()
      ->type_name("FILE");
  add_link(command, "--link", options->link, "Network between server and clients, the same there and back [perfect]");
  add_link(command, "--uplink", options->uplink, "Network from the clients to the server, if it differs");
  command
      .add_option("--at", options->at,
                  "Whose network interface is captured: client (what clients send, and what reaches them) or server [client]")
      ->one_of({"client", "server"})
      ->type_name("");
  command.add_flag("--observe", options->observe,
                   "One client that only looks on; otherwise each user of the trace takes part and sends the recorded device");
  add_encoder_options(command, options->triggers, options->meshes);
  options->motion.add_to(command);
  add_output_options(command, options->common);
  command.footer(
      "Examples:\n"
      "  tactus export pcap push.mcap -o push.pcap -p 4% --link delay=20ms,jitter=5ms,loss=1%\n"
      "  tactus export pcap push.mcap -o - -q | wireshark -X lua_script:tools/wireshark/tactus.lua -k -i -\n"
      "\n"
      "Time stamps are the server's clock in virtual time: datagrams of an event have the same. The same seed gives the same "
      "bytes.\n" +
      std::string(link_help()));
  on_chosen<ExportPcapOptions>(command, action, options, run_export_pcap);
}

}  // namespace tactus::cli
