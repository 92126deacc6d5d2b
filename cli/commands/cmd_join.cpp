// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <optional>

#include <tactus/base/shown.h>
#include <tactus/device/real_time.h>
#include <tactus/device/servo.h>
#include <tactus/net/udp.h>
#include <tactus/session/session_client.h>
#include <tactus/sim/client.h>
#include <tactus/trace/trace_recorder.h>
#include <tactus/trace/trace_scene.h>
#include "cli/commands/input.h"
#include "cli/live/device_choice.h"
#include "cli/live/device_loop.h"
#include "cli/live/live_report.h"
#include "cli/live/ticker.h"
#include "cli/live/token_file.h"
#include "cli/live/wire.h"
#include "cli/options/options_codec.h"
#include "cli/options/options_limits.h"
#include "cli/options/options_link.h"
#include "cli/options/units.h"
#include "cli/output.h"
#include "cli/report/json.h"
#include "cli/report/messages.h"
#include "cli/report/table.h"

namespace tactus::cli {
namespace {

struct JoinOptions {
  std::string server, scene, user, key, output;
  DeviceArguments device;
  std::string playout = "adaptive";
  double duration = 0;         // [s], 0: until interrupted or the end of the recording
  double device_error = 1e-4;  // [m]
  double weber_fraction = 0.04;
  DecodeLimits limits;
  CommonOptions common;

  bool participates() const { return !scene.empty(); }
};

/// The hand, the device and what it feels: only of a participant.
struct Body {
  std::unique_ptr<sim::Server> shapes;  // of the scene; nothing moves here
  std::unique_ptr<sim::Client> client;
  std::size_t user = 0;
  ChosenDevice chosen;
  std::unique_ptr<device::Servo> servo;  // from the first live tick on
  Vec3 origin{};                         // [m] of the device's frame in the world
  DeviceSample sample;                   // in the world
  device::ServoTick tick;
  device::Time begin = 0;  // of the first one
};

std::string names_of(const std::vector<sim::SceneUser>& users) {
  std::string out;
  for (const sim::SceneUser& user : users) out.append(out.empty() ? "" : ", ").append(user.name);
  return out;
}

tl::expected<Body, Failure> make_body(const JoinOptions& options) {
  const auto path = sim::find_scene(options.scene);
  if (!path) return refuse(path.error());
  const auto scene = sim::load_scene(*path);
  if (!scene) return refuse(scene.error());
  const auto user = std::ranges::find(scene->users, options.user, &sim::SceneUser::name);
  if (scene->users.empty())
    return refuse_arguments(fmt::format("--scene {}: it has no users, so nobody can touch it", options.scene),
                            "Leave out --scene to look on.");
  if (!options.user.empty() && user == scene->users.end())
    return refuse_arguments(fmt::format("--user {}: not a user of {}", options.user, options.scene),
                            fmt::format("Its users: {}.", names_of(scene->users)));
  Body body;
  auto shapes = sim::Server::create(
      *scene, {.seed = options.device.seed, .codec = sim::ServerCodec{.sender = {}, .sessions = true, .limits = options.limits}});
  if (!shapes) return tl::unexpected(allow_more(refuse(options.scene, shapes.error()).value(), shapes.error()));
  body.shapes = std::move(*shapes);
  body.user = options.user.empty() ? 0 : static_cast<std::size_t>(user - scene->users.begin());
  auto client = sim::Client::create_remote(*body.shapes, body.user, *scene);
  if (!client) return refuse(options.scene, client.error());
  body.client = std::move(*client);
  TACTUS_TRY(body.chosen, open_device(options.device, &*scene, body.user));
  TACTUS_CHECK(check_place(body.chosen.device->capabilities()));
  TACTUS_CHECK(check_force(options.device, body.chosen.device->capabilities()));
  if (!body.chosen.in_world) body.origin = scene->users[body.user].start;
  return body;
}

Pace pace_of(const device::ServoTimes& times) {
  const auto us = [&](double share) { return 1e-3 * static_cast<double>(times.lateness.quantile(share)); };
  return {times.ticks, times.missed, us(0.5), us(0.99)};
}

/// Takes part in a session in real time.
class Visit {
 public:
  Visit(const JoinOptions& options, SessionClient& session, net::UdpSocket& socket, const net::Address& server, ClientWire& wire)
      : options_(options),
        session_(session),
        socket_(socket),
        server_(server),
        wire_(wire),
        token_(options.server, options.user) {}

