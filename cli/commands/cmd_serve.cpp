// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include <tactus/net/udp.h>
#include <tactus/session/session_server.h>
#include <tactus/sim/server.h>
#include <tactus/trace/trace_file.h>
#include "cli/commands/stop.h"
#include "cli/live/live_report.h"
#include "cli/live/meter.h"
#include "cli/live/ticker.h"
#include "cli/options/option_needs.h"
#include "cli/options/options_codec.h"
#include "cli/options/options_link.h"
#include "cli/options/units.h"
#include "cli/output.h"
#include "cli/report/json_parts.h"
#include "cli/report/messages.h"

namespace tactus::cli {
namespace {

using Json = nlohmann::ordered_json;

struct ServeOptions {
  std::string scene, listen = "7447", output;
  std::uint32_t clients = 8;
  double duration = 0;  // [s], 0: until interrupted
  double rate = 0;      // [bit/s] to each client
  std::uint64_t seed = 1;
  TriggerArguments triggers;
  MeshArguments meshes;
  CommonOptions common;
};

/// Who sent datagrams: the session names addresses by their keys.
class Peers {
 public:
  explicit Peers(std::size_t most) : most_(most) {}

  std::uint64_t name(const net::Address& from) {
    last_ = from;
    return from.key();
  }
  /// The sender of the last datagram has a session.
  void keep() {
    if (std::ranges::find(known_, last_) != known_.end()) return;
    if (known_.size() == most_) known_.erase(known_.begin());
    known_.push_back(last_);
  }
  const net::Address* find(std::uint64_t peer) const {
    const auto found = std::ranges::find(known_, peer, &net::Address::key);
    if (found != known_.end()) return &*found;
    return last_.key() == peer ? &last_ : nullptr;
  }

 private:
  std::size_t most_;
  std::vector<net::Address> known_;
  net::Address last_;
};

/// Serves a simulated world in real time.
class Service {
 public:
  Service(sim::Server& world, SessionServer& sessions, net::UdpSocket& socket)
      : world_(world),
        sessions_(sessions),
        socket_(socket),
        peers_(4 * std::size_t{sessions.clients()}),
        players_(world.scene().users.size()) {
    for (const sim::SceneUser& user : world.scene().users) devices_.push_back({.position = user.start});
  }

  /// Take what has come, and what time has brought.
  void hear(std::uint64_t now);
  /// A tick of the world.
  Outcome step(std::uint64_t now, std::optional<TraceWriter>& trace, const std::string& output);
  void say(std::uint64_t now);
  std::size_t live() const;
  std::uint64_t refused() const { return refused_; }

 private:
  void seat(const ServerEvent& event);

