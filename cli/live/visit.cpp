// SPDX-License-Identifier: Apache-2.0
#include "cli/live/visit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include <tactus/base/shown.h>
#include <tactus/trace/trace_scene.h>
#include "cli/commands/input.h"
#include "cli/options/options_limits.h"
#include "cli/report/messages.h"

namespace tactus::cli {
namespace {

std::string names_of(const std::vector<sim::SceneUser>& users) {
  std::string out;
  for (const sim::SceneUser& user : users) out.append(out.empty() ? "" : ", ").append(user.name);
  return out;
}

TickTiming tick_timing_of(const device::ServoTimes& times) {
  const auto us = [&](double fraction) { return 1e-3 * static_cast<double>(times.lateness.quantile(fraction)); };
  return {times.ticks, times.missed, us(0.5), us(0.99)};
}

}  // namespace

tl::expected<Body, Failure> make_body(const JoinOptions& options) {
  const auto path = sim::find_scene(options.scene);
  if (!path) return refuse(path.error());
  auto scene = sim::load_scene(*path);
  if (!scene) return refuse(scene.error());
  const auto user = std::ranges::find(scene->users, options.user, &sim::SceneUser::name);
  if (scene->users.empty())
    return refuse_arguments(fmt::format("--scene {}: it has no users, so nobody can touch it", options.scene),
                            "Leave out --scene to look on.");
  if (!options.user.empty() && user == scene->users.end())
    return refuse_arguments(fmt::format("--user {}: not a user of {}", options.user, options.scene),
                            fmt::format("Its users: {}.", names_of(scene->users)));
  Body body;
  body.user = options.user.empty() ? 0 : static_cast<std::size_t>(user - scene->users.begin());
  scale_device(scene->users[body.user], options.device);
  auto shapes = sim::Server::create(
      *scene, {.seed = options.device.seed, .codec = sim::ServerCodec{.sender = {}, .sessions = true, .limits = options.limits}});
  if (!shapes) return tl::unexpected(allow_more(refuse(options.scene, shapes.error()).value(), shapes.error()));
  body.shapes = std::move(*shapes);
  auto client = sim::Client::create_remote(*body.shapes, body.user, *scene);
  if (!client) return refuse(options.scene, client.error());
  body.client = std::move(*client);
  TACTUS_TRY(body.chosen, open_device(options.device, &*scene, body.user));
  TACTUS_CHECK(check_position(body.chosen.device->capabilities()));
  TACTUS_CHECK(check_force(options.device, body.chosen.device->capabilities()));
  return body;
}

Visit::Visit(const JoinOptions& options, SessionClient& session, net::UdpSocket& socket, const net::Address& server,
             ClientWire& wire)
    : options_(options), session_(session), socket_(socket), server_(server), wire_(wire), token_(options.server, options.user) {}

std::optional<GuardReport> Visit::guard() const {
  return body && body->servo ? guard_report(*body->servo, body->begin) : std::nullopt;
}

TickTiming Visit::tick_timing(const Ticker& ticker) const {
  return body && body->servo ? tick_timing_of(body->servo->times()) : tick_timing_of(ticker);
}

void Visit::note(const Error& error) {
  ++refused;
  if (std::string names = limits_of(error); !names.empty()) beyond = std::move(names);
}

void Visit::print(const std::string& text) const {
  if (!options_.common.quiet) fmt::print(stderr, "{}\n", text);
}

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
    print(fmt::format("the server has begun anew: {} ends here", shown_path(options_.output)));
    return {};
  }
  TraceInfo info = replica_info(scene, "join " + options_.server);
  info.shows_past = true;
  if (body) {
    DeviceSenses senses = body->chosen.device->capabilities().senses;
    senses.buttons = true;
    info.users.push_back({.name = body->shapes->scene().users[body->user].name,
                          .senses = senses,
                          .has_servo = true,
                          .forces = RecordedForces::rendered});
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
  constexpr std::uint64_t kUnanswered = 1'000'000, kRenewed = 1'500'000, kEvery = 5'000'000;  // [us]
  const std::uint64_t unanswered = session_.unanswered(now);
  if (unanswered > 0 && silent_since_ == 0) silent_since_ = now - unanswered;
  if (unanswered > kUnanswered && !std::exchange(is_unanswered_, true)) print("no answer from the server for 1 s: joining again");
  if (unanswered == 0) {
    if (std::exchange(is_unanswered_, false))
      print(fmt::format("the server answers again, after {:.1f} s", 1e-6 * static_cast<double>(now - silent_since_)));
    silent_since_ = 0;
    return;
  }
  if (unanswered < kRenewed || now < renewed_at_ + kEvery) return;
  renewed_at_ = now;
  if (auto fresh = net::UdpSocket::connect(server_)) socket_ = std::move(*fresh);
  wire_.renew(now);
}

