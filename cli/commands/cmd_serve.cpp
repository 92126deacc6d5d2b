// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <optional>
#include <utility>

#include <tactus/device/real_time.h>
#include <tactus/net/udp.h>
#include <tactus/session/session_server.h>
#include <tactus/sim/server.h>
#include <tactus/thesis/if_built.h>
#include <tactus/trace/trace_file.h>
#include "cli/live/event_log.h"
#include "cli/live/live_report.h"
#include "cli/live/monitor.h"
#include "cli/live/notify.h"
#include "cli/live/serve_check.h"
#include "cli/live/service.h"
#include "cli/live/ticker.h"
#include "cli/live/wire.h"
#include "cli/observe/metrics_server.h"
#include "cli/observe/observation.h"
#include "cli/options/option_needs.h"
#include "cli/options/options_codec.h"
#include "cli/options/options_limits.h"
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
  std::optional<std::uint32_t> observe, metrics;  // ports
  double duration = 0;                            // [s], 0: until interrupted
  double rate = 0;                                // [bit/s] to each client
  std::uint64_t seed = 1;
  std::string log = "text";
  bool check = false;
  DecodeLimits limits{.thesis = thesis_if_built()};
  TriggerArguments triggers;
  MeshArguments meshes;
  CommonOptions common;
};

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
             const Ticker& ticker, double seconds, const ServerWire& wire) {
  const std::optional<SealUse> seal = wire.seal();
  Json out{{"schema", "tactus.serve/1"}, {"scene", options.scene}, {"listen", options.listen}, {"seconds", seconds}};
  out["tick_timing"] = tick_timing_value(tick_timing_of(ticker));
  out["datagrams_refused"] = service.refused();
  out["datagrams_limited"] = wire.limited();
  if (seal) out["seal"] = seal_value(seal->counters);
  out["clients"] = Json::array();
  for (std::uint16_t i = 0; i < sessions.clients(); ++i) {
    const ClientStatus status = sessions.status(i);
    if (status.traffic.datagrams_sent == 0) continue;
    Json client{{"client", i},
                {"state", name_of(status.state)},
                {"role", status.role == Role::observer ? "observer" : "participant"},
                {"loss", status.loss},
                {"bound_scale", bound_scaling_value(status.bound_scaling)},
                {"traffic", traffic_value(status.traffic, seconds, seal)}};
    if (const std::string user = service.user_of(i); !user.empty()) client["key"] = user;
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
                                            .codec = sim::ServerCodec{.sender = options.meshes.sender(options.triggers),
                                                                      .coding = options.meshes.coding(options.triggers),
                                                                      .sessions = true,
                                                                      .limits = options.limits}});
  if (!world) return tl::unexpected(allow_more(refuse(options.scene, world.error()).value(), world.error()));
  if (const auto fits = check_declaration(*(*world)->stream_scene(), options.limits); !fits)
    return tl::unexpected(allow_more(refuse(options.scene, fits.error()).value(), fits.error()));
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
  for (TraceUser& user : out.users) user.forces = RecordedForces::server;  // clients send none
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

/// Reports what this machine did not manage: ticks in time, datagrams that waited.
class Strain {
 public:
  explicit Strain(const EventLog& log) : log_(log) {}
  /// Every ten seconds.
  void look(std::uint64_t now, const Ticker& ticker, const net::UdpSocket& socket) {
    constexpr std::uint64_t kEvery = 10'000'000;
    if (now < looked_at_ + kEvery) return;
    const std::uint64_t ticks = ticker.ticks() + ticker.missed() - ticks_, missed = ticker.missed() - missed_;
    const std::uint64_t dropped = socket.dropped() - dropped_;
    if (looked_at_ > 0 && 100 * missed > ticks) log_missed(now, missed, ticks);
    if (looked_at_ > 0 && dropped > 0) log_dropped(now, dropped);
    looked_at_ = now;
    ticks_ += ticks;
    missed_ += missed;
    dropped_ += dropped;
  }

 private:
  /// If more than one in a hundred were.
  void log_missed(std::uint64_t now, std::uint64_t missed, std::uint64_t ticks) const {
    log_.write(now, "missed_ticks",
               fmt::format("missed {} of {} ticks in {:.0f} s: this machine has no time for them. Serve fewer clients, end other "
                           "programs, or allow real-time priority (`tactus serve --check` says how)",
                           missed, ticks, 1e-6 * static_cast<double>(now - looked_at_)),
               {{"missed", missed}, {"of", ticks}});
  }
  void log_dropped(std::uint64_t now, std::uint64_t dropped) const {
    log_.write(now, "dropped",
               fmt::format("the system dropped {} that waited for this program: more came than there was room for "
                           "(`tactus serve --check` says how much there is)",
                           counted(dropped, "datagram")),
               {{"datagrams", dropped}});
  }

  const EventLog& log_;
  std::uint64_t looked_at_ = 0, ticks_ = 0, missed_ = 0, dropped_ = 0;
};