  Outcome hear();
  void say(std::uint64_t now);
  /// Take leave, and end what is written.
  Outcome close(std::uint64_t now);
  /// A tick of the device.   pre  live
  Outcome step(std::uint64_t now);
  /// Wait for the device's next tick.   pre  there is a body
  Outcome wait();
  Outcome render(std::uint64_t now);
  Outcome record(std::uint64_t now);
  std::string meter_text(std::uint64_t now, std::uint64_t missed) const;  ///< one line

  /// None: there is no device, or it takes no force.
  std::optional<GuardReport> guard() const {
    return body && body->servo ? guard_report(*body->servo, body->begin) : std::nullopt;
  }
  Pace pace(const Ticker& ticker) const { return body && body->servo ? pace_of(body->servo->times()) : pace_of(ticker); }

  std::optional<Body> body;
  std::optional<TraceRecorder> trace;
  std::optional<OutputFile> output;
  std::optional<LeaveReason> closed;
  bool was_live = false, at_end = false;
  std::uint64_t refused = 0;
  std::string beyond;        // names of the limits that the scene is beyond
  double largest_force = 0;  // [N]
  std::uint64_t lost = 0;    // ticks that are not in the trace

 private:
  Outcome arrive();
  void note(const Error& error) {
    ++refused;
    if (std::string names = limits_of(error); !names.empty()) beyond = std::move(names);
  }
  void look_at_network(std::uint64_t now);
  void look_at_arrival(std::uint64_t now);
  void look_at_seat(std::uint64_t now);
  void look_at_key();
  void tell(const std::string& text) const {
    if (!options_.common.quiet) fmt::print(stderr, "{}\n", text);
  }

