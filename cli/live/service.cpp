// SPDX-License-Identifier: Apache-2.0
#include "cli/live/service.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "cli/live/live_report.h"
#include "cli/live/ticker.h"
#include "cli/report/table.h"

namespace tactus::cli {
namespace {

// [us] of silence: a hand begins to lift off, has lifted off and may be followed by another client, has lost its seat
constexpr std::uint64_t kFresh = 300'000, kLifted = 1'000'000, kEmpty = 10'000'000;
constexpr std::uint64_t kLasting = 3'000'000;  // [us] of wider bounds, before they are worth a line

}  // namespace

Service::Service(sim::Server& world, SessionServer& sessions, ServerWire& wire, Observation* observation, EventLog log)
    : world_(world),
      sessions_(sessions),
      wire_(wire),
      observation_(observation),
      log_(log),
      reported_(sessions.clients()),
      traffic_(sessions.clients()) {
  for (const sim::SceneUser& user : world.scene().users)
    seats_.push_back({.client = {}, .device = {.position = user.start}, .is_lifted = false});
  devices_.resize(seats_.size());
}

/// Each datagram has the time at which it was taken: what came while another was handled did not come before it.
void Service::hear() {
  constexpr int kMost = 1000;  // at a time: a tick must not wait for a flood to end
  for (int i = 0; i < kMost; ++i) {
    const auto heard = wire_.receive(microseconds_now());
    if (!heard) break;
    const std::uint64_t now = microseconds_now();
    if (!sessions_.handle_datagram(now, heard->peer, heard->bytes)) ++refused_;
    wire_.settle([this](std::uint64_t peer) { return has_session(peer); });
    send(now);
  }
  while (const auto peer = wire_.poll_closed()) end(*peer);
  sessions_.handle_timeout(microseconds_now());
}

/// The peer is gone: its client has left, even if no leave was heard.
void Service::end(std::uint64_t peer) {
  for (std::uint16_t i = 0; i < sessions_.clients(); ++i)
    if (sessions_.status(i).peer == peer) sessions_.close(i, LeaveReason::bye);
}

/// Users that are removed leave; what others may do is what their key list says now.
void Service::look_at_keys(std::uint64_t now) {
  const auto news = wire_.look_at_keys(now, std::exchange(must_look_, false));
  if (!news) return;
  log_.write(now, news->is_refused ? "keys_refused" : "keys", news->text, {{"text", news->text}});
  for (std::uint16_t i = 0; i < sessions_.clients(); ++i) {
    const ClientStatus status = sessions_.status(i);
    reported_[i].is_removed = std::ranges::find(news->removed, status.peer) != news->removed.end();
    if (reported_[i].is_removed) sessions_.close(i, LeaveReason::bye);
    else find_user(status);
  }
  send(now);
}

/// What a client may do is what the user of its address may, whoever it was before.
void Service::find_user(const ClientStatus& status) {
  if (status.state == SessionState::closed) return;
  if (auto user = wire_.user_of(status.peer)) reported_[status.client].user = std::move(user);
}

void Service::look_at_floods(std::uint64_t now) {
  constexpr std::uint64_t kEvery = 10'000'000;
  if (now < looked_at_ + kEvery) return;
  looked_at_ = now;
  std::uint64_t strangers = wire_.limited() - std::exchange(limited_, wire_.limited());
  for (std::uint16_t i = 0; i < sessions_.clients(); ++i) {
    const std::uint64_t all = wire_.limited_of(sessions_.status(i).peer), before = std::exchange(reported_[i].dropped, all);
    if (all <= before) continue;
    strangers -= std::min(strangers, all - before);
    report(i, now, "flood", fmt::format("sends too much: dropped {} of its datagrams in 10 s", all - before),
           {{"dropped", all - before}});
  }
  if (strangers > 0)
    log_.write(now, "flood", fmt::format("strangers send too much: dropped {} of their datagrams in 10 s", strangers),
               {{"dropped", strangers}});
}

void Service::close(std::uint64_t now) {
  sessions_.close();
  send(now);
  wire_.close();
}

void Service::send(std::uint64_t now) {
  while (const auto datagram = sessions_.poll_datagram(now)) wire_.send(datagram->peer, datagram->bytes);
  while (const auto event = sessions_.poll_event()) report(*event, now);
}

std::size_t Service::live() const {
  std::size_t count = 0;
  for (std::uint16_t i = 0; i < sessions_.clients(); ++i) count += sessions_.status(i).state == SessionState::live ? 1u : 0u;
  return count;
}

// Ticks

Outcome Service::step(std::uint64_t now, std::int64_t tick, std::optional<TraceWriter>& trace, const std::string& output) {
  constexpr std::int64_t kAtOnce = 10;
  wire_.tick(now, [this](std::uint64_t peer) { return has_session(peer); });
  look_at_keys(now);
  look_at_floods(now);
  look_after_seats(now);
  look_after_work(now);
  if (tick - next_ > kAtOnce) left_out_ += tick - std::exchange(next_, tick);
  for (; next_ <= tick; ++next_) TACTUS_CHECK(make_tick(now, trace, output));
  return {};
}

void Service::look_after_work(std::uint64_t now) {
  while (auto work = sessions_.poll_work()) work_.give(*std::move(work));
  while (auto done = work_.poll()) {
    auto rest = sessions_.take(now, *std::move(done));  // without memory the client asks again
    if (rest && *rest) work_.free(**std::move(rest));
  }
}

Outcome Service::make_tick(std::uint64_t now, std::optional<TraceWriter>& trace, const std::string& output) {
  for (std::size_t i = 0; i < seats_.size(); ++i) {
    Seat& seat = seats_[i];
    if (seat.client) seat.device = sessions_.device(*seat.client, now).value_or(seat.device);
    devices_[i] = seat.device;
  }
  world_.observe();
  TraceFrame& frame = world_.frame();
  frame.tick += left_out_;
  world_.touch(devices_);
  Truth truth = world_.truth();
  if (frame.changed) truth.moved = *frame.changed;
  if (const auto sent = sessions_.submit(now, frame.tick, truth); !sent)
    return refuse("session", location_of_tick(frame.tick), sent.error());
  log_held(frame.tick, now);
  send(now);
  if (observation_ != nullptr) observation_->offer(frame, truth.loads);
  if (trace)
    if (const auto written = trace->write(frame); !written) return refuse(output, location_of_tick(frame.tick), written.error());
  if (auto stepped = world_.step(); !stepped) return refuse(stepped.error());
  return {};
}

// Seats

std::uint64_t Service::silence_of(std::uint16_t client, std::uint64_t now) const {
  const std::uint64_t heard = sessions_.status(client).heard;
  return now > heard ? now - heard : 0;
}

void Service::look_after_seats(std::uint64_t now) {
  for (std::size_t i = 0; i < seats_.size(); ++i)
    if (seats_[i].client) look_after(seats_[i], i, now);
  for (std::uint16_t client = 0; client < sessions_.clients(); ++client) {
    const ClientStatus status = sessions_.status(client);
    if (status.state != SessionState::live) continue;
    log_bound_scale(status, now);
    if (status.role == Role::participant && silence_of(client, now) <= kFresh) give_seat(status, now);
  }
}

/// A hand that is not heard lifts off within a second; that of one who left, or was silent for too long, is where it was before anybody
/// came.
void Service::look_after(Seat& seat, std::size_t user, std::uint64_t now) {
  const std::uint64_t silence = silence_of(*seat.client, now);
  if (!reported_[*seat.client].may_touch()) return leave(seat, user, now, "may only look on now");
  if (sessions_.status(*seat.client).state == SessionState::closed) return leave(seat, user, now, "has left");
  if (silence > kEmpty) return leave(seat, user, now, "was silent for 10 s");
  world_.lift(user, static_cast<double>(kLifted - std::clamp(silence, kFresh, kLifted)) / (kLifted - kFresh));
  if (const bool lifted = silence > kLifted; lifted != std::exchange(seat.is_lifted, lifted))
    report(*seat.client, now, lifted ? "lifted" : "returned",
           lifted ? fmt::format("not heard for 1 s: the hand of {} lifts off", name_of(seat))
                  : fmt::format("heard again: it plays {}", name_of(seat)),
           {{"user", name_of(seat)}});
}

void Service::leave(Seat& seat, std::size_t user, std::uint64_t now, const std::string& why) {
  const std::uint16_t client = *seat.client;
  report(client, now, "unseated", fmt::format("{}: the seat of {} is free", why, name_of(seat)), {{"user", name_of(seat)}});
  sessions_.seat(client, 0);
  seat = {.client = {}, .device = {.position = world_.scene().users[user].start}, .is_lifted = false};
  world_.lift(user, 1);
}

/// The seat that a client wants, or any, if nobody whose hand is in the world has it.
Service::Seat* Service::seat_for(const ClientStatus& status, std::uint64_t now) {
  const auto is_free = [&](const Seat& seat) { return !seat.client || silence_of(*seat.client, now) > kLifted; };
  if (status.wanted_seat > seats_.size()) return nullptr;
  if (status.wanted_seat > 0) return is_free(seats_[status.wanted_seat - 1u]) ? &seats_[status.wanted_seat - 1u] : nullptr;
  const auto nobodys = std::ranges::find_if(seats_, [](const Seat& seat) { return !seat.client; });
  return nobodys == seats_.end() ? nullptr : &*nobodys;
}

/// What a client has is sent to it again if its session began anew.
void Service::give_seat(const ClientStatus& status, std::uint64_t now) {
  const std::uint16_t client = status.client;
  const auto own = std::ranges::find(seats_, client, &Seat::client);
  if (own != seats_.end()) {
    if (status.seat != number_of(*own)) sessions_.seat(client, number_of(*own));
    return;
  }
  if (!reported_[client].may_touch()) {
    if (status.seat != kOnlyLooksOn) sessions_.seat(client, kOnlyLooksOn);
    if (!std::exchange(reported_[client].looks_on, true)) report(client, now, "looks_on", "looks on: its user may not touch");
    return;
  }
  Seat* const seat = seat_for(status, now);
  if (seat == nullptr) {
    if (status.seat == kOnlyLooksOn) sessions_.seat(client, 0);
    if (std::exchange(reported_[client].looks_on, true)) return;
    report(client, now, "looks_on",
           status.wanted_seat == 0 ? "looks on: no seat is free"
                                   : fmt::format("looks on: seat {} is taken, or none of the scene", status.wanted_seat));
    return;
  }
  if (seat->client) leave(*seat, number_of(*seat) - 1u, now, "is followed by another client");
  seat->client = client;
  reported_[client].looks_on = false;
  sessions_.seat(client, number_of(*seat));
  report(client, now, "seated", "plays " + name_of(*seat), {{"user", name_of(*seat)}});
}

// What is reported to the operator

void Service::report(std::uint16_t client, std::uint64_t now, const char* event, const std::string& text, Json fields) {
  fields["client"] = client;
  if (reported_[client].user) fields["key"] = reported_[client].user->name;
  log_.write(now, event, fmt::format("{} {}", name_of(client), text), std::move(fields));
}

/// "client 2", "client 2 (anna)".
std::string Service::name_of(std::uint16_t client) const {
  const std::string user = user_of(client);
  return user.empty() ? fmt::format("client {}", client) : fmt::format("client {} ({})", client, user);
}

void Service::report(const ServerEvent& event, std::uint64_t now) {
  if (event.kind == ServerEvent::Kind::refused) return log_refusal(event.reason, now);
  const ClientStatus status = sessions_.status(event.client);
  switch (event.kind) {
    case ServerEvent::Kind::joined: {
      ++joined_;
      reported_[event.client] = {};
      find_user(status);
      const std::string address = wire_.address_of(status.peer),
                        role = status.role == Role::observer ? "observer" : "participant";
      return report(event.client, now, "joined", fmt::format("joins from {} as {}", address, role),
                    {{"address", address}, {"role", role}});
    }
    case ServerEvent::Kind::live:
      return report(event.client, now, "live", "has the scene");
    case ServerEvent::Kind::moved: {
      ++moved_;
      find_user(status);
      const std::string address = wire_.address_of(status.peer);
      return report(event.client, now, "moved", "is at " + address + " now", {{"address", address}});
    }
    case ServerEvent::Kind::left: {
      ++left_;
      traffic_.add(event.client, status.traffic);
      const char* const reason =
          reported_[event.client].is_removed ? "its user is removed, or has another key" : cli::name_of(event.reason);
      return report(event.client, now, "left", fmt::format("is gone: {}", reason), {{"reason", reason}});
    }
    case ServerEvent::Kind::bounds_scaled:
      reported_[event.client].scaled_at = now;
      return;
    case ServerEvent::Kind::refused:
      return;
  }
}

/// Once a second: a client that is refused may come again at once.
void Service::log_refusal(LeaveReason reason, std::uint64_t now) {
  constexpr std::uint64_t kEvery = 1'000'000;
  const std::uint64_t times = ++refusals_[static_cast<std::size_t>(reason)];
  if (refusal_logged_at_ > 0 && now < refusal_logged_at_ + kEvery) return;
  refusal_logged_at_ = now;
  const std::string why = reason == LeaveReason::full ? fmt::format("there is room for {} (--clients)", sessions_.clients())
                          : reason == LeaveReason::version
                              ? "it speaks another version"
                              : "the scene is beyond its limits (its --limit: memory or declaration)";
  log_.write(now, "refused", fmt::format("a client is refused: {}; {} so far", why, counted(times, "join")),
             {{"reason", cli::name_of(reason)}, {"joins", times}});
}

void Service::log_held(std::int64_t tick, std::uint64_t now) {
  held_.look(tick, sessions_.held());
  const Scene& scene = *world_.stream_scene();
  const auto fields = [&](const HeldPart& part) {
    return Json{{"object", std::string(tactus::name_of(scene, part))}, {"since_tick", part.since}, {"rule", part.rule}};
  };
  for (const HeldPart& part : held_.begun())
    log_.write(now, "held", fmt::format("{}: it is held, the others go on", text_of(scene, part)), fields(part));
  for (const HeldPart& part : held_.ended())
    log_.write(now, "goes-on", fmt::format("{} goes on after tick {}", tactus::name_of(scene, part), part.since), fields(part));
}

void Service::describe(ServerFigures& out) {
  for (std::uint16_t i = 0; i < sessions_.clients(); ++i) {
    out.clients[i] = sessions_.status(i);
    traffic_.add(i, out.clients[i].traffic);
  }
  out.seats = seats_.size();
  out.seats_taken =
      static_cast<std::size_t>(std::ranges::count_if(seats_, [](const Seat& seat) { return seat.client.has_value(); }));
  out.joined = joined_;
  out.left = left_;
  out.moved = moved_;
  out.refused = refusals_;
  out.datagrams_refused = refused_;
  out.datagrams_limited = wire_.limited();
  out.traffic = traffic_.sum();
  if (const auto seal = wire_.seal()) out.seal = seal->counters;
}

void Service::log_bound_scale(const ClientStatus& status, std::uint64_t now) {
  Reported& reported = reported_[status.client];
  if (status.bound_scale == reported.bound_scale || now < reported.scaled_at + kLasting) return;
  reported.bound_scale = status.bound_scale;
  report(status.client, now, "bounds_scaled",
         status.bound_scale == 1
             ? std::string("has the bounds that were asked for again")
             : fmt::format("gets bounds {:.3g} times as wide: its network does not carry more", status.bound_scale),
         {{"bound_scale", status.bound_scale}});
}

}  // namespace tactus::cli
