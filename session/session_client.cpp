// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/session_client.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <tactus/base/quantise.h>
#include <tactus/base/rule.h>
#include <tactus/scene/scene_builder.h>
#include <tactus/scene/scene_syntax.h>
#include <tactus/session/exchange.h>
#include <tactus/session/timing.h>

namespace tactus {
namespace {

constexpr std::uint64_t kFirstRetry = 100'000, kRejoin = 250'000, kLastRetry = 2'000'000, kJoinFor = 10'000'000;  // [us]
// [us] from one keep-alive to the next: of a participant to whom a force is rendered, over a network that loses or not; of another
// participant; of an observer while packets come, and at rest.
constexpr std::uint64_t kRenderedAtLoss = 12'000, kRendered = 25'000, kParticipant = 50'000, kServed = 100'000, kIdle = 1'000'000;
constexpr std::uint64_t kMoving = 100'000;  // [us] the same, while its viewpoint moves
constexpr std::uint64_t kSeldom = 2;        // times these, of a client that computes what its device does
constexpr std::uint32_t kSomeLoss = 65536 / 50;
constexpr std::uint64_t kRecent = 1'000'000;     // [us]: what counts as now
constexpr std::uint64_t kButtonsEvery = 20'000;  // [us] until they are acknowledged
constexpr std::uint64_t kUnanswered = 400'000;   // [us] at least, until a client joins again
constexpr std::uint64_t kAsleep = 100'000;       // [us] without a call: the program, or its machine, stood still
constexpr std::uint64_t kStuck = 500'000;  // [us] that packets wait for one that is missing before a key packet is asked for
constexpr unsigned kLeaves = 3;            // one of them should arrive

/// An epoch, from its welcome on.
struct Epoch {
  Epoch(const Welcome& message, std::uint64_t now)
      : welcome(message), exchange(Direction::up, message.epoch, now), pieces(message.size, message.hash) {}

  Welcome welcome;
  Exchange exchange;
  PieceReceiver pieces;
  std::optional<PlayoutClock> playout;
  std::optional<DeviceTruth> device;
  std::uint64_t device_start = 0;  // [us] of the device's tick 0
  std::int64_t device_tick = -1;   // of the last sample
};

}  // namespace

struct SessionClient::Impl {
  explicit Impl(const SessionClientOptions& of) : options(of) {}

  bool go(SessionEvent event) noexcept;
  void close(SessionEvent event, LeaveReason reason) noexcept;
  Result<void> welcomed(std::uint64_t now, const Welcome& message) noexcept;
  Result<void> handle(std::uint64_t now, const Numbered& message) noexcept;
  Result<void> take(const Part& part, const Exchange::Heard& heard, std::uint64_t now) noexcept;
  Result<void> complete(std::uint64_t now) noexcept;
  void play(const Exchange::Heard& heard, std::uint64_t now) noexcept;
  bool is_stuck(std::uint64_t now) const noexcept;
  std::uint64_t keep_alive_due() const noexcept;
  std::uint64_t rejoin_due() const noexcept;
  bool has_buttons_due(std::uint64_t now) const noexcept;
  bool looks() const noexcept;
  bool has_moved() const noexcept;
  ReportPart report(std::uint64_t now) noexcept;
  Epoch* shown_epoch() const noexcept { return shown ? shown.get() : current.get(); }
  void look(std::uint64_t now) noexcept;
  void note(ClientEvent event) noexcept {
    if (event_count < events.size()) events[event_count++] = event;
  }