  const JoinOptions& options_;
  SessionClient& session_;
  net::UdpSocket& socket_;
  net::Address server_;
  ClientWire& wire_;
  TokenFile token_;
  bool is_traced_ = true;  // until the server begins anew: its ticks do, too
  bool has_joined_ = false, is_unanswered_ = false, is_alone_ = false, is_unheard_ = false, is_doubted_ = false;
  std::uint64_t begun_at_ = microseconds_now(), receiving_since_ = 0, progress_told_at_ = 0;  // [us]
  std::uint64_t renewed_at_ = 0, live_at_ = 0, silent_since_ = 0;                             // [us]
  std::optional<std::uint8_t> seat_;                                                          // that was told
  TraceFrame frame_;
  std::int64_t shown_ = -1, written_ = -1;
};

/// The declaration is here.
Outcome Visit::arrive() {
  was_live = true;
  const tactus::Scene& scene = *session_.receiver()->scene();
  const SessionStatus status = session_.status();
  if (body && status.world != sim::fingerprint(body->shapes->scene()))
    return refuse_arguments("--scene " + options_.scene + ": the server simulates another scene, or another version of it",
                            "Give the scene of the server.");
  live_at_ = microseconds_now();
  seat_.reset();
  token_.keep(status.token);
  if (options_.output.empty()) return {};
  if (trace) {  // it holds the scene before
    is_traced_ = false;
    tell(fmt::format("the server has begun anew: {} ends here", shown_path(options_.output)));
    return {};
  }
  TraceInfo info = replica_info(scene, "join " + options_.server);
  info.shows_past = true;
  if (body) {
    DeviceSenses senses = body->chosen.device->capabilities().senses;
    senses.buttons = true;
    info.users.push_back(
        {.name = body->shapes->scene().users[body->user].name, .senses = senses, .has_servo = true, .forces = KnownForces::felt});
  }
  frame_ = replica_frame(scene);
  frame_.users.resize(info.users.size());
  TACTUS_TRY(auto file, OutputFile::create_growing(options_.output, options_.common.existing(),
                                                   {options_.scene, replayed_file(options_.device), options_.key}));
  output.emplace(std::move(file));
  auto recorder = TraceRecorder::create(output->working_path(), info, frame_);
  if (!recorder) return refuse(options_.output, recorder.error());
  trace.emplace(std::move(*recorder));
  return {};
}

/// Each datagram has the time at which it was taken: what came while another was handled did not come before it.
Outcome Visit::hear() {
  constexpr int kMost = 1000;  // at a time: a tick must not wait for a flood to end
  std::optional<Error> gone;
  for (int i = 0; i < kMost && !gone; ++i) {
    const auto heard = wire_.receive(microseconds_now());
    if (!heard) gone = heard.error();
    else if (!*heard) break;
    else if (const auto handled = session_.handle_datagram(microseconds_now(), **heard); !handled) note(handled.error());
  }
  const std::uint64_t now = microseconds_now();
  if (const auto there = wire_.handle_timeout(now); !there && !gone) gone = there.error();
  if (wire_.is_open() && !std::exchange(has_joined_, true)) session_.open(now, system_entropy(), token_.token());
  session_.handle_timeout(now);
  while (const auto event = session_.poll_event()) {
    if (event->kind == ClientEvent::Kind::closed) closed = event->reason;
    if (event->kind == ClientEvent::Kind::live) TACTUS_CHECK(arrive());
  }
  look_at_key();
  look_at_network(now);
  look_at_arrival(now);
  look_at_seat(now);
  if (!gone || closed) return {};
  if (gone->rule == std::string_view("R-SEA-1") && socket_.is_refused()) {
    closed = LeaveReason::silence;
    return {};
  }
  if (gone->rule != std::string_view("R-SEA-3")) return refuse(options_.server, *gone);
  closed = LeaveReason::bye;  // 70, section 11.4
  return {};
}

/// Without an answer the session joins again by itself. This end's address may be gone, or what the server knew of the seal.
void Visit::look_at_network(std::uint64_t now) {
  constexpr std::uint64_t kTold = 1'000'000, kRenewed = 1'500'000, kEvery = 5'000'000;  // [us]
  const std::uint64_t unanswered = session_.unanswered(now);
  if (unanswered > 0 && silent_since_ == 0) silent_since_ = now - unanswered;
  if (unanswered > kTold && !std::exchange(is_unanswered_, true)) tell("no answer from the server for 1 s: joining again");
  if (unanswered == 0) {
    if (std::exchange(is_unanswered_, false))
      tell(fmt::format("the server answers again, after {:.1f} s", 1e-6 * static_cast<double>(now - silent_since_)));
    silent_since_ = 0;
    return;
  }
  if (unanswered < kRenewed || now < renewed_at_ + kEvery) return;
  renewed_at_ = now;
  if (auto fresh = net::UdpSocket::connect(server_)) socket_ = std::move(*fresh);
  wire_.renew(now);
}

/// Anyone can say that the key is wrong: the handshake goes on as if nobody had.
void Visit::look_at_key() {
  if (is_doubted_ == wire_.is_doubted()) return;
  is_doubted_ = wire_.is_doubted();
  if (is_doubted_)
    tell(fmt::format(
        "{} answers, but does not accept the key \"{}\" of {}: it is another one, or its user was removed. Get a key file "
        "from whoever runs the server. Trying on",
        options_.server, wire_.seal()->user, shown_path(options_.key)));
}

/// Before the first tick: that nobody is there yet, and how far the scene is.
void Visit::look_at_arrival(std::uint64_t now) {
  constexpr std::uint64_t kWait = 1'000'000, kEvery = 3'000'000;  // [us]
  const SessionStatus status = session_.status();
  if (was_live || closed) return;
  if (socket_.is_refused() && now > begun_at_ + kWait && !std::exchange(is_alone_, true))
    tell(fmt::format("nobody listens at {}: waiting for a server", options_.server));
  const bool is_unheard = status.state == SessionState::joining && now > begun_at_ + kWait && !socket_.is_refused();
  if (is_unheard && options_.key.empty() && !std::exchange(is_unheard_, true))
    tell(fmt::format(
        "{} takes datagrams but does not answer: if its server has a key, this end needs it too (--key FILE). Trying on",
        options_.server));
  if (status.state != SessionState::receiving) return;
  if (receiving_since_ == 0) receiving_since_ = progress_told_at_ = now;
  if (now < progress_told_at_ + kEvery) return;
  progress_told_at_ = now;
  tell(progress_text(status.received, status.declaration, now - receiving_since_));
}

std::string Visit::meter_text(std::uint64_t now, std::uint64_t missed) const {
  const SessionStatus status = session_.status();
  if (status.state == SessionState::receiving)
    return progress_text(status.received, status.declaration, now - std::min(now, receiving_since_));
  if (status.state != SessionState::live) return name_of(status.state);
  const double trip = status.round_trip ? 1e-3 * static_cast<double>(status.round_trip->smoothed) : 0;
  return fmt::format("live  round trip {:.1f} ms  shows {:.1f} ms after the fastest packet  loss up {:.1f} %  missed {}", trip,
                     1e-3 * static_cast<double>(status.playout_delay), 100 * status.loss, missed);
}

/// What the hand of this end is.
void Visit::look_at_seat(std::uint64_t now) {
  constexpr std::uint64_t kSoon = 1'000'000;  // [us]: by then the server has told
  if (!body || closed || session_.status().state != SessionState::live) return;
  const std::uint8_t seat = session_.status().seat;
  if (seat_ == seat || (seat == 0 && now < live_at_ + kSoon)) return;
  seat_ = seat;
  const std::string& user = body->shapes->scene().users[body->user].name;
  if (seat == kOnlyLooksOn)
    return tell(fmt::format("looks on: the key \"{}\" may not touch. Whoever runs the server can change its role",
                            wire_.seal() ? wire_.seal()->user : ""));
  if (seat > 0) return tell("plays " + user);
  tell(fmt::format("{} is played by another: this end looks on until the seat is free. --user NAME plays another one", user));
}

void Visit::say(std::uint64_t now) {
  while (const auto datagram = session_.poll_datagram(now)) wire_.send(*datagram);
}

Outcome Visit::close(std::uint64_t now) {
  session_.close();
  say(now);
  wire_.close();
  token_.keep(0);
  if (!trace) return {};
  const auto done = trace->finish();
  const TraceRecorder::Status status = trace->status();
  if (!done) return refuse(options_.output, status.error ? place_of_tick(status.last_written) : "", done.error());
  lost = status.lost;
  return output->keep();
}

Outcome Visit::wait() {
  Body& own = *body;
  const std::string& name = own.chosen.device->capabilities().name;
  if (!own.servo) {
    auto servo = device::Servo::start(*own.chosen.device, {.rate = sim::kTickRate, .limits = options_.device.limits()});
    if (!servo) return refuse_device(name, servo.error());
    own.servo = std::move(*servo);
  }
  if (own.chosen.hand != nullptr) own.chosen.hand->watch(own.client->watched(own.user));
  const auto tick = own.servo->next();
  if (!tick) return refuse_device(name, tick.error());
  own.tick = *tick;
  if (own.servo->times().ticks == 1) own.begin = tick->due;
  own.sample = tick->reading.sample;
  own.sample.position = own.sample.position + own.origin;
  at_end = at_end || tick->reading.state == device::Reading::State::ended;
  return {};
}

Outcome Visit::render(std::uint64_t now) {
  Body& own = *body;
  Receiver& receiver = *session_.receiver();
  shown_ = session_.shown_tick(now);
  if (shown_ >= 0) own.client->show(receiver, shown_);
  else own.client->show_nothing();
  const auto delay =
      static_cast<std::uint32_t>((session_.round_trip_shown(now).value_or(0) * sim::kTickRate + 500'000) / 1'000'000);
  own.client->touch(own.user, own.sample, {session_.force_share(now), delay});
  if (const auto exerted = own.servo->exert(own.client->felt(own.user)); !exerted)
    return refuse_device(own.chosen.device->capabilities().name, exerted.error());
  largest_force = std::max(largest_force, norm(own.client->felt(own.user)));
  return {};
}

/// On the server's time base: the tick now at the server.
Outcome Visit::record(std::uint64_t now) {
  const SessionStatus status = session_.status();
  const Receiver* receiver = session_.receiver();
  if (!trace || !is_traced_ || at_end || shown_ < 0 || !status.clock_offset) return {};
  const std::int64_t at_server = static_cast<std::int64_t>(now) + *status.clock_offset - static_cast<std::int64_t>(status.start);
  const std::int64_t rate = receiver->scene()->tick_rate;
  const std::int64_t tick = at_server / 1'000'000 * rate + at_server % 1'000'000 * rate / 1'000'000;
  if (tick <= written_) return {};
  written_ = frame_.tick = tick;
  frame_.shown = shown_;
  take_shown(session_.receiver()->replica(), *receiver->scene(), shown_, frame_);
  if (body) {
    const device::ForceGuard* guard = body->servo->guard();
    UserSample& user = frame_.users[0];
    user.device = body->sample;
    user.force = guard != nullptr ? guard->written() : Vec3{};
    user.servo = {body->tick.lateness, body->tick.age, body->tick.missed, guard != nullptr ? guard->actions() : 0U};
  }
  trace->offer(frame_);
  const TraceRecorder::Status writing = trace->status();
  if (!writing.error) return {};
  errno = writing.cause;
  return refuse(options_.output, place_of_tick(tick), *writing.error);
}

Outcome Visit::step(std::uint64_t now) {
  if (body) {
    if (const auto sent = session_.submit(now, body->sample, body->client->contact(body->user)); !sent)
      return refuse("device", sent.error());
    TACTUS_CHECK(render(now));
  } else {
    shown_ = session_.shown_tick(now);
  }
  return record(now);
}

Json hashes_json(SessionClient& session) {
  Json out = Json::array();
  Receiver* receiver = session.receiver();
  if (receiver == nullptr) return out;
  if (!receiver->scene()->objects.empty()) out.push_back(fmt::format("{:016x}", receiver->state_hash(0)));
  for (std::size_t i = 0; i < receiver->scene()->deformables.size(); ++i)
    out.push_back(fmt::format("{:016x}", receiver->state_hash(i + 1)));
  if (receiver->scene()->loads) out.push_back(fmt::format("{:016x}", receiver->state_hash(load_substream(*receiver->scene()))));
  return out;
}

Value value_of(const JoinOptions& options, SessionClient& session, const Visit& visit, const Pace& pace, double seconds,
               const std::optional<SealUse>& seal) {
  const SessionStatus status = session.status();
  Json out{{"schema", "tactus.join/1"},
           {"server", options.server},
           {"role", options.participates() ? "participant" : "observer"},
           {"seconds", seconds},
           {"pace", pace_value(pace)},
           {"playout_delay_us", status.playout_delay},
           {"loss", status.loss},
           {"datagrams_refused", visit.refused},
           {"traffic", traffic_value(status.traffic, seconds, seal)},
           {"state_hashes", hashes_json(session)}};
  if (status.round_trip) out["round_trip"] = round_trip_value(*status.round_trip);
  if (status.clock_offset) out["clock_offset_us"] = *status.clock_offset;
  if (seal) out["key"] = seal->user;
  if (seal) out["seal"] = seal_value(seal->counters);
  if (options.participates()) out["largest_force_N"] = visit.largest_force;
  if (const auto guard = visit.guard()) out["guard"] = value_of(*guard);
  return out;
}

tl::expected<std::unique_ptr<ClientWire>, Failure> make_wire(const JoinOptions& options, net::UdpSocket& socket) {
  if (options.key.empty()) return plain_wire_of_client(socket);
  return sealed_wire_of_client(socket, options.key);
}

bool is_live(SessionClient& session) { return session.receiver() != nullptr && session.status().state == SessionState::live; }

/// Until it is to end.   out  ticks that were live
Outcome take_part(const JoinOptions& options, SessionClient& session, Visit& visit, ClientWire& wire, Ticker& ticker,
                  const net::UdpSocket& socket, std::uint64_t& live_ticks) {
  const StopOnSignal stop;
  Meter meter(options.common.progress());
  const double most = options.duration > 0 ? options.duration * sim::kTickRate : 1e18;
  while (StopOnSignal::caught() == 0 && !visit.closed && !visit.at_end && static_cast<double>(live_ticks) < most) {
    const bool by_device = visit.body && is_live(session);
    bool is_tick = by_device;
    if (by_device) {
      TACTUS_CHECK(visit.wait());
    } else {
      const std::uint64_t timeout =
          std::min(session.next_timeout().value_or(UINT64_MAX), wire.next_timeout().value_or(UINT64_MAX));
      is_tick = ticker.wait(socket.handle(), timeout) == Ticker::Woken::by_tick && !visit.body;
    }
    TACTUS_CHECK(visit.hear());
    const std::uint64_t now = microseconds_now();
    if (is_tick && is_live(session)) {
      TACTUS_CHECK(visit.step(now));
      ++live_ticks;
    }
    visit.say(now);
    if (meter.is_due(now)) meter.draw(now, visit.meter_text(now, visit.pace(ticker).missed));
  }
  return {};
}

Outcome run(const JoinOptions& typed) {
  JoinOptions options = typed;
  TACTUS_TRY(const net::Address server, session_address("SERVER", options.server, options.key));
  options.server = server.text();
  if (!options.participates() && !options.user.empty())
    return refuse_arguments("--user: nothing is touched without --scene", "Give the scene of the server with --scene.");
  std::optional<Body> body;
  std::optional<device::RealTime> real_time;
  if (options.participates()) {
    real_time.emplace();
    TACTUS_TRY(body, make_body(options));
  }
  auto session = SessionClient::create({.role = options.participates() ? Role::participant : Role::observer,
                                        .limits = options.limits,
                                        .playout = {playout_of(options.playout)},
                                        .device = {.position = options.device_error, .weber_fraction = options.weber_fraction},
                                        .seat = static_cast<std::uint8_t>(body ? body->user + 1 : 0)});
  if (!session) return refuse("session", session.error());
  auto socket = net::UdpSocket::connect(server);
  if (!socket) return refuse_port(options.server, server.port(), errno, "udp");
  TACTUS_TRY(const auto wire, make_wire(options, *socket));
  Visit visit(options, *session, *socket, server, *wire);
  visit.body = std::move(body);

  Ticker ticker(1'000'000 / sim::kTickRate);
  std::uint64_t live_ticks = 0;
  const Outcome worked = take_part(options, *session, visit, *wire, ticker, *socket, live_ticks);
  const double seconds = static_cast<double>(live_ticks) / sim::kTickRate;
  const bool ended_by_server = visit.closed.has_value();
  const Outcome finished = visit.close(microseconds_now());
  TACTUS_CHECK(worked);
  TACTUS_CHECK(finished);
  if (!visit.was_live) {
    const SessionStatus status = session->status();
    Failure failure = failure_of({.server = options.server,
                                  .ended = visit.closed,
                                  .is_refused = socket->is_refused(),
                                  .has_key = !options.key.empty(),
                                  .beyond = visit.beyond,
                                  .declaration = status.declaration,
                                  .received = status.received});
    if (failure.signal = visit.closed ? 0 : StopOnSignal::caught(); failure.signal != 0) failure.cause = Failure::Cause::stopped;
    return tl::unexpected(std::move(failure));
  }
  print(value_of(options, *session, visit, visit.pace(ticker), seconds, wire->seal()), "join", options.common);
  if (visit.lost > 0) {
    Failure failure{fmt::format("{}: {} lost", options.output, counted(visit.lost, "tick")), "Write to a faster disk."};
    failure.cause = Failure::Cause::bound;
    return tl::unexpected(std::move(failure));
  }
  if (ended_by_server && *visit.closed != LeaveReason::bye)
    return tl::unexpected(Failure{fmt::format("{}: the session ended: {}", options.server, name_of(*visit.closed)), ""});
  return {};
}

}  // namespace

void setup_join(Command& app, Action& action) {
  auto options = std::make_shared<JoinOptions>();
  Command& command = app.add_command("join", "Take part in a scene that `tactus serve` simulates");
  command.add_option("SERVER", options->server, "Its port on this machine; with --key HOST:PORT")->type_name("")->required();
  command
      .add_option("--scene", options->scene,
                  "The scene of the server: its shapes are touched with --device. Without, the client only looks on")
      ->type_name("SCENE");
  command.add_option("--user", options->user, "The user of the scene whose hand it is [the first]")->type_name("NAME");
  add_device_options(command, options->device);
  command.add_option("-o,--output", options->output, "Also write a trace of what is shown and felt, on the server's time (MCAP)")
      ->type_name("FILE");
  add_quantity(command, "--duration", options->duration, Dimension::time,
               "End after this long [until Ctrl-C or the server's end]");
  add_key(command, options->key);
  add_playout(command, options->playout);
  add_quantity(command, "--device-error", options->device_error, Dimension::length,
               "Largest error of the device's position that the server is told [0.1mm]")
      ->check(within(Dimension::length, "10um", "1m"));
  add_quantity(command, "--device-deadband", options->weber_fraction, Dimension::fraction,
               "In contact, largest error of the normal force that this error causes [4%]")
      ->check(within(Dimension::fraction, "0.1%", "100%"));
  add_limits(command, options->limits, "Largest scene that this end takes [see below]; may be repeated");
  add_output_options(command, options->common);
  command.footer(std::string(limits_help()) +
                 "\n\nExample:\n  tactus join 7447 --scene rotate-push-lift -o felt.mcap\n"
                 "From another machine:\n  tactus join 192.0.2.1:7447 --key lab.key --scene rotate-push-lift");
  on_chosen<JoinOptions>(command, action, options, run);
}

}  // namespace tactus::cli
