// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include <tactus/device/real_time.h>
#include <tactus/net/udp.h>
#include <tactus/session/session_server.h>
#include <tactus/sim/server.h>
#include <tactus/trace/trace_file.h>
#include "cli/live/live_report.h"
#include "cli/live/ticker.h"
#include "cli/live/wire.h"
#include "cli/observe/observation.h"
#include "cli/options/option_needs.h"
#include "cli/options/options_codec.h"
#include "cli/options/options_link.h"
#include "cli/options/units.h"
#include "cli/output.h"
#include "cli/report/json.h"
#include "cli/report/messages.h"
#include "cli/report/report.h"
#include "cli/report/table.h"

namespace tactus::cli {
namespace {

struct ServeOptions {
  std::string scene, listen = "7447", key, output;
  std::uint32_t clients = 8;
  std::optional<std::uint32_t> observe;  // port
  double duration = 0;                   // [s], 0: until interrupted
  double rate = 0;                       // [bit/s] to each client
  std::uint64_t seed = 1;
  TriggerArguments triggers;
  MeshArguments meshes;
  CommonOptions common;
};

/// Serves a simulated world in real time.
class Service {
 public:
  /// in   observation  may be null: nobody observes
  Service(sim::Server& world, SessionServer& sessions, ServerWire& wire, Observation* observation)
      : world_(world), sessions_(sessions), wire_(wire), observation_(observation), players_(world.scene().users.size()) {
    for (const sim::SceneUser& user : world.scene().users) devices_.push_back({.position = user.start});
  }

  /// Take what has come, and what time has brought.
  void hear();
  /// The world comes to this tick.
  Outcome step(std::uint64_t now, std::int64_t tick, std::optional<TraceWriter>& trace, const std::string& output);
  void say(std::uint64_t now);
  /// Take leave of all.
  void close(std::uint64_t now);
  std::size_t live() const;
  std::uint64_t refused() const { return refused_; }

 private:
  Outcome make_tick(std::uint64_t now, std::optional<TraceWriter>& trace, const std::string& output);
  void seat(std::uint64_t now);
  std::uint64_t silence_of(std::uint16_t client, std::uint64_t now) const;
  void end(std::uint64_t peer);
  bool has_session(std::uint64_t peer) const { return sessions_.has_peer(peer); }