/// What a run is watched by.
struct Watch {
  std::unique_ptr<Monitor> monitor;  // null: nobody asked for figures
  std::unique_ptr<MetricsServer> metrics;
  ServiceManager manager;

  /// A tick has ended that began at `begun`.
  void tick(std::uint64_t begun, const Ticker& ticker, Service& service, const net::UdpSocket& socket) {
    const std::uint64_t now = microseconds_now();
    manager.alive(now);
    if (!monitor) return;
    ServerFigures* const figures = monitor->tick(now, {.lateness = begun - std::min(begun, ticker.due()),
                                                       .work = now - begun,
                                                       .ticks = ticker.ticks(),
                                                       .missed = ticker.missed()});
    if (figures == nullptr) return;
    service.describe(*figures);
    figures->datagrams_dropped = socket.dropped();
    monitor->show();
  }
};

/// [bytes] Around a datagram.
std::uint64_t header_bytes(const net::Address& listen) {
  constexpr std::uint64_t kLonger = 20;  // the header of IPv6 than that of IPv4
  return kUdpHeader + (listen.is_ipv6() ? kLonger : 0);
}

/// [bytes] For what comes from all clients in half a second.
std::size_t wanted_room(const ServeOptions& options) {
  constexpr std::size_t kEach = 1 << 16, kLeast = 1 << 20, kMost = 1 << 24;
  return std::clamp(options.clients * kEach, kLeast, kMost);
}

/// in   facts  those of the wire
Outcome open_watch(const ServeOptions& options, const sim::Server& world, ServerFacts facts, Watch& watch) {
  if (!options.metrics) return {};
  facts.scene = world.scene().name;
  facts.objects = world.stream_scene()->objects.size();
  facts.meshes = world.stream_scene()->deformables.size();
  watch.monitor = std::make_unique<Monitor>(options.clients);
  TACTUS_TRY(watch.metrics,
             MetricsServer::create(static_cast<std::uint16_t>(*options.metrics), *watch.monitor, std::move(facts)));
  return {};
}

tl::expected<std::unique_ptr<ServerWire>, Failure> make_wire(const ServeOptions& options, net::UdpSocket& socket) {
  if (options.key.empty()) return plain_wire_of_server(socket, options.clients);
  return sealed_wire_of_server(socket, options.clients, options.key);
}

/// Until it is to end.
Outcome serve(const ServeOptions& options, const sim::Server& world, SessionServer& sessions, Service& service,
              const EventLog& log, Ticker& ticker, const net::UdpSocket& socket, std::optional<TraceWriter>& trace,
              Watch& watch) {
  const StopOnSignal stop;
  std::optional<ReloadOnHangUp> hang_up;
  if (!options.key.empty()) hang_up.emplace();
  Meter meter(options.common.progress());
  Strain strain(log);
  const auto ticks = options.duration > 0 ? std::llround(options.duration * sim::kTickRate) : INT64_MAX;
  while (StopOnSignal::caught() == 0 && world.frame().tick < ticks) {
    const auto woken = ticker.wait(socket.handle(), sessions.next_timeout().value_or(UINT64_MAX));
    const std::uint64_t begun = microseconds_now();
    service.hear();
    if (hang_up && hang_up->caught()) service.reload();
    const std::uint64_t now = microseconds_now();
    if (woken == Ticker::Woken::by_tick) {
      TACTUS_CHECK(service.step(now, ticker.tick(), trace, options.output));
      strain.look(now, ticker, socket);
    }
    service.send(now);
    if (woken == Ticker::Woken::by_tick) watch.tick(begun, ticker, service, socket);
    if (meter.is_due(now)) meter.draw(now, meter_text(world, sessions, service, ticker));
  }
  return {};
}

/// in   plan  what the system gives
Outcome check(const ServeOptions& options, const SessionServerOptions& settings, ServePlan plan, sim::Server& world) {
  if (!options.output.empty())
    TACTUS_CHECK(OutputFile::check_free(options.output, options.common.existing(), {options.scene, options.key}));
  plan.scene = options.scene;
  plan.listen = options.listen;
  plan.settings = settings;
  plan.limits = options.limits;
  plan.is_sealed = !options.key.empty();
  TACTUS_TRY(const Value report, check_plan(plan, world));
  print(report, "serve_check", options.common);
  return {};
}

