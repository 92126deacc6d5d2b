// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include <tactus/net/udp.h>
#include <tactus/session/session_client.h>
#include <tactus/sim/client.h>
#include <tactus/sim/user/hand.h>
#include <tactus/trace/trace_file.h>
#include "cli/commands/stop.h"
#include "cli/live/live_report.h"
#include "cli/live/meter.h"
#include "cli/live/ticker.h"
#include "cli/options/options_codec.h"
#include "cli/options/options_session.h"
#include "cli/options/units.h"
#include "cli/output.h"
#include "cli/report/json_parts.h"
#include "cli/report/messages.h"

namespace tactus::cli {
namespace {

using Json = nlohmann::ordered_json;

struct JoinOptions {
  std::string server, scene, user, replay, output;
  std::string playout = "adaptive";
  double duration = 0;  // [s], 0: until interrupted or the end of the recording
  std::uint64_t seed = 1;
  double device_error = 1e-4;  // [m]
  double weber_fraction = 0.04;
  CommonOptions common;

  bool participates() const { return !scene.empty(); }
};

/// The hand, the device and what it feels: only of a participant.
struct Body {
  std::unique_ptr<sim::Server> shapes;  // of the scene; nothing moves here
  std::unique_ptr<sim::Client> client;
  std::size_t user = 0;
  std::optional<sim::Hand> hand;
  std::optional<TraceReader> recording;
  TraceFrame recorded;
  std::vector<std::int64_t> mesh_ticks;  // of the shapes shown
  DeviceSample device;
};

tl::expected<Body, Failure> make_body(const JoinOptions& options) {
  const auto path = sim::find_scene(options.scene);
  if (!path) return refuse(path.error());
  const auto scene = sim::load_scene(*path);
  if (!scene) return refuse(scene.error());
  const auto user = std::ranges::find(scene->users, options.user, &sim::SceneUser::name);
  if (scene->users.empty() || (!options.user.empty() && user == scene->users.end()))
    return refuse_arguments(fmt::format("--user {}: not a user of {}", options.user, options.scene), "Give a user of the scene.");
  Body body;
  auto shapes = sim::Server::create(*scene, {.seed = options.seed, .codec = sim::ServerCodec{{}, {}, true}});
  if (!shapes) return refuse(options.scene, shapes.error());
  body.shapes = std::move(*shapes);
  body.client = sim::Client::create_remote(*body.shapes);
  body.user = options.user.empty() ? 0 : static_cast<std::size_t>(user - scene->users.begin());
  const sim::SceneUser& played = scene->users[body.user];
  body.hand.emplace(played, played.grip, options.seed);
  body.device.position = played.start;
  body.mesh_ticks.assign(body.shapes->frame().meshes.size(), -1);
  if (options.replay.empty()) return body;
  auto reader = TraceReader::open(options.replay);
  if (!reader) return refuse(options.replay, reader.error());
  if (reader->info().users.empty())
    return refuse_arguments("--replay " + options.replay + ": nobody is in this trace", "Give a trace with a user.");
  body.recording.emplace(std::move(*reader));
  return body;
}

/// Objects and meshes have the names and sizes of those of the server.
bool is_same_scene(const tactus::Scene& served, const tactus::Scene& own) {
  const auto same_objects = std::ranges::equal(served.objects, own.objects, {}, &RigidObject::name, &RigidObject::name);
  const auto vertices = [](const DeformableObject& o) { return o.rest.size(); };
  return same_objects && std::ranges::equal(served.deformables, own.deformables, {}, vertices, vertices);
}

/// Takes part in a session in real time.
class Visit {
 public:
  Visit(const JoinOptions& options, SessionClient& session, net::UdpSocket& socket)
      : options_(options), session_(session), socket_(socket) {}

  Outcome hear(std::uint64_t now);
  void say(std::uint64_t now);
  /// A tick of the device.   pre  live
  Outcome step(std::uint64_t now);
  /// False: the recording has ended.
  tl::expected<bool, Failure> move();
  void render(std::uint64_t now);
  Outcome record(std::uint64_t now);

  std::optional<Body> body;
  std::optional<TraceWriter> trace;
  std::optional<OutputFile> output;
  std::optional<LeaveReason> closed;
  bool was_live = false, at_end = false;
  std::uint64_t refused = 0;
  double largest_force = 0;  // [N]