  sim::Server& world_;
  SessionServer& sessions_;
  net::UdpSocket& socket_;
  Peers peers_;
  std::vector<std::optional<std::uint16_t>> players_;  // the client that plays each user of the scene
  std::vector<DeviceSample> devices_;
  std::array<std::uint8_t, 2048> buffer_{};
  std::uint64_t refused_ = 0;
};

void Service::hear(std::uint64_t now) {
  while (const auto received = socket_.receive(buffer_)) {
    if (sessions_.handle_datagram(now, peers_.name(received->from), received->bytes)) peers_.keep();
    else ++refused_;
    say(now);
  }
  sessions_.handle_timeout(now);
}

/// A participant plays the first user of the scene whom nobody plays.
void Service::seat(const ServerEvent& event) {
  if (event.kind == ServerEvent::Kind::left) {
    for (auto& player : players_)
      if (player == event.client) player.reset();
    return;
  }
  if (event.kind != ServerEvent::Kind::live || sessions_.status(event.client).role != Role::participant) return;
  const auto free = std::ranges::find_if(players_, [](const auto& player) { return !player; });
  if (free != players_.end()) *free = event.client;
}

void Service::say(std::uint64_t now) {
  while (const auto datagram = sessions_.poll_datagram(now))
    if (const net::Address* to = peers_.find(datagram->peer)) socket_.send(*to, datagram->bytes);
  while (const auto event = sessions_.poll_event()) seat(*event);
}

Outcome Service::step(std::uint64_t now, std::optional<TraceWriter>& trace, const std::string& output) {
  for (std::size_t i = 0; i < players_.size(); ++i)
    if (players_[i]) devices_[i] = sessions_.device(*players_[i], now).value_or(devices_[i]);
  world_.observe();
  world_.touch(devices_);
  const TraceFrame& frame = world_.frame();
  if (const auto sent = sessions_.submit(now, frame.tick, world_.truth()); !sent)
    return refuse("session", place_of_tick(frame.tick), sent.error());
  say(now);
  if (trace)
    if (const auto written = trace->write(frame); !written) return refuse(output, place_of_tick(frame.tick), written.error());
  if (auto stepped = world_.step(); !stepped) return refuse(stepped.error());
  return {};
}

std::size_t Service::live() const {
  std::size_t count = 0;
  for (std::uint16_t i = 0; i < sessions_.clients(); ++i) count += sessions_.status(i).state == SessionState::live ? 1u : 0u;
  return count;
}

std::string meter_text(const sim::Server& world, const SessionServer& sessions, const Service& service, const Ticker& ticker) {
  std::string text =
      fmt::format("{:.1f} s  {}", 1e-3 * static_cast<double>(world.frame().tick), counted(service.live(), "client"));
  for (std::uint16_t i = 0; i < sessions.clients(); ++i) {
    const ClientStatus status = sessions.status(i);
    if (status.state != SessionState::live || !status.round_trip) continue;
    text += fmt::format("  [{}] {:.1f} ms, loss {:.1f} %", i, 1e-3 * static_cast<double>(status.round_trip->smoothed),
                        100 * status.loss);
  }
  return text + fmt::format("  missed {}", ticker.missed());
}

/// Of each substream, as a client has it that got every packet.
Json hashes_json(const SessionServer& sessions, const tactus::Scene& scene, std::uint16_t client) {
  Json out = Json::array();
  const auto add = [&](std::size_t substream) { out.push_back(fmt::format("{:016x}", sessions.state_hash(client, substream))); };
  if (!scene.objects.empty()) add(0);
  for (std::size_t i = 0; i < scene.deformables.size(); ++i) add(i + 1);
  return out;
}

Json to_json(const ServeOptions& options, const SessionServer& sessions, const tactus::Scene& scene, const Service& service,
             const Ticker& ticker, double seconds) {
  Json out{{"schema", "tactus.serve/1"}, {"scene", options.scene}, {"listen", options.listen}, {"seconds", seconds}};
  out["pace"] = pace_json(ticker);
  out["datagrams_refused"] = service.refused();
  out["clients"] = Json::array();
  for (std::uint16_t i = 0; i < sessions.clients(); ++i) {
    const ClientStatus status = sessions.status(i);
    if (status.traffic.datagrams_sent == 0) continue;
    Json client{{"client", i},
                {"state", name_of(status.state)},
                {"role", status.role == Role::observer ? "observer" : "participant"},
                {"loss", status.loss},
                {"traffic", traffic_json(status.traffic, seconds)}};
    if (status.round_trip) client["round_trip"] = round_trip_json(*status.round_trip);
    if (status.state == SessionState::live) client["state_hashes"] = hashes_json(sessions, scene, i);
    out["clients"].push_back(std::move(client));
  }
  return out;
}

void print_text(const ServeOptions& options, const SessionServer& sessions, const Service& service, const Ticker& ticker,
                double seconds) {
  Table head;
  head.heading({"serve"});
  head.row({fmt::format("  {:<8} {}", "scene", options.scene)});
  head.row({fmt::format("  {:<8} {}", "listen", options.listen)});
  head.row({fmt::format("  {:<8} {:.3f} s", "time", seconds)});
  if (service.refused() > 0) head.row({fmt::format("  {:<8} {}", "refused", counted(service.refused(), "datagram"))});
  head.print(stdout);
  fmt::print("\n");
  Table table;
  traffic_heading(table);
  for (std::uint16_t i = 0; i < sessions.clients(); ++i) {
    const ClientStatus status = sessions.status(i);
    if (status.traffic.datagrams_sent == 0) continue;
    traffic_row(table, fmt::format("to client {}, {}", i, status.role == Role::observer ? "observer" : "participant"),
                status.traffic, seconds);
  }
  pace_rows(table, ticker);
  table.print(stdout);
}

tl::expected<std::unique_ptr<sim::Server>, Failure> make_world(const ServeOptions& options) {
  const auto path = sim::find_scene(options.scene);
  if (!path) return refuse(path.error());
  const auto scene = sim::load_scene(*path);
  if (!scene) return refuse(scene.error());
  auto world = sim::Server::create(
      *scene,
      {.seed = options.seed, .codec = sim::ServerCodec{options.meshes.sender(options.triggers), options.meshes.coding(), true}});
  if (!world) return refuse(options.scene, world.error());
  return std::move(*world);
}

Outcome run(const ServeOptions& typed) {
  ServeOptions options = typed;
  TACTUS_TRY(const net::Address listen, loopback_address("--listen", options.listen));
  TACTUS_TRY(const auto world, make_world(options));
  auto socket = net::UdpSocket::bind(listen);
  if (!socket) return refuse(options.listen, socket.error());
  options.listen = socket->own().text();
  const SessionServerOptions settings{.sender = options.meshes.sender(options.triggers),
                                      .clients = static_cast<std::uint16_t>(options.clients),
                                      .rate = static_cast<std::uint64_t>(options.rate)};
  auto sessions = SessionServer::create(world->stream_scene(), settings, system_entropy(), microseconds_now());
  if (!sessions) return refuse(options.scene, sessions.error());
  std::optional<OutputFile> output;
  std::optional<TraceWriter> trace;
  if (!options.output.empty()) {
    TACTUS_TRY(auto file, OutputFile::create_growing(options.output, options.common.existing(), {options.scene}));
    output.emplace(std::move(file));
    TraceInfo info = world->info();
    info.source = "serve " + world->scene().name;
    auto writer = TraceWriter::create(output->working_path(), info);
    if (!writer) return refuse(options.output, writer.error());
    trace.emplace(std::move(*writer));
  }
  if (!options.common.quiet) fmt::print(stderr, "serving {} at {}\n", options.scene, options.listen);

  const StopOnSignal stop;
  Meter meter(options.common.progress());
  Service service(*world, *sessions, *socket);
  const auto ticks = options.duration > 0 ? std::llround(options.duration * sim::kTickRate) : INT64_MAX;
  Ticker ticker(1'000'000 / sim::kTickRate);
  while (StopOnSignal::caught() == 0 && world->frame().tick < ticks) {
    const auto woken = ticker.wait(socket->handle(), sessions->next_timeout().value_or(UINT64_MAX));
    const std::uint64_t now = microseconds_now();
    service.hear(now);
    if (woken == Ticker::Woken::by_tick) TACTUS_CHECK(service.step(now, trace, options.output));
    service.say(now);
    if (meter.is_due(now)) meter.draw(now, meter_text(*world, *sessions, service, ticker));
  }
  const double seconds = static_cast<double>(ticker.ticks()) / sim::kTickRate;
  const Json report = to_json(options, *sessions, *world->stream_scene(), service, ticker, seconds);
  sessions->close();
  service.say(microseconds_now());
  if (trace) {
    if (const auto done = trace->finish(); !done) return refuse(options.output, done.error());
    TACTUS_CHECK(output->keep());
  }
  if (options.common.json) fmt::print("{}\n", text_of_json(report));
  else if (!options.common.quiet) print_text(options, *sessions, service, ticker, seconds);
  return {};
}

}  // namespace

void setup_serve(Command& app, Action& action) {
  auto options = std::make_shared<ServeOptions>();
  Command& command = app.add_command("serve", "Simulate a scene in real time for clients that join");
  command.add_option("SCENE", options->scene, "As in `tactus sim`")->type_name("")->required();
  command.add_option("--listen", options->listen, "Port for clients, 0: any free one")->show_default()->type_name("PORT");
  command.add_option("-o,--output", options->output, "Also write a trace (MCAP)")->type_name("FILE");
  command.add_option("--clients", options->clients, "Most clients at a time")
      ->check(whole_number(1, 1024))
      ->show_default()
      ->type_name("N");
  add_bit_rate(command, "--rate", options->rate, "Most that each client is sent, headers included [no limit]");
  add_quantity(command, "--duration", options->duration, Dimension::time, "End after this long [until Ctrl-C]");
  add_encoder_options(command, options->triggers, options->meshes);
  add_output_options(command, options->common);
  command.footer(
      "A participant plays the first user of the scene whom nobody plays; others and observers look on.\n\n"
      "Example, in three terminals:\n"
      "  tactus serve rotate-push-lift -p 4%\n"
      "  tactus link --listen 4001 --to 7447 --up delay=20ms,loss=1% --down delay=20ms,loss=1%\n"
      "  tactus join 4001 --scene rotate-push-lift");
  on_chosen<ServeOptions>(command, action, options, run);
}

}  // namespace tactus::cli
