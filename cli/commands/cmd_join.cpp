// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <optional>

#include <tactus/device/real_time.h>
#include <tactus/net/udp.h>
#include <tactus/session/session_client.h>
#include "cli/live/device_choice.h"
#include "cli/live/live_report.h"
#include "cli/live/ticker.h"
#include "cli/live/visit.h"
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

Value join_value(const JoinOptions& options, SessionClient& session, const Visit& visit, const TickTiming& timing, double seconds,
                 const std::optional<SealUse>& seal) {
  const SessionStatus status = session.status();
  Json out{{"schema", "tactus.join/1"},
           {"server", options.server},
           {"role", options.participates() ? "participant" : "observer"},
           {"seconds", seconds},
           {"tick_timing", tick_timing_value(timing)},
           {"playout_delay_us", status.playout_delay},
           {"loss", status.loss},
           {"datagrams_refused", visit.refused},
           {"traffic", traffic_value(status.traffic, seconds, seal)},
           {"state_hashes", hashes_json(session)}};
  if (status.round_trip) out["round_trip"] = round_trip_value(*status.round_trip);
  if (status.clock_offset) out["clock_offset_us"] = *status.clock_offset;
  if (seal) out["key"] = seal->user;
  if (seal) out["seal"] = seal_value(seal->counters);
  if (options.participates()) {
    out["plays"] = visit.played.empty() ? Json() : Json(visit.played);
    out["largest_force_N"] = visit.largest_force;
  }
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
    visit.send(now);
    if (meter.is_due(now)) meter.draw(now, visit.meter_text(now, visit.tick_timing(ticker).missed));
  }
  return {};
}

Outcome run_join(const JoinOptions& typed) {
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
  print(join_value(options, *session, visit, visit.tick_timing(ticker), seconds, wire->seal()), "join", options.common);
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
  add_scale(command, options->device);
  command
      .add_option("-o,--output", options->output, "Also write a trace of what is shown and rendered, on the server's time (MCAP)")
      ->type_name("FILE");
  add_quantity(command, "--duration", options->duration, Dimension::time,
               "End after this long [until Ctrl-C or the server's end]");
  add_key(command, options->key);
  add_playout(command, options->playout);
  add_quantity(command, key("device_error"), options->device_error, Dimension::length,
               "Largest error of the device's position that is sent to the server [0.1mm]")
      ->check(within(Dimension::length, "10um", "1m"));
  add_quantity(command, key("device_deadband"), options->weber_fraction, Dimension::fraction,
               "In contact, largest error of the normal force that this error causes [4%]")
      ->check(within(Dimension::fraction, "0.1%", "100%"));
  add_limits(command, options->limits, "Largest scene that this end takes [see below]; may be repeated");
  add_output_options(command, options->common);
  command.footer(std::string(limits_help()) +
                 "\n\nExample:\n  tactus join 7447 --scene rotate-push-lift -o client.mcap\n"
                 "From another machine:\n  tactus join 192.0.2.1:7447 --key lab.key --scene rotate-push-lift");
  on_chosen<JoinOptions>(command, action, options, run_join);
}

}  // namespace tactus::cli