  sim::Server& world_;
  SessionServer& sessions_;
  ServerWire& wire_;
  Observation* observation_;
  std::vector<std::optional<std::uint16_t>> players_;  // the client that plays each user of the scene
  std::vector<DeviceSample> devices_;
  std::int64_t next_ = 0, left_out_ = 0;  // [ticks] the one to be made, those that the world was not simulated
  std::uint64_t refused_ = 0;
};

/// Each datagram has the time at which it was taken: what came while another was handled did not come before it.
void Service::hear() {
  constexpr int kMost = 1000;  // at a time: a tick must not wait for a flood to end
  for (int i = 0; i < kMost; ++i) {
    const auto heard = wire_.receive(microseconds_now());
    if (!heard) break;
    const std::uint64_t now = microseconds_now();
    if (!sessions_.handle_datagram(now, heard->peer, heard->bytes)) ++refused_;
    wire_.settle([this](std::uint64_t peer) { return has_session(peer); });
    say(now);
  }
  while (const auto peer = wire_.poll_closed()) end(*peer);
  sessions_.handle_timeout(microseconds_now());
}

/// The peer is gone: its client has left, even if no leave was heard.
void Service::end(std::uint64_t peer) {
  for (std::uint16_t i = 0; i < sessions_.clients(); ++i)
    if (sessions_.status(i).peer == peer) sessions_.close(i, LeaveReason::bye);
}

void Service::close(std::uint64_t now) {
  sessions_.close();
  say(now);
  wire_.close();
}

std::uint64_t Service::silence_of(std::uint16_t client, std::uint64_t now) const {
  const std::uint64_t heard = sessions_.status(client).heard;
  return now > heard ? now - heard : 0;
}

/// A participant plays the first user of the scene whom nobody plays, as long as it is heard. A hand that is not heard lifts off within a
/// second; that of one who left, or was silent for too long, is where it was before anybody came.
void Service::seat(std::uint64_t now) {
  constexpr std::uint64_t kFresh = 300'000, kLifted = 1'000'000, kEmpty = 10'000'000;  // [us] of silence
  for (std::size_t i = 0; i < players_.size(); ++i) {
    if (!players_[i]) continue;
    const std::uint64_t silence = silence_of(*players_[i], now);
    if (sessions_.status(*players_[i]).state == SessionState::closed || silence > kEmpty) {
      players_[i].reset();
      devices_[i] = {.position = world_.scene().users[i].start};
      world_.lift(i, 1);
      continue;
    }
    world_.lift(i, static_cast<double>(kLifted - std::clamp(silence, kFresh, kLifted)) / (kLifted - kFresh));
  }
  for (std::uint16_t client = 0; client < sessions_.clients(); ++client) {
    const ClientStatus status = sessions_.status(client);
    const bool plays = status.state == SessionState::live && status.role == Role::participant;
    if (!plays || silence_of(client, now) > kFresh || std::ranges::find(players_, client) != players_.end()) continue;
    const auto free = std::ranges::find_if(players_, [](const auto& player) { return !player; });
    if (free != players_.end()) *free = client;
  }
}

void Service::say(std::uint64_t now) {
  while (const auto datagram = sessions_.poll_datagram(now)) wire_.send(datagram->peer, datagram->bytes);
  while (sessions_.poll_event()) {
  }
}

/// Ticks that were missed are made at once, if they are few; of many the world knows nothing, but time has passed.
Outcome Service::step(std::uint64_t now, std::int64_t tick, std::optional<TraceWriter>& trace, const std::string& output) {
  constexpr std::int64_t kAtOnce = 10;
  wire_.tick(now, [this](std::uint64_t peer) { return has_session(peer); });
  seat(now);
  if (tick - next_ > kAtOnce) left_out_ += tick - std::exchange(next_, tick);
  for (; next_ <= tick; ++next_) TACTUS_CHECK(make_tick(now, trace, output));
  return {};
}

Outcome Service::make_tick(std::uint64_t now, std::optional<TraceWriter>& trace, const std::string& output) {
  for (std::size_t i = 0; i < players_.size(); ++i)
    if (players_[i]) devices_[i] = sessions_.device(*players_[i], now).value_or(devices_[i]);
  world_.observe();
  TraceFrame& frame = world_.frame();
  frame.tick += left_out_;
  world_.touch(devices_);
  const Truth truth = world_.truth();
  if (const auto sent = sessions_.submit(now, frame.tick, truth); !sent)
    return refuse("session", place_of_tick(frame.tick), sent.error());
  say(now);
  if (observation_ != nullptr) observation_->offer(frame, truth.loads);
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
  if (scene.loads) add(load_substream(scene));
  return out;
}

Json observers_json(const ObservationReport& observed) {
  Json out{{"address", observed.address},
           {"came", observed.observers},
           {"most_at_a_time", observed.most_at_a_time},
           {"too_slow", observed.too_slow},
           {"requests_refused", observed.requests_refused},
           {"ticks_left_out", observed.ticks_left_out}};
  if (!observed.failure.empty()) out["failure"] = observed.failure;
  return out;
}

Json to_json(const ServeOptions& options, const SessionServer& sessions, const tactus::Scene& scene, const Service& service,
             const Ticker& ticker, double seconds, const std::optional<SealUse>& seal) {
  Json out{{"schema", "tactus.serve/1"}, {"scene", options.scene}, {"listen", options.listen}, {"seconds", seconds}};
  out["pace"] = pace_value(pace_of(ticker));
  out["datagrams_refused"] = service.refused();
  if (seal) out["seal"] = seal_value(seal->counters);
  out["clients"] = Json::array();
  for (std::uint16_t i = 0; i < sessions.clients(); ++i) {
    const ClientStatus status = sessions.status(i);
    if (status.traffic.datagrams_sent == 0) continue;
    Json client{{"client", i},
                {"state", name_of(status.state)},
                {"role", status.role == Role::observer ? "observer" : "participant"},
                {"loss", status.loss},
                {"bounds_widened", widening_value(status.widened)},
                {"traffic", traffic_value(status.traffic, seconds, seal)}};
    if (status.round_trip) client["round_trip"] = round_trip_value(*status.round_trip);
    if (status.state == SessionState::live) client["state_hashes"] = hashes_json(sessions, scene, i);
    out["clients"].push_back(std::move(client));
  }
  return out;
}

tl::expected<std::unique_ptr<sim::Server>, Failure> make_world(const ServeOptions& options) {
  const auto path = sim::find_scene(options.scene);
  if (!path) return refuse(path.error());
  const auto scene = sim::load_scene(*path);
  if (!scene) return refuse(scene.error());
  auto world = sim::Server::create(*scene, {.seed = options.seed,
                                            .codec = sim::ServerCodec{options.meshes.sender(options.triggers),
                                                                      options.meshes.coding(options.triggers), true}});
  if (!world) return refuse(options.scene, world.error());
  return std::move(*world);
}

/// What a run writes, if it was asked to.
struct Recording {
  std::optional<OutputFile> output;
  std::optional<TraceWriter> trace;