 private:
  Outcome arrive();

  const JoinOptions& options_;
  SessionClient& session_;
  net::UdpSocket& socket_;
  std::array<std::uint8_t, 2048> buffer_{};
  TraceFrame frame_;
  std::int64_t shown_ = -1, written_ = -1;
  double share_ = 1;
};

/// The declaration is here.
Outcome Visit::arrive() {
  was_live = true;
  const tactus::Scene& scene = *session_.receiver()->scene();
  if (body && !is_same_scene(scene, *body->shapes->stream_scene()))
    return refuse_arguments("--scene " + options_.scene + ": the server simulates another scene",
                            "Give the scene of the server.");
  if (options_.output.empty() || trace) return {};
  TraceInfo info{.tick_rate = scene.tick_rate, .objects = {}, .users = {}, .source = "join " + options_.server, .scene = {}};
  for (const RigidObject& object : scene.objects) info.objects.push_back({object.name, object.dof});
  if (body) info.users.push_back({body->shapes->scene().users[body->user].name, {.buttons = true}});
  frame_.objects.resize(info.objects.size());
  frame_.users.resize(info.users.size());
  TACTUS_TRY(auto file,
             OutputFile::create_growing(options_.output, options_.common.existing(), {options_.scene, options_.replay}));
  output.emplace(std::move(file));
  auto writer = TraceWriter::create(output->working_path(), info);
  if (!writer) return refuse(options_.output, writer.error());
  trace.emplace(std::move(*writer));
  return {};
}

Outcome Visit::hear(std::uint64_t now) {
  while (const auto received = socket_.receive(buffer_))
    if (!session_.handle_datagram(now, received->bytes)) ++refused;
  session_.handle_timeout(now);
  while (const auto event = session_.poll_event()) {
    if (event->kind == ClientEvent::Kind::closed) closed = event->reason;
    if (event->kind == ClientEvent::Kind::live) TACTUS_CHECK(arrive());
  }
  return {};
}

void Visit::say(std::uint64_t now) {
  while (const auto datagram = session_.poll_datagram(now)) socket_.send(*datagram);
}

tl::expected<bool, Failure> Visit::move() {
  if (!body->recording) {
    body->device = body->hand->step(body->client->felt(body->user), body->client->watched(body->user));
    return true;
  }
  const auto more = body->recording->next(body->recorded);
  if (!more) return refuse(options_.replay, more.error());
  if (*more) body->device = body->recorded.users[0].device;
  return *more;
}

void Visit::render(std::uint64_t now) {
  TraceFrame& news = body->shapes->frame();
  Receiver& receiver = *session_.receiver();
  for (std::size_t i = 0; i < body->mesh_ticks.size(); ++i) {
    news.meshes[i].updated = receiver.tick(i + 1) != body->mesh_ticks[i];
    body->mesh_ticks[i] = receiver.tick(i + 1);
  }
  shown_ = session_.shown_tick(now);
  if (shown_ >= 0) body->client->show(receiver, shown_, news);
  share_ = session_.force_share(now);
  body->client->touch(body->user, body->device, share_);
  largest_force = std::max(largest_force, norm(body->client->felt(body->user)));
}

/// On the server's time base: the tick now at the server.
Outcome Visit::record(std::uint64_t now) {
  const SessionStatus status = session_.status();
  const Receiver* receiver = session_.receiver();
  if (!trace || shown_ < 0 || !status.clock_offset) return {};
  const std::int64_t at_server = static_cast<std::int64_t>(now) + *status.clock_offset - static_cast<std::int64_t>(status.start);
  const std::int64_t tick = at_server * receiver->scene()->tick_rate / 1'000'000;
  if (tick <= written_) return {};
  written_ = frame_.tick = tick;
  Replica& replica = session_.receiver()->replica();
  for (std::uint32_t i = 0; i < frame_.objects.size(); ++i)
    frame_.objects[i].pose = to_pose(replica.pose(i, shown_), receiver->scene()->grid.position);
  if (body) {
    frame_.users[0].device = body->device;
    frame_.users[0].force = body->client->felt(body->user);
  }
  if (const auto written = trace->write(frame_); !written) return refuse(options_.output, place_of_tick(tick), written.error());
  return {};
}

Outcome Visit::step(std::uint64_t now) {
  if (body) {
    TACTUS_TRY(const bool moves, move());
    at_end = !moves;
    if (const auto sent = session_.submit(now, body->device, body->client->contact(body->user)); !sent)
      return refuse("device", sent.error());
    render(now);
  } else {
    shown_ = session_.shown_tick(now);
  }
  return record(now);
}

std::string meter_text(const SessionStatus& status, const Ticker& ticker) {
  if (status.state != SessionState::live)
    return fmt::format("{} {} of {} kB", name_of(status.state), status.received / 1000, status.declaration / 1000);
  const double trip = status.round_trip ? 1e-3 * static_cast<double>(status.round_trip->smoothed) : 0;
  return fmt::format("live  round trip {:.1f} ms  shows {:.1f} ms after the fastest packet  loss up {:.1f} %  missed {}", trip,
                     1e-3 * static_cast<double>(status.playout_delay), 100 * status.loss, ticker.missed());
}

Json hashes_json(SessionClient& session) {
  Json out = Json::array();
  Receiver* receiver = session.receiver();
  if (receiver == nullptr) return out;
  if (!receiver->scene()->objects.empty()) out.push_back(fmt::format("{:016x}", receiver->state_hash(0)));
  for (std::size_t i = 0; i < receiver->scene()->deformables.size(); ++i)
    out.push_back(fmt::format("{:016x}", receiver->state_hash(i + 1)));
  return out;
}

Json to_json(const JoinOptions& options, SessionClient& session, const Visit& visit, const Ticker& ticker, double seconds) {
  const SessionStatus status = session.status();
  Json out{{"schema", "tactus.join/1"},
           {"server", options.server},
           {"role", options.participates() ? "participant" : "observer"},
           {"seconds", seconds},
           {"pace", pace_json(ticker)},
           {"playout_delay_us", status.playout_delay},
           {"loss", status.loss},
           {"datagrams_refused", visit.refused},
           {"traffic", traffic_json(status.traffic, seconds)},
           {"state_hashes", hashes_json(session)}};
  if (status.round_trip) out["round_trip"] = round_trip_json(*status.round_trip);
  if (status.clock_offset) out["clock_offset_us"] = *status.clock_offset;
  if (options.participates()) out["largest_force_N"] = visit.largest_force;
  return out;
}

void print_text(const JoinOptions& options, SessionClient& session, const Visit& visit, const Ticker& ticker, double seconds) {
  const SessionStatus status = session.status();
  Table head;
  head.heading({"join"});
  const auto row = [&](const char* name, const std::string& text) { head.row({fmt::format("  {:<8} {}", name, text)}); };
  row("server", options.server);
  row("role", options.participates() ? "participant" : "observer");
  row("time", fmt::format("{:.3f} s live", seconds));
  if (status.round_trip)
    row("trip", fmt::format("{:.2f} ms there and back, least {:.2f} ms", 1e-3 * static_cast<double>(status.round_trip->smoothed),
                            1e-3 * static_cast<double>(status.round_trip->least)));
  row("playout", fmt::format("{:.2f} ms after the fastest packet", 1e-3 * static_cast<double>(status.playout_delay)));
  if (options.participates()) row("touch", fmt::format("at most {:.2f} N", visit.largest_force));
  for (const Json& hash : hashes_json(session)) row("state", hash.get<std::string>());
  head.print(stdout);
  fmt::print("\n");
  Table table;
  traffic_heading(table);
  traffic_row(table, "to the server", status.traffic, seconds);
  pace_rows(table, ticker);
  table.print(stdout);
}

Outcome run(const JoinOptions& typed) {
  JoinOptions options = typed;
  TACTUS_TRY(const net::Address server, loopback_address("SERVER", options.server));
  options.server = server.text();
  if (!options.participates() && (!options.replay.empty() || !options.user.empty()))
    return refuse_arguments("--replay and --user: nothing is touched without --scene",
                            "Give the scene of the server with --scene.");
  auto session = SessionClient::create({.role = options.participates() ? Role::participant : Role::observer,
                                        .playout = {playout_of(options.playout)},
                                        .device = {.position = options.device_error, .weber_fraction = options.weber_fraction}});
  if (!session) return refuse("session", session.error());
  auto socket = net::UdpSocket::connect(server);
  if (!socket) return refuse(options.server, socket.error());
  Visit visit(options, *session, *socket);
  if (options.participates()) {
    TACTUS_TRY(visit.body, make_body(options));
  }
  session->open(microseconds_now(), system_entropy());

  const StopOnSignal stop;
  Meter meter(options.common.progress());
  Ticker ticker(1'000'000 / sim::kTickRate);
  std::uint64_t live_ticks = 0;
  const double most = options.duration > 0 ? options.duration * sim::kTickRate : 1e18;
  while (StopOnSignal::caught() == 0 && !visit.closed && !visit.at_end && static_cast<double>(live_ticks) < most) {
    const auto woken = ticker.wait(socket->handle(), session->next_timeout().value_or(UINT64_MAX));
    const std::uint64_t now = microseconds_now();
    TACTUS_CHECK(visit.hear(now));
    if (woken == Ticker::Woken::by_tick && session->receiver() != nullptr && session->status().state == SessionState::live) {
      TACTUS_CHECK(visit.step(now));
      ++live_ticks;
    }
    visit.say(now);
    if (meter.is_due(now)) meter.draw(now, meter_text(session->status(), ticker));
  }
  const double seconds = static_cast<double>(live_ticks) / sim::kTickRate;
  const bool ended_by_server = visit.closed.has_value();
  session->close();
  visit.say(microseconds_now());
  if (visit.trace) {
    if (const auto done = visit.trace->finish(); !done) return refuse(options.output, done.error());
    TACTUS_CHECK(visit.output->keep());
  }
  if (!visit.was_live) {
    const std::string why = visit.closed ? name_of(*visit.closed) : "interrupted";
    return tl::unexpected(Failure{fmt::format("{}: no session: {}", options.server, why), "Is `tactus serve` running there?"});
  }
  if (options.common.json) fmt::print("{}\n", text_of_json(to_json(options, *session, visit, ticker, seconds)));
  else if (!options.common.quiet) print_text(options, *session, visit, ticker, seconds);
  if (ended_by_server && *visit.closed != LeaveReason::bye)
    return tl::unexpected(Failure{fmt::format("{}: the session ended: {}", options.server, name_of(*visit.closed)), ""});
  return {};
}

}  // namespace

void setup_join(Command& app, Action& action) {
  auto options = std::make_shared<JoinOptions>();
  Command& command = app.add_command("join", "Take part in a scene that `tactus serve` simulates");
  command.add_option("SERVER", options->server, "Its port, or HOST:PORT on the loopback")->type_name("")->required();
  command
      .add_option("--scene", options->scene,
                  "The scene of the server: its shapes are touched by a virtual hand. Without, the client only looks on")
      ->type_name("SCENE");
  command.add_option("--user", options->user, "The user of the scene whose hand it is [the first]")->type_name("NAME");
  command.add_option("--replay", options->replay, "The device samples of this trace instead of the virtual hand")
      ->type_name("TRACE");
  command.add_option("-o,--output", options->output, "Also write a trace of what is shown and felt, on the server's time (MCAP)")
      ->type_name("FILE");
  command.add_option("--seed", options->seed, "Seed of the virtual hand")
      ->check(whole_number(0, UINT64_MAX))
      ->show_default()
      ->type_name("N");
  add_quantity(command, "--duration", options->duration, Dimension::time,
               "End after this long [until Ctrl-C or the server's end]");
  add_playout(command, options->playout);
  add_quantity(command, "--device-error", options->device_error, Dimension::length,
               "Largest error of the device's position that the server is told [0.1mm]")
      ->check(within(Dimension::length, "10um", "1m"));
  add_quantity(command, "--device-deadband", options->weber_fraction, Dimension::fraction,
               "In contact, largest error of the force that this error causes [4%]")
      ->check(within(Dimension::fraction, "0.1%", "100%"));
  add_output_options(command, options->common);
  command.footer("Example:\n  tactus join 7447 --scene rotate-push-lift -o felt.mcap");
  on_chosen<JoinOptions>(command, action, options, run);
}

}  // namespace tactus::cli