/// Anyone can claim that the key is wrong: the handshake goes on as if nobody had.
void Visit::look_at_key() {
  if (is_doubted_ == wire_.is_doubted()) return;
  is_doubted_ = wire_.is_doubted();
  if (is_doubted_)
    print(fmt::format(
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
    print(fmt::format("nobody listens at {}: waiting for a server", options_.server));
  const bool is_unheard = status.state == SessionState::joining && now > begun_at_ + kWait && !socket_.is_refused();
  if (is_unheard && options_.key.empty() && !std::exchange(is_unheard_, true))
    print(fmt::format(
        "{} takes datagrams but does not answer: if its server has a key, this end needs it too (--key FILE). Trying on",
        options_.server));
  if (status.state != SessionState::receiving) return;
  if (receiving_since_ == 0) receiving_since_ = progress_shown_at_ = now;
  if (now < progress_shown_at_ + kEvery) return;
  progress_shown_at_ = now;
  print(progress_text(status.received, status.declaration, now - receiving_since_));
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
  constexpr std::uint64_t kSoon = 1'000'000;  // [us]: by then the server has sent it
  if (!body || closed || session_.status().state != SessionState::live) return;
  const std::uint8_t seat = session_.status().seat;
  if (seat_ == seat || (seat == 0 && now < live_at_ + kSoon)) return;
  seat_ = seat;
  const std::string& user = body->shapes->scene().users[body->user].name;
  if (seat == kOnlyLooksOn)
    return print(fmt::format("looks on: the key \"{}\" may not touch. Whoever runs the server can change its role",
                             wire_.seal() ? wire_.seal()->user : ""));
  if (seat > 0) {
    played = user;
    return print("plays " + user);
  }
  print(fmt::format("{} is played by another: this end looks on until the seat is free. --user NAME plays another one", user));
}

void Visit::send(std::uint64_t now) {
  while (const auto datagram = session_.poll_datagram(now)) wire_.send(*datagram);
}

Outcome Visit::close(std::uint64_t now) {
  session_.close();
  send(now);
  wire_.close();
  token_.keep(0);
  if (!trace) return {};
  const auto done = trace->finish();
  const TraceRecorder::Status status = trace->status();
  if (!done) return refuse(options_.output, status.error ? location_of_tick(status.last_written) : "", done.error());
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
  own.sample = own.chosen.frame.to_world(tick->reading.sample);
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
  own.client->touch(own.user, own.sample, {session_.force_fraction(now), delay});
  const Vec3 force = own.client->rendered_force(own.user);
  if (const auto exerted = own.servo->exert((1 / own.chosen.frame.scale) * force); !exerted)
    return refuse_device(own.chosen.device->capabilities().name, exerted.error());
  largest_force = std::max(largest_force, norm(force) / own.chosen.frame.scale);
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
    user.force = guard != nullptr ? body->chosen.frame.scale * guard->written() : Vec3{};
    user.servo = {body->tick.lateness, body->tick.age, body->tick.missed, guard != nullptr ? guard->actions() : 0U};
  }
  trace->offer(frame_);
  const TraceRecorder::Status writing = trace->status();
  if (!writing.error) return {};
  errno = writing.cause;
  return refuse(options_.output, location_of_tick(tick), *writing.error);
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

}  // namespace tactus::cli