  Outcome finish(const std::string& name) {
    if (!trace) return {};
    if (const auto done = trace->finish(); !done) return refuse(name, done.error());
    return output->keep();
  }
};

TraceInfo info_of(const sim::Server& world) {
  TraceInfo out = world.info();
  out.source = "serve " + world.scene().name;
  for (TraceUser& user : out.users) user.forces = KnownForces::server;  // clients tell none
  return out;
}

tl::expected<Recording, Failure> make_recording(const ServeOptions& options, const sim::Server& world) {
  Recording out;
  if (options.output.empty()) return out;
  TACTUS_TRY(auto file, OutputFile::create_growing(options.output, options.common.existing(), {options.scene, options.key}));
  out.output.emplace(std::move(file));
  auto writer = TraceWriter::create(out.output->working_path(), info_of(world));
  if (!writer) return refuse(options.output, writer.error());
  out.trace.emplace(std::move(*writer));
  return out;
}

tl::expected<std::unique_ptr<Observation>, Failure> make_observation(const ServeOptions& options, const sim::Server& world) {
  if (!options.observe) return nullptr;
  return Observation::create({.port = static_cast<std::uint16_t>(*options.observe),
                              .scene = options.scene,
                              .name = world.scene().name,
                              .info = info_of(world),
                              .declared = world.stream_scene(),
                              .sender = options.meshes.sender(options.triggers),
                              .like = &world.frame()});
}

tl::expected<std::unique_ptr<ServerWire>, Failure> make_wire(const ServeOptions& options, net::UdpSocket& socket) {
  if (options.key.empty()) return plain_wire_of_server(socket, options.clients);
  return sealed_wire_of_server(socket, options.clients, options.key);
}

/// Tells of ticks that this machine did not make in time.
class MissedTicks {
 public:
  explicit MissedTicks(bool quiet) : quiet_(quiet) {}
  /// Every ten seconds in which more than one in a hundred were.
  void look(std::uint64_t now, const Ticker& ticker) {
    constexpr std::uint64_t kEvery = 10'000'000;
    if (now < looked_at_ + kEvery) return;
    const std::uint64_t ticks = ticker.ticks() + ticker.missed() - ticks_, missed = ticker.missed() - missed_;
    if (looked_at_ > 0 && 100 * missed > ticks && !quiet_)
      fmt::print(
          stderr,
          "missed {} of {} ticks in {:.0f} s: this machine has no time for them. Serve fewer clients, or end other programs\n",
          missed, ticks, 1e-6 * static_cast<double>(now - looked_at_));
    looked_at_ = now;
    ticks_ += ticks;
    missed_ += missed;
  }