Outcome run_serve(const ServeOptions& typed) {
  ServeOptions options = typed;
  TACTUS_TRY(const net::Address listen, session_address("--listen", options.listen, options.key));
  TACTUS_TRY(const auto world, make_world(options));
  auto socket = net::UdpSocket::bind(listen);
  if (!socket) return refuse_port("--listen " + options.listen, listen.port(), errno, "udp");
  options.listen = socket->own().text();
  const std::size_t room = socket->ask_room(wanted_room(options));
  TACTUS_TRY(const auto wire, make_wire(options, *socket));
  const std::size_t seal = wire->seal() ? wire->seal()->overhead : 0;
  const SessionServerOptions settings{.sender = options.meshes.sender(options.triggers),
                                      .clients = static_cast<std::uint16_t>(options.clients),
                                      .rate = static_cast<std::uint64_t>(options.rate),
                                      .headers = static_cast<std::uint32_t>(header_bytes(listen) + seal),
                                      .world = sim::fingerprint(world->scene()),
                                      .addresses_are_validated = wire->seal().has_value(),
                                      .works_elsewhere = !options.check};
  TACTUS_TRY(const auto observation, make_observation(options, *world));
  Watch watch;
  TACTUS_CHECK(open_watch(options, *world, {.headers = header_bytes(listen), .seal = seal}, watch));
  if (options.check) return check(options, settings, {.room = room, .wanted_room = wanted_room(options)}, *world);
  TACTUS_TRY(auto recording, make_recording(options, *world));
  const device::RealTime real_time;
  const std::uint64_t origin = microseconds_now();
  auto sessions = SessionServer::create(world->stream_scene(), settings, system_entropy(), origin);
  if (!sessions) return refuse(options.scene, sessions.error());
  if (!options.common.quiet) fmt::print(stderr, "serving {} at {}\n", options.scene, options.listen);
  if (!options.common.quiet && observation) fmt::print(stderr, "observe it at {}\n", observation->address());
  if (!options.common.quiet && watch.metrics) fmt::print(stderr, "figures at {}\n", watch.metrics->address());

  const auto form = options.log == "json"  ? EventLog::Form::json
                    : options.common.quiet ? EventLog::Form::none
                                           : EventLog::Form::text;
  const EventLog log(form, origin);
  Service service(*world, *sessions, *wire, observation.get(), log);
  Ticker ticker(1'000'000 / sim::kTickRate, origin);
  watch.manager.ready(fmt::format("serving {} at {}", world->scene().name, options.listen));
  const Outcome worked = serve(options, *world, *sessions, service, log, ticker, *socket, recording.trace, watch);
  watch.manager.stopping();
  const double seconds = static_cast<double>(ticker.tick() + 1) / sim::kTickRate;
  Json report = to_json(options, *sessions, *world->stream_scene(), service, ticker, seconds, *wire);
  if (StopOnSignal::caught() != SIGUSR1) service.close(microseconds_now());  // else clients wait for the server that follows
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
                  "Also write a trace (MCAP); its forces are the server's, as clients do not send the rendered ones")
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
  command
      .add_option(
          "--metrics", [options](const std::string& port) { options->metrics = static_cast<std::uint32_t>(std::stoul(port)); },
          "Also serve figures at http://127.0.0.1:PORT/metrics (Prometheus) and health at /health; 0: any free one")
      ->check(whole_number(0, 65535))
      ->type_name("PORT");
  command.add_flag("--check", options->check,
                   "Only look whether this would do: scene, keys, port; print sizes and what this system permits");
  add_limits(command, options->limits, "Largest scene that is served [see below]; may be repeated");
  add_bit_rate(command, "--rate", options->rate, "Most that each client is sent, headers included [no limit]");
  add_quantity(command, "--duration", options->duration, Dimension::time, "End after this long [until Ctrl-C]");
  command
      .add_option("--log", options->log,
                  "Each event (who joins, plays what, is silent, is gone) as a line on standard error: text or json")
      ->one_of({"text", "json"})
      ->show_default()
      ->type_name("FORM");
  add_encoder_options(command, options->triggers, options->meshes);
  add_output_options(command, options->common);
  command.footer(
      std::string(limits_help()) +
      "\n\nA participant plays the user of the scene that it asks for, unless another one does: then it looks on, as observers "
      "do.\n"
      "The hand of a participant that is not heard lifts off within 1 s. Its seat is kept for 10 s, and for its token.\n"
      "Ctrl-C and SIGTERM take leave of the clients, which end. After SIGUSR1 they wait for the server that follows, and join "
      "it.\n\n"
      "A browser that observes sees a stream of its own under the same bounds, beside the truth, made by a thread of its own.\n"
      "From another machine: ssh -L 8080:127.0.0.1:8080 SERVER, then the same address.\n"
      "Example, in three terminals, and http://127.0.0.1:8080/ in a browser:\n"
      "  tactus serve rotate-push-lift -p 4% --observe 8080\n"
      "  tactus link --listen 4001 --to 7447 --link delay=20ms,loss=1%\n"
      "  tactus join 4001 --scene rotate-push-lift\n"
      "For other machines, sealed (29 bytes per datagram more), with a key for each user:\n"
      "  tactus key lab.keys --add anna                  # makes lab.keys, and anna.key for her: scp -p anna.key ...\n"
      "  tactus key lab.keys --add ben --role observe    # he may only look on\n"
      "  tactus serve rotate-push-lift -p 4% --listen 192.0.2.1:7447 --key lab.keys\n"
      "lab.keys may change while it runs: a user that is removed from it has to go within 2 s, at once after kill -HUP.\n"
      "A file that is broken changes nothing but a line of the log. What one sender sends beyond 5000 datagrams per second is "
      "dropped.");
  on_chosen<ServeOptions>(command, action, options, run_serve);
}

}  // namespace tactus::cli