  SessionClientOptions options;
  SessionState state = SessionState::closed;
  std::uint64_t nonce = 0, token = 0;
  std::uint64_t opened_at = 0, join_at = 0, retry = 0;
  bool rejoins = false;  // a join went in this silence
  std::uint8_t seat = 0;
  std::uint64_t looked_at = 0;      // [us] of the last call
  std::uint64_t woke_at = 0;        // [us] of the last after so long that what is known of the delays may be too old
  std::unique_ptr<Epoch> current;   // the newest
  std::unique_ptr<Epoch> shown;     // the one before, until the newest is live
  std::uint64_t keep_alive_at = 0;  // [us] of the last keep-alive
  std::uint64_t live_number = 0;    // of the first datagram that reported that the client is live; 0: none did yet
  std::uint64_t packet_at = 0;      // [us] of the last packet
  bool feels = false;               // the device is in contact
  std::optional<HashPart> hash;
  ButtonsPart buttons;
  std::uint64_t buttons_at = 0;                                    // [us] when they go next
  std::uint64_t buttons_number = 0;                                // of the datagram that first brought them; 0: none yet
  bool buttons_wait = false;                                       // for an acknowledgement
  std::optional<std::array<std::int32_t, 3>> view, view_reported;  // where the user looks from
  ClockOffset offset;
  ForceFade fade;
  unsigned leaves = 0;
  LeaveReason leaving = LeaveReason::bye;
  DatagramWriter writer{Direction::up};
  std::array<ClientEvent, 8> events{};
  std::size_t event_count = 0, next_event = 0;
};

SessionClient::SessionClient(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
SessionClient::SessionClient(SessionClient&&) noexcept = default;
SessionClient& SessionClient::operator=(SessionClient&&) noexcept = default;
SessionClient::~SessionClient() = default;

Result<SessionClient> SessionClient::create(const SessionClientOptions& options) try {
  if (options.role == Role::participant) {  // so that no session ends for what is known before
    TACTUS_TRY(SharedScene any, device_scene({}));
    TACTUS_CHECK(Sender::create(std::move(any), device_sender_options(options.device)));
  }
  return SessionClient(std::make_unique<Impl>(options));
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

bool SessionClient::Impl::go(SessionEvent event) noexcept {
  const auto next = next_state(client_transitions(), state, event);
  if (next) state = *next;
  return next.has_value();
}

void SessionClient::Impl::close(SessionEvent event, LeaveReason reason) noexcept {
  const bool has_joined = state == SessionState::receiving || state == SessionState::live;
  if (!go(event)) return;
  leaving = reason;
  leaves = has_joined && event != SessionEvent::left ? kLeaves : 0;
  note({.kind = ClientEvent::Kind::closed, .reason = reason});
}

void SessionClient::open(std::uint64_t now, std::uint64_t nonce, std::uint64_t token) noexcept {
  if (!impl_->go(SessionEvent::open)) return;
  impl_->nonce = nonce;
  impl_->token = token;
  impl_->seat = 0;
  impl_->rejoins = false;
  impl_->opened_at = impl_->join_at = now;
  impl_->retry = kFirstRetry;
  impl_->leaves = 0;
  impl_->current.reset();
  impl_->shown.reset();
  impl_->offset = {};
}

void SessionClient::close() noexcept { impl_->close(SessionEvent::close, LeaveReason::bye); }

/// The program calls. If it did not for long, what comes now has waited.
void SessionClient::Impl::look(std::uint64_t now) noexcept {
  if (now > looked_at + kAsleep && shown_epoch() != nullptr && shown_epoch()->playout) shown_epoch()->playout->wake(now);
  if (now > looked_at + kDelayWindow / 2) woke_at = now;
  looked_at = now;
}

Result<void> SessionClient::handle_datagram(std::uint64_t now, std::span<const std::uint8_t> datagram) noexcept {
  Impl& in = *impl_;
  in.look(now);
  const bool active = in.state == SessionState::receiving || in.state == SessionState::live;
  const bool before = is_before_epochs(datagram);
  if (!before && !active) return fail(Errc::checksum, "R-SES-1");
  if (!is_of_epoch(datagram, before ? 0 : in.current->exchange.epoch(), Direction::down)) return fail(Errc::checksum, "R-SES-1");
  TACTUS_TRY(const Datagram message, read_datagram(datagram, Direction::down));
  if (!before) {
    if (const auto* numbered = std::get_if<Numbered>(&message)) return in.handle(now, *numbered);
    if (const auto* leave = std::get_if<Leave>(&message)) in.close(SessionEvent::left, leave->reason);
    return {};
  }
  if (const auto* welcome = std::get_if<Welcome>(&message); welcome != nullptr && welcome->nonce == in.nonce)
    return in.welcomed(now, *welcome);
  if (const auto* refusal = std::get_if<Refusal>(&message); refusal != nullptr && refusal->nonce == in.nonce)
    in.close(SessionEvent::refused, refusal->reason);
  return {};
}

Result<void> SessionClient::Impl::welcomed(std::uint64_t now, const Welcome& message) noexcept try {
  const bool anew = rejoins && message.serial == 0 && message.epoch != token;  // the server does not know the session
  const bool repeated = current && message.serial <= current->welcome.serial && state != SessionState::joining && !anew;
  if (repeated || !next_state(client_transitions(), state, SessionEvent::welcomed)) return {};
  const bool too_large = message.size > options.limits.header_bytes;
  Welcome taken = message;
  if (too_large) taken.size = 0;  // nothing of it is to come
  auto next = std::make_unique<Epoch>(taken, now);
  if (state == SessionState::live) shown = std::move(current);
  current = std::move(next);
  go(SessionEvent::welcomed);
  if (too_large) {
    close(SessionEvent::rejected, LeaveReason::limits);
    return {};
  }
  if (message.serial == 0) {
    token = message.epoch;
    seat = 0;
  }
  offset = {};
  keep_alive_at = live_number = 0;
  feels = rejoins = false;
  hash.reset();
  buttons = {};
  buttons_wait = false;
  note({.kind = ClientEvent::Kind::welcomed});
  return {};
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

Result<void> SessionClient::Impl::handle(std::uint64_t now, const Numbered& message) noexcept {
  const auto take_part = [&](const Part& part, const Exchange::Heard& heard) { return take(part, heard, now); };
  TACTUS_TRY(const Exchange::Heard heard, current->exchange.handle(now, message, take_part));
  if (heard.hash) hash = heard.hash;
  if (heard.tick) packet_at = now;
  rejoins = rejoins && current->exchange.unanswered();
  if (current->playout) play(heard, now);
  if (buttons_wait && current->exchange.sent().highest_acknowledged() >= buttons_number && buttons_number > 0)
    buttons_wait = false;
  if (state == SessionState::receiving && current->pieces.is_complete()) return complete(now);
  return {};
}

Result<void> SessionClient::Impl::take(const Part& part, const Exchange::Heard& heard, std::uint64_t now) noexcept {
  if (const auto* clock = std::get_if<ClockPart>(&part)) {
    const bool was_awake = heard.round_trip && woke_at + static_cast<std::uint64_t>(*heard.round_trip) <= now;
    if (was_awake) offset.add(clock->time, *heard.round_trip, now);
    if (current->playout)
      current->playout->clock_signalled(
          static_cast<std::int64_t>(clock->time) - static_cast<std::int64_t>(current->welcome.start), now);
  } else if (const auto* piece = std::get_if<PiecePart>(&part)) {
    return current->pieces.take(piece->index, piece->bytes);
  } else if (const auto* baselines = std::get_if<BaselinesPart>(&part)) {
    current->exchange.expect(baselines->policy == 0);
  } else if (const auto* mapping = std::get_if<TickMappingPart>(&part)) {
    if (current->exchange.path) current->exchange.path->shift(mapping->from, mapping->offset);
  } else if (const auto* given = std::get_if<SeatPart>(&part)) {
    seat = given->seat;
  }
  return {};
}

/// What a datagram means for what to show.
void SessionClient::Impl::play(const Exchange::Heard& heard, std::uint64_t now) noexcept {
  PlayoutClock& playout = *current->playout;
  const Exchange& exchange = current->exchange;
  playout.set_repair(exchange.is_repaired() ? exchange.sent().round_trip() : std::nullopt);
  playout.waits(exchange.waits_since(now), now);
  playout.heard(heard.number, heard.newest, now);
  if (heard.has_copy) playout.repaired(*heard.tick);
  if (heard.held)
    for (const auto& arrival : *heard.held) playout.held(arrival.tick, arrival.at, now);
  Receiver& receiver = *current->exchange.receiver;
  receiver.replica().keep(playout.delay() * receiver.scene()->tick_rate / 1'000'000 + 1);
  if (heard.round_trip) playout.measured(*heard.round_trip, now);
  if (heard.oldest && *heard.oldest < *heard.newest) playout.late(*heard.oldest, now);
}

/// Packets wait longer than any copy can need.
bool SessionClient::Impl::is_stuck(std::uint64_t now) const noexcept {
  const auto since = current->exchange.waits_since(now);
  return since && now > *since + std::max(kStuck, 4 * current->exchange.ack_timeout());
}

/// The declaration is here: show its scene from now on, or leave.
Result<void> SessionClient::Impl::complete(std::uint64_t now) noexcept try {
  const auto begin = [&]() -> Result<void> {
    TACTUS_TRY(const auto bytes, current->pieces.declaration());
    TACTUS_TRY(const ParsedScene parsed, parse_scene(bytes, options.limits));
    const SharedScene& scene = parsed.scene;
    SharedScene device;                // null: an observer has none
    std::shared_ptr<DevicePath> path;  // null: it drives nothing
    if (options.role != Role::observer) {
      TACTUS_TRY(device, device_scene(*scene));
      if (scene->has_paths()) path = std::make_shared<DevicePath>(device);
    }
    TACTUS_TRY(Receiver receiver,
               Receiver::create(scene, {.replica = {.interpolation = Interpolation::playout}, .limits = options.limits}, path));
    current->exchange.receive_with(std::move(receiver));
    const ForceFade::Limits& limits = scene->has_paths() ? ForceFade::kDriven : ForceFade::kUsual;
    current->playout.emplace(scene->tick_rate, options.playout, static_cast<std::int64_t>(limits.stale));
    if (!device) return {};
    TACTUS_TRY(auto sender, Sender::create(std::move(device), device_sender_options(options.device)));
    fade.set_limits(limits);
    current->exchange.path = std::move(path);
    current->exchange.send_with(std::move(sender));
    current->device.emplace(scene->tick_rate, options.senses_velocity);
    current->device_start = now;
    return {};
  };
  if (const auto begun = begin(); !begun) {
    const bool too_large = begun.error().code == Errc::limit_exceeded;
    close(SessionEvent::rejected, too_large ? LeaveReason::limits : LeaveReason::scene);
    return tl::unexpected(begun.error());
  }
  go(SessionEvent::completed);
  view_reported.reset();
  shown.reset();
  keep_alive_at = 0;
  note({.kind = ClientEvent::Kind::live});
  return {};
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

/// When the next keep-alive goes.
std::uint64_t SessionClient::Impl::keep_alive_due() const noexcept {
  if (keep_alive_at == 0) return 0;
  // Until the server knows that the client is live, it takes no packet of the device, and acknowledges none.
  if (state == SessionState::live && current->exchange.sent().highest_acknowledged() < live_number)
    return current->exchange.next_send(keep_alive_at + kParticipant);
  const std::uint64_t sent = std::max(keep_alive_at, current->exchange.eliciting_at());
  const bool served = state == SessionState::receiving || sent < packet_at + kRecent;
  const std::uint64_t times = current->exchange.path ? kSeldom : 1;
  const std::uint64_t rendered = current->exchange.sent().loss() > kSomeLoss ? kRenderedAtLoss : times * kRendered;
  const std::uint64_t pause = feels                               ? rendered
                              : options.role == Role::participant ? times * kParticipant
                              : served                            ? kServed
                                                                  : kIdle;
  const std::uint64_t due = current->exchange.next_send(sent + pause);
  return has_moved() ? std::min(due, current->exchange.next_send(keep_alive_at + kMoving)) : due;
}

/// The server asks for the viewpoint of the user.
bool SessionClient::Impl::looks() const noexcept {
  return view && state == SessionState::live && current->exchange.receiver && current->exchange.receiver->scene()->interest;
}

/// Away from the viewpoint that the server knows, by 0.1 m.
bool SessionClient::Impl::has_moved() const noexcept {
  constexpr std::int64_t kStep = (std::int64_t{1} << ReportPart::kViewExponent) / 10;
  if (!looks()) return false;
  for (std::size_t i = 0; view_reported && i < 3; ++i)
    if (std::abs(std::int64_t{(*view)[i]} - (*view_reported)[i]) > kStep) return true;
  return !view_reported;
}

/// pre  live
ReportPart SessionClient::Impl::report(std::uint64_t now) noexcept {
  const auto& fixed = options.playout.fixed;
  const auto delay = static_cast<std::uint64_t>(current->playout->delay()) / 1000;
  ReportPart out{.delay = fixed ? std::max<std::uint64_t>(1, *fixed / 1000) : delay,
                 .flags = is_stuck(now) ? ReportPart::kKey : std::uint8_t{0}};
  if (!looks()) return out;
  out.flags |= ReportPart::kView;
  view_reported = view;
  out.view = *view;
  return out;
}

/// When a client without an answer joins again.   pre  receiving or live
std::uint64_t SessionClient::Impl::rejoin_due() const noexcept {
  const auto since = current->exchange.unanswered();
  if (!since) return std::numeric_limits<std::uint64_t>::max();
  return rejoins ? join_at : *since + std::max(kUnanswered, 2 * current->exchange.ack_timeout());
}

bool SessionClient::Impl::has_buttons_due(std::uint64_t now) const noexcept {
  return buttons_wait && now >= current->exchange.next_send(buttons_at);
}

void SessionClient::handle_timeout(std::uint64_t now) noexcept {
  Impl& in = *impl_;
  in.look(now);
  if (in.state == SessionState::joining && now >= in.opened_at + kJoinFor) in.close(SessionEvent::silent, LeaveReason::silence);
  if ((in.state == SessionState::receiving || in.state == SessionState::live) &&
      now >= in.current->exchange.heard_at() + in.options.silence)
    in.close(SessionEvent::silent, LeaveReason::silence);
}

Result<void> SessionClient::submit(std::uint64_t now, const DeviceSample& sample,
                                   const std::optional<DeviceContact>& contact) noexcept {
  Impl& in = *impl_;
  if (in.state != SessionState::live || !in.current->device) return {};
  Epoch& epoch = *in.current;
  const auto rate = static_cast<std::uint64_t>(epoch.exchange.sender->scene()->tick_rate);
  const auto tick = static_cast<std::int64_t>((now - epoch.device_start) * rate / 1'000'000);
  if (tick <= epoch.device_tick) return {};
  std::array<std::int32_t, 3> position{};
  std::array<std::int32_t, 4> turn{};
  const std::uint8_t exponent = epoch.exchange.sender->scene()->grid.position;
  const RuleName broken = is_finite(sample.velocity) ? quantise({sample.position, sample.orientation}, exponent, position, turn)
                                                     : RuleName("R-API-1");
  TACTUS_CHECK(epoch.exchange.submit(now, tick, epoch.device->of(tick, sample, contact)));
  epoch.device_tick = tick;
  in.feels = contact.has_value();
  if (sample.buttons != in.buttons.mask) {
    in.buttons = {static_cast<std::uint32_t>(tick), sample.buttons};
    in.buttons_wait = true;
    in.buttons_number = 0;
    in.buttons_at = now;
  }
  if (broken) return fail(Errc::invalid_argument, broken);
  return {};
}

void SessionClient::set_viewpoint(const Vec3& viewpoint) noexcept {
  std::array<std::int32_t, 3> view{};
  const std::array from{viewpoint.x, viewpoint.y, viewpoint.z};
  for (std::size_t i = 0; i < 3; ++i)
    if (!quantise(from[i], ReportPart::kViewExponent, 2147483647.0, view[i])) return;
  impl_->view = view;
}

std::optional<std::span<const std::uint8_t>> SessionClient::poll_datagram(std::uint64_t now) noexcept {
  Impl& in = *impl_;
  if (in.leaves > 0) {
    --in.leaves;
    return in.writer.write(Leave{in.leaving}, in.current->exchange.epoch());
  }
  if (in.state == SessionState::closed) return std::nullopt;
  const bool joins = in.state == SessionState::joining;
  if (now >= (joins ? in.join_at : in.rejoin_due())) {
    if (!joins && !std::exchange(in.rejoins, true)) in.retry = kRejoin;
    in.join_at = now + in.retry;
    in.retry = std::min((joins ? 3 : 4) * in.retry / 2, kLastRetry);
    const DecodeLimits& limits = in.options.limits;
    return in.writer.write(Join{in.options.role, in.nonce, limits.state_bytes, limits.header_bytes, in.token, in.options.seat});
  }
  if (joins) return std::nullopt;
  const bool keep_alive = now >= in.keep_alive_due(), buttons = in.has_buttons_due(now);
  return in.current->exchange.poll(now, keep_alive || buttons, [&](DatagramWriter& writer, std::uint64_t number) {
    if (in.buttons_wait) {
      writer.add(in.buttons);
      in.buttons_at = now + kButtonsEvery;
      if (in.buttons_number == 0) in.buttons_number = number;
    }
    if (keep_alive && in.current->playout) writer.add(in.report(now));
    if (keep_alive) {
      writer.add(StatePart{static_cast<std::uint8_t>(in.state == SessionState::live ? 1 : 0)});
      if (in.state == SessionState::live && in.live_number == 0) in.live_number = number;
      in.keep_alive_at = now;
    }
    if (in.hash) writer.add(*in.hash);
    in.hash.reset();
    return keep_alive || in.buttons_wait;
  });
}

std::optional<ClientEvent> SessionClient::poll_event() noexcept {
  Impl& in = *impl_;
  if (in.next_event < in.event_count) return in.events[in.next_event++];
  in.next_event = in.event_count = 0;
  return std::nullopt;
}

std::optional<std::uint64_t> SessionClient::next_timeout() const noexcept {
  const Impl& in = *impl_;
  if (in.state == SessionState::closed) return std::nullopt;
  if (in.state == SessionState::joining) return std::min(in.join_at, in.opened_at + kJoinFor);
  std::uint64_t due = in.current->exchange.heard_at() + in.options.silence;
  due = std::min(due, in.rejoin_due());
  if (!in.current->exchange.sent().next()) return due;  // there is no number left to send anything with
  due = std::min(due, in.keep_alive_due());
  if (in.buttons_wait) due = std::min(due, in.current->exchange.next_send(in.buttons_at));
  if (const auto acknowledgement = in.current->exchange.due()) due = std::min(due, *acknowledgement);
  return due;
}

Receiver* SessionClient::receiver() noexcept {
  if (impl_->shown) return &*impl_->shown->exchange.receiver;
  return impl_->current && impl_->current->exchange.receiver ? &*impl_->current->exchange.receiver : nullptr;
}

std::int64_t SessionClient::shown_tick(std::uint64_t now) noexcept {
  impl_->look(now);
  Epoch* const epoch = impl_->shown_epoch();
  if (epoch == nullptr || !epoch->playout) return -1;
  epoch->playout->waits(epoch->exchange.waits_since(now), now);
  return epoch->playout->shown(now);
}

/// The shortest delays up and down, and how much later than the fastest packet the tick is shown. No clock but the own one counts.
std::optional<std::uint64_t> SessionClient::round_trip_shown(std::uint64_t now) const noexcept {
  const Epoch* const epoch = impl_->shown_epoch();
  if (epoch == nullptr || !epoch->playout) return std::nullopt;
  const auto& trip = epoch->exchange.sent().round_trip();
  if (!trip) return std::nullopt;
  const std::int64_t behind =
      epoch->playout->behind(now).value_or(epoch->playout->delay());  // before the first packet: as it will be
  return static_cast<std::uint64_t>(std::max<std::int64_t>(0, behind + trip->least));
}

/// Without news none; nor for a state that is ahead of all news, or too old whatever came.
double SessionClient::force_fraction(std::uint64_t now) noexcept {
  Impl& in = *impl_;
  shown_tick(now);  // of it the ages are
  if (!in.feels) in.fade.release(now);
  const bool is_live = in.state == SessionState::live;
  std::uint64_t heard = is_live ? in.current->exchange.heard_at() : 0;
  if (is_live) heard = std::min(heard, now - std::min(now, static_cast<std::uint64_t>(in.current->playout->ahead())));
  return std::ldexp(static_cast<double>(in.fade.fraction(now, heard, round_trip_shown(now).value_or(0))), -16);
}

std::uint64_t SessionClient::unanswered(std::uint64_t now) const noexcept {
  const bool runs = impl_->current != nullptr && impl_->state != SessionState::closed;
  return runs ? now - std::min(now, impl_->current->exchange.unanswered().value_or(now)) : 0;
}

SessionStatus SessionClient::status() const noexcept {
  const Impl& in = *impl_;
  SessionStatus out;
  out.state = in.state;
  out.clock_offset = in.offset.value();
  if (!in.current) return out;
  const Epoch& epoch = *in.current;
  out.client = epoch.welcome.client;
  out.seat = in.seat;
  out.world = epoch.welcome.world;
  out.token = in.token;
  out.declaration = epoch.pieces.size();
  out.received = std::min(epoch.pieces.received(), out.declaration);
  out.start = epoch.welcome.start;
  out.round_trip = epoch.exchange.sent().round_trip();
  out.playout_delay = epoch.playout ? epoch.playout->delay() : 0;
  out.loss = std::ldexp(epoch.exchange.sent().loss(), -16);
  out.traffic = epoch.exchange.traffic();
  return out;
}

}  // namespace tactus
