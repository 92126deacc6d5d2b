// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/server_connection.h>

#include <algorithm>
#include <cmath>

#include <tactus/base/fixed.h>
#include <tactus/base/rule.h>

namespace tactus {
namespace {

constexpr std::uint64_t kWelcomeEvery = 250'000;                             // [us] of a new epoch, until the client has heard
constexpr std::uint64_t kClockEvery = 100'000, kDrivenClockEvery = 500'000;  // [us]
constexpr std::uint64_t kPieceLag = 2'000;                                   // [us] of pieces that may be made up for
constexpr std::uint64_t kJammedEvery = 50'000;                               // [us]: packets through a long queue
constexpr std::uint64_t kUnvalidated = 10'000'000;                           // [us] for the first datagram in the epoch
constexpr unsigned kMostFaults = 100;
constexpr unsigned kLeaves = 3;  // one of them should arrive

}  // namespace

ServerConnection::ServerConnection(std::uint16_t client, const SessionServerOptions& options, std::uint64_t& pieces_at) noexcept
    : client_(client),
      loss_(options.loss),
      trusts_(options.addresses_are_validated),
      works_elsewhere_(options.works_elsewhere),
      silence_(options.silence),
      headers_(options.headers),
      piece_time_(options.rate == 0 ? 0 : 8'000'000 * (kLargestDatagram + options.headers) / options.rate),
      max_bound_scale_(options.max_bound_scale),
      most_rate_(options.rate),
      bucket_(options.rate),
      congestion_(options.max_bound_scale),
      pieces_at_(pieces_at) {}

void ServerConnection::open(std::uint64_t peer, const Join& message, const ServedScene& served, std::uint64_t epoch,
                            std::uint64_t now) noexcept {
  state_ = *next_state(server_transitions(), SessionState::closed, SessionEvent::open);
  peer_ = peer;
  join_ = message;
  validated_ = repeats_welcome_ = outdated_ = false;
  left_.reset();
  leaves_ = faults_ = 0;
  wrong_states_ = 0;
  congestion_ = Congestion(max_bound_scale_);
  welcome_.serial = 0;
  token_ = epoch;
  seat_ = 0;
  begin_epoch(served, epoch, now);
}

void ServerConnection::begin_epoch(const ServedScene& served, std::uint64_t epoch, std::uint64_t now) noexcept {
  const bool replaces = validated_;
  outdated_ = false;
  state_ = next_state(server_transitions(), state_, SessionEvent::replaced).value_or(state_);
  served_ = served;
  welcome_ = {.nonce = join_.nonce,
              .serial = replaces ? welcome_.serial + 1 : 0,
              .epoch = epoch,
              .client = client_,
              .size = served.declaration->size(),
              .hash = served.hash,
              .start = served.start,
              .world = served.world};
  if (works_elsewhere_ && exchange_ && exchange_->sender) old_ = std::move(exchange_->sender);
  parts_ = Parts::none;
  exchange_.emplace(Direction::down, epoch, now);
  exchange_->pieces.emplace(served.declaration, piece_time_);
  repeats_welcome_ = replaces;
  welcome_at_ = clock_at_ = piece_at_ = now;
  hashes_ = {};
  held_ = false;
  device_clock_.reset();
  mapping_.reset();
  next_tick_ = 0;
  buttons_ = {};
  playout_ = 0;
  view_.reset();
  seat(seat_);
  seat_waits_ = seat_ != 0;
}

void ServerConnection::seat(std::uint8_t seat) noexcept {
  seat_waits_ = seat_waits_ || seat != seat_;
  seat_ = seat;
  seat_at_ = seat_number_ = 0;
}

bool ServerConnection::leave(SessionEvent event, LeaveReason reason) noexcept {
  const auto next = next_state(server_transitions(), state_, event);
  if (!next) return false;
  state_ = *next;
  leaving_ = reason;
  leaves_ = event != SessionEvent::left && validated_ ? kLeaves : 0;
  if (leaves_ == 0) peer_ = 0;
  return true;
}

bool ServerConnection::is_mine(std::span<const std::uint8_t> datagram) const noexcept {
  return state_ != SessionState::closed && !is_before_epochs(datagram) &&
         is_of_epoch(datagram, exchange_->epoch(), Direction::up);
}

bool ServerConnection::is_at_fault() const noexcept { return faults_ >= kMostFaults; }

bool ServerConnection::is_silent(std::uint64_t now) const noexcept {
  return state_ != SessionState::closed && now >= exchange_->heard_at() + (validated_ ? silence_ : kUnvalidated);
}

Result<void> ServerConnection::handle_datagram(std::uint64_t now, std::span<const std::uint8_t> datagram) noexcept {
  auto message = read_datagram(datagram, Direction::up);
  if (message) validated_ = true;
  if (!message) {
    ++faults_;
    return tl::unexpected(message.error());
  }
  if (const auto* leave = std::get_if<Leave>(&*message)) {
    left_ = leave->reason;
    return {};
  }
  const Numbered& numbered = std::get<Numbered>(*message);
  repeats_welcome_ = false;
  const auto heard = exchange_->handle(now, numbered, [&](const Part& part, const auto&) { return handle(part, now); });
  if (!heard) {
    const bool may_be_late = heard.error().code == Errc::state || heard.error().rule == std::string_view("R-SES-6");
    if (!may_be_late) ++faults_;
    return tl::unexpected(heard.error());
  }
  if (heard->round_trip) measured(*heard->round_trip, now);
  if (device_clock_) device_clock_->heard(heard->number, heard->tick, now);
  if (device_clock_ && heard->round_trip) device_clock_->measured(*heard->round_trip, now);
  if (mapping_ && heard->tick) mapping_->heard(*heard->tick);
  const std::uint64_t newest = exchange_->sent().highest_acknowledged();
  if (mapping_) mapping_->acknowledged(newest);
  if (seat_number_ > 0 && newest >= seat_number_) seat_waits_ = false;  // all since the first have it
  return {};
}

/// in  sample  [us] a round trip
void ServerConnection::measured(std::int64_t sample, std::uint64_t now) noexcept {
  const RoundTrip& trip = *exchange_->sent().round_trip();
  line_.round_trip(trip, sample, exchange_->sent().highest_acknowledged(), now);
  congestion_.answered();
}

Result<void> ServerConnection::handle(const Part& part, std::uint64_t now) noexcept {
  if (const auto* state = std::get_if<StatePart>(&part)) {
    if (state->live != 0 && exchange_->pieces) return go_live(now);
  } else if (const auto* buttons = std::get_if<ButtonsPart>(&part)) {
    if (buttons->tick >= buttons_.tick) buttons_ = *buttons;
  } else if (const auto* hash = std::get_if<HashPart>(&part)) {
    compare(*hash);
  } else if (const auto* report = std::get_if<ReportPart>(&part)) {
    take(*report, now);
  }
  return {};
}

void ServerConnection::take(const ReportPart& report, std::uint64_t now) noexcept {
  constexpr std::uint64_t kLongest = 2'000;  // [ms]: no copy comes later
  playout_ = 1000 * std::min(report.delay, kLongest);
  exchange_->set_playout(playout_);
  if ((report.flags & ReportPart::kKey) != 0) exchange_->want_key(now);
  const auto metres = [](std::int32_t c) { return std::ldexp(c, -ReportPart::kViewExponent); };
  if ((report.flags & ReportPart::kView) != 0) view_ = {metres(report.view[0]), metres(report.view[1]), metres(report.view[2])};
}

/// From where the client looks, in a scene with interest: a participant from its device at least, as soon as that is known.
void ServerConnection::look() noexcept {
  if (!served_.scene->interest || (!view_ && join_.role == Role::observer)) return;
  std::array<Vec3, 2> viewpoints;
  std::size_t count = 0;
  if (view_) viewpoints[count++] = *view_;
  if (exchange_->receiver && exchange_->receiver->tick(0) > 0) {
    const RigidState& device = exchange_->receiver->object(0);
    viewpoints[count++] = to_pose({device.position, device.rotation}, served_.device->grid.position).position;
  }
  exchange_->sender->set_viewpoints(std::span(viewpoints).first(count));
}

/// Before it is live a client knows only a delay that its user has fixed: it must be long enough for a copy.
bool ServerConnection::repairs() const noexcept {
  constexpr std::int64_t kCopies = 60'000;  // [us]
  if (loss_ != LossPolicy::by_role) return loss_ == LossPolicy::repair;
  const std::int64_t trip = exchange_->sent().round_trip() ? exchange_->sent().round_trip()->least : 0;
  return join_.role == Role::observer && (playout_ == 0 || static_cast<std::int64_t>(playout_) >= 2 * trip + kCopies);
}

Result<void> ClientParts::make() {
  if (device && scene->has_paths()) path = std::make_shared<DevicePath>(device);
  TACTUS_TRY(sender, Sender::create(scene, options, truth, path));
  if (device) {
    TACTUS_TRY(receiver, Receiver::create(device));
  }
  return {};
}

ClientParts ServerConnection::parts() const noexcept {
  ClientParts out{.client = client_,
                  .epoch = welcome_.epoch,
                  .scene = served_.scene,
                  .device = join_.role == Role::participant ? served_.device : nullptr,
                  .truth = served_.truth,
                  .options = served_.sender,
                  .repaired = repairs(),
                  .path = {},
                  .sender = {},
                  .receiver = {}};
  if (out.repaired) out.options.policy.baseline = Baseline::repaired;
  return out;
}

ClientParts ServerConnection::ask_parts() noexcept {
  parts_ = Parts::asked;
  return parts();
}

/// The client holds the declaration: from the next tick on it gets packets, and may send those of its device.
Result<void> ServerConnection::go_live(std::uint64_t now) noexcept try {
  if (!next_state(server_transitions(), state_, SessionEvent::completed)) return {};
  if (works_elsewhere_) {
    if (parts_ == Parts::none) parts_ = Parts::wanted;
    return {};
  }
  ClientParts made = parts();
  TACTUS_CHECK(made.make());
  take(now, made);
  return {};
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

bool ServerConnection::take(std::uint64_t now, ClientParts& parts) {
  const auto next = next_state(server_transitions(), state_, SessionEvent::completed);
  if (!next || parts.epoch != welcome_.epoch || !exchange_->pieces) return false;
  parts_ = Parts::none;
  exchange_->send_with(std::move(*parts.sender), parts.repaired);
  signals_baselines_ = !parts.repaired;
  baselines_number_ = 0;
  congestion_.begin(now);
  line_.begin(now);
  bucket_.set_rate(most_rate_, now);
  if (parts.receiver) {
    exchange_->receive_with(std::move(*parts.receiver));
    const auto& limits = served_.scene->has_paths() ? ForceFade::kDriven : ForceFade::kUsual;
    device_clock_.emplace(served_.scene->tick_rate, PlayoutOptions{.fixed = 0}, static_cast<std::int64_t>(limits.stale));
    exchange_->path = std::move(parts.path);
    if (exchange_->path) mapping_.emplace(served_.scene->tick_rate);
  }
  exchange_->pieces.reset();
  state_ = *next;
  return true;
}

void ServerConnection::compare(const HashPart& received) noexcept {
  const std::uint64_t newest = exchange_->sent().newest();
  const std::uint64_t back = static_cast<std::uint16_t>(newest - received.number);
  for (const KnownHash& known : hashes_) {
    if (known.number == 0 || known.substream != received.substream || known.number + back != newest) continue;
    if (known.hash == received.hash) return;
    ++wrong_states_;
    exchange_->sender->request_key();
    return;
  }
}

/// So that it can be compared with that of the client; unless others have taken the time, which comes again.
void ServerConnection::note_hash(const Packet& packet, std::size_t& hashes) noexcept {
  if (packet.number % kHashEvery != 0 || packet.layer != Layer::all) return;
  const std::size_t cost = packet.substream == 0 ? served_.scene->moving().size() : 0;
  if (cost > hashes) return;
  hashes -= cost;
  const auto hash = static_cast<std::uint32_t>(exchange_->sender->state_hash(packet.substream));
  hashes_[next_hash_++ % hashes_.size()] = {packet.substream, packet.number, hash};
}

bool ServerConnection::is_held(std::uint64_t now) noexcept {
  return !bucket_.is_open(now) || (line_.is_jammed() && now < exchange_->sent_at() + kJammedEvery);
}

Result<void> ServerConnection::submit(std::uint64_t now, std::int64_t tick, const Truth& truth, std::size_t& hashes) noexcept {
  next_tick_ = tick + 1;
  if (exchange_->path) exchange_->path->pass(tick);
  held_ = is_held(now);
  line_.tick(held_, now);
  if (line_.rate() > 0) bucket_.set_rate(most_rate_ == 0 ? line_.rate() : std::min(line_.rate(), most_rate_), now);
  else bucket_.set_rate(most_rate_, now);
  const bool shapes = std::ranges::any_of(truth.deformables, [](const auto& shape) { return !shape.displacements.empty(); });
  if (congestion_.tick(held_, shapes, now)) exchange_->sender->set_bound_scale(bound_scale());
  exchange_->set_waits(congestion_.waits());
  if (held_) {
    exchange_->hold_tick();
    return {};
  }
  look();
  TACTUS_TRY(const auto packets, exchange_->submit(now, tick, truth));
  for (const Packet& packet : packets) note_hash(packet, hashes);
  return {};
}

/// [us] When the next piece may go; nothing: there is none that may.
std::optional<std::uint64_t> ServerConnection::piece_due() const noexcept {
  if (!(validated_ || trusts_) || !exchange_->pieces || !exchange_->pieces->next()) return std::nullopt;
  return exchange_->next_send(std::max(piece_at_, pieces_at_));
}

bool ServerConnection::wants_welcome(std::uint64_t now) const noexcept {
  return repeats_welcome_ && state_ == SessionState::receiving && now >= welcome_at_;
}

std::optional<std::span<const std::uint8_t>> ServerConnection::poll(std::uint64_t now) noexcept {
  if (leaves_ > 0) {
    const auto datagram = writer_.write(Leave{leaving_}, exchange_->epoch());
    --leaves_;
    return datagram;
  }
  if (state_ == SessionState::closed) {
    peer_ = 0;
    return std::nullopt;
  }
  if (wants_welcome(now)) {
    welcome_at_ = now + kWelcomeEvery;
    return writer_.write(welcome_);
  }
  if (held_) return std::nullopt;  // an acknowledgement would mean that what the client has is new
  exchange_->expire_pieces(now);
  const bool piece = piece_due().value_or(now + 1) <= now;
  const bool wanted = piece || wants_mapping(now) || wants_seat(now);
  const auto datagram = exchange_->poll(now, wanted, [&](DatagramWriter& writer, std::uint64_t number) {
    if (served_.shift && now >= clock_at_ && !writer.empty()) {  // together with an acknowledgement
      writer.add(ClockPart{clock_to_send(now)});
      clock_at_ = now + (exchange_->path ? kDrivenClockEvery : kClockEvery);
    }
    const bool mapping = mapping_ && mapping_->waits();
    if (mapping) {
      mapping_->send(writer, number);
      mapping_at_ = now + exchange_->ack_timeout();
    }
    if (piece) add_piece(writer, number, now);
    if (seat_waits_) add_seat(writer, number, now);
    const bool baselines = signal_baselines(writer, number);
    return mapping || piece || seat_waits_ || baselines;
  });
  if (datagram) line_.sent(exchange_->sent().newest(), datagram->size() + headers_, now);
  if (datagram && !piece) bucket_.take(static_cast<std::int64_t>(8 * (datagram->size() + headers_)), now);
  return datagram;
}

/// Each datagram has it until one has arrived.   out  true: this one has it
bool ServerConnection::signal_baselines(DatagramWriter& writer, std::uint64_t number) noexcept {
  if (baselines_number_ > 0 && exchange_->sent().highest_acknowledged() >= baselines_number_) signals_baselines_ = false;
  if (!signals_baselines_ || state_ != SessionState::live || !writer.add(BaselinesPart{1})) return false;
  if (baselines_number_ == 0) baselines_number_ = number;
  return true;
}

/// Not far beyond the ticks that were made: a world that pauses is not signalled to go on.   pre  there was a tick
std::uint64_t ServerConnection::clock_to_send(std::uint64_t now) const noexcept {
  constexpr std::uint64_t kBeyond = 20'000;  // [us]: ticks come unevenly
  const std::uint64_t time = now - static_cast<std::uint64_t>(*served_.shift);
  if (next_tick_ == 0) return time;  // it gets no ticks yet
  const auto end = static_cast<std::uint64_t>(next_tick_ + 1), rate = std::uint64_t{served_.scene->tick_rate};
  return std::min(time, served_.start + end / rate * 1'000'000 + end % rate * 1'000'000 / rate + kBeyond);
}

/// pre  there is one
void ServerConnection::add_piece(DatagramWriter& writer, std::uint64_t number, std::uint64_t now) noexcept {
  if (!exchange_->add_piece(writer, number, now)) return;
  const auto next = [now](std::uint64_t at, std::uint64_t gap) { return std::max(at + kPieceLag, now) - kPieceLag + gap; };
  piece_at_ = next(piece_at_, exchange_->pieces->pacer.gap());
  pieces_at_ = next(pieces_at_, LinePacer::kLeastGap);
}

void ServerConnection::add_seat(DatagramWriter& writer, std::uint64_t number, std::uint64_t now) noexcept {
  writer.add(SeatPart{seat_});
  seat_at_ = now + exchange_->ack_timeout();
  if (seat_number_ == 0) seat_number_ = number;
}

std::optional<std::uint64_t> ServerConnection::next_timeout() const noexcept {
  if (state_ == SessionState::closed) return std::nullopt;
  std::uint64_t due = exchange_->heard_at() + (validated_ ? silence_ : kUnvalidated);
  if (repeats_welcome_ && state_ == SessionState::receiving) due = std::min(due, welcome_at_);
  if (held_ || !exchange_->sent().next()) return due;  // nothing else may be sent, or there is no number left
  if (const auto acknowledgement = exchange_->due()) due = std::min(due, *acknowledgement);
  if (mapping_ && mapping_->waits()) due = std::min(due, mapping_at_);
  if (seat_waits_) due = std::min(due, seat_at_);
  if (const auto piece = piece_due()) due = std::min(due, *piece);
  if (const auto lost = exchange_->pieces_due()) due = std::min(due, *lost);
  return due;
}

std::optional<DeviceSample> ServerConnection::device(std::uint64_t now) noexcept {
  if (state_ != SessionState::live || !device_clock_) return std::nullopt;
  if (mapping_ && next_tick_ > 0) return driving_device(now);  // before the first submit() the tick is not known
  const std::int64_t tick = device_clock_->shown(now);
  if (tick < 0) return std::nullopt;
  return device_at(*exchange_->receiver, tick, buttons_.mask);
}

/// In the tick that is simulated next, as the client will know it.
std::optional<DeviceSample> ServerConnection::driving_device(std::uint64_t now) noexcept {
  DevicePath& path = *exchange_->path;
  if (const std::int64_t device = device_clock_->shown(now); device >= 0)
    if (const auto change = mapping_->step(next_tick_, device)) path.shift(change->from, change->offset);
  path.pass(next_tick_);
  const auto found = path.state_at(next_tick_);
  if (!found) return std::nullopt;
  return device_of(*path.scene(), found->state, found->tick, buttons_.mask);
}

ClientStatus ServerConnection::status() const noexcept {
  ClientStatus out{.client = client_,
                   .peer = peer_,
                   .state = state_,
                   .role = join_.role,
                   .seat = seat_,
                   .wanted_seat = join_.seat,
                   .heard = 0,
                   .round_trip = {},
                   .loss = 0,
                   .bound_scale = bound_scale(),
                   .bound_scaling = congestion_.so_far(),
                   .traffic = {}};
  if (!exchange_) return out;
  out.heard = exchange_->heard_at();
  out.round_trip = exchange_->sent().round_trip();
  out.loss = std::ldexp(exchange_->sent().loss(), -16);
  out.traffic = exchange_->traffic();
  out.traffic.wrong_states = wrong_states_;
  return out;
}

}  // namespace tactus