 private:
  bool quiet_;
  std::uint64_t looked_at_ = 0, ticks_ = 0, missed_ = 0;
};

/// Until it is to end.
Outcome serve(const ServeOptions& options, const sim::Server& world, SessionServer& sessions, Service& service, Ticker& ticker,
              const net::UdpSocket& socket, std::optional<TraceWriter>& trace) {
  const StopOnSignal stop;
  Meter meter(options.common.progress());
  MissedTicks missed(options.common.quiet);
  const auto ticks = options.duration > 0 ? std::llround(options.duration * sim::kTickRate) : INT64_MAX;
  while (StopOnSignal::caught() == 0 && world.frame().tick < ticks) {
    const auto woken = ticker.wait(socket.handle(), sessions.next_timeout().value_or(UINT64_MAX));
    service.hear();
    const std::uint64_t now = microseconds_now();
    if (woken == Ticker::Woken::by_tick) {
      TACTUS_CHECK(service.step(now, ticker.tick(), trace, options.output));
      missed.look(now, ticker);
    }
    service.say(now);
    if (meter.is_due(now)) meter.draw(now, meter_text(world, sessions, service, ticker));
  }
  return {};
}

Outcome run(const ServeOptions& typed) {
  ServeOptions options = typed;
  TACTUS_TRY(const net::Address listen, session_address("--listen", options.listen, options.key));
  TACTUS_TRY(const auto world, make_world(options));
  auto socket = net::UdpSocket::bind(listen);
  if (!socket) return refuse(options.listen, socket.error());
  options.listen = socket->own().text();
  TACTUS_TRY(const auto wire, make_wire(options, *socket));
  const std::size_t seal = wire->seal() ? wire->seal()->overhead : 0;
  const SessionServerOptions settings{.sender = options.meshes.sender(options.triggers),
                                      .clients = static_cast<std::uint16_t>(options.clients),
                                      .rate = static_cast<std::uint64_t>(options.rate),
                                      .headers = static_cast<std::uint32_t>(kUdpHeader + seal)};
  TACTUS_TRY(auto recording, make_recording(options, *world));
  TACTUS_TRY(const auto observation, make_observation(options, *world));
  const device::RealTime real_time;
  const std::uint64_t origin = microseconds_now();
  auto sessions = SessionServer::create(world->stream_scene(), settings, system_entropy(), origin);
  if (!sessions) return refuse(options.scene, sessions.error());
  if (!options.common.quiet) fmt::print(stderr, "serving {} at {}\n", options.scene, options.listen);
  if (!options.common.quiet && observation) fmt::print(stderr, "observe it at {}\n", observation->address());

  Service service(*world, *sessions, *wire, observation.get());
  Ticker ticker(1'000'000 / sim::kTickRate, origin);
  const Outcome worked = serve(options, *world, *sessions, service, ticker, *socket, recording.trace);
  const double seconds = static_cast<double>(ticker.tick() + 1) / sim::kTickRate;
  Json report = to_json(options, *sessions, *world->stream_scene(), service, ticker, seconds, wire->seal());
  service.close(microseconds_now());
  if (observation) report["observers"] = observers_json(observation->finish());
  const Outcome finished = recording.finish(options.output);
  TACTUS_CHECK(worked);
  TACTUS_CHECK(finished);
  print(report, "serve", options.common);
  return {};
}

}  // namespace

void setup_serve(Command& app, Action& action) {
  auto options = std::make_shared<ServeOptions>();
  Command& command = app.add_command("serve", "Simulate a scene in real time for clients that join");
  command.add_option("SCENE", options->scene, "As in `tactus sim`")->type_name("")->required();
  command.add_option("--listen", options->listen, "Port for clients, 0: any free one; with --key ADDRESS:PORT of any network")
      ->show_default()
      ->type_name("PORT");
  add_key(command, options->key);
  command
      .add_option("-o,--output", options->output,
                  "Also write a trace (MCAP); its forces are the server's, as clients do not tell what is felt")
      ->type_name("FILE");
  command.add_option("--clients", options->clients, "Most clients at a time")
      ->check(whole_number(1, 1024))
      ->show_default()
      ->type_name("N");
  command
      .add_option(
          "--observe", [options](const std::string& port) { options->observe = static_cast<std::uint32_t>(std::stoul(port)); },
          "Also show the session in browsers on this machine, at http://127.0.0.1:PORT/; 0: any free one")
      ->check(whole_number(0, 65535))
      ->type_name("PORT");
  add_bit_rate(command, "--rate", options->rate, "Most that each client is sent, headers included [no limit]");
  add_quantity(command, "--duration", options->duration, Dimension::time, "End after this long [until Ctrl-C]");
  add_encoder_options(command, options->triggers, options->meshes);
  add_output_options(command, options->common);
  command.footer(
      "A participant plays the first user of the scene whom nobody plays; others and observers look on.\n\n"
      "A browser that observes sees a stream of its own under the same bounds, beside the truth, made by a thread of its own.\n"
      "From another machine: ssh -L 8080:127.0.0.1:8080 SERVER, then the same address.\n"
      "Example, in three terminals, and http://127.0.0.1:8080/ in a browser:\n"
      "  tactus serve rotate-push-lift -p 4% --observe 8080\n"
      "  tactus link --listen 4001 --to 7447 --link delay=20ms,loss=1%\n"
      "  tactus join 4001 --scene rotate-push-lift\n"
      "For other machines, sealed (29 bytes per datagram more):\n"
      "  tactus key -o lab.key\n"
      "  tactus serve rotate-push-lift -p 4% --listen 192.0.2.1:7447 --key lab.key");
  on_chosen<ServeOptions>(command, action, options, run);
}

}  // namespace tactus::cli
