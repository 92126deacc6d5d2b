// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/server_connection.h>

#include <algorithm>
#include <cmath>

#include <tactus/base/out_of_memory.h>
#include <tactus/base/rule.h>

namespace tactus {
namespace {

constexpr std::uint64_t kWelcomeEvery = 250'000;  // [us] of a new epoch, until the client has heard
constexpr std::uint64_t kClockEvery = 100'000;    // [us]
constexpr std::uint64_t kPieceEvery = 500;        // [us]: 16 Mbit/s
constexpr std::uint64_t kUnproven = 10'000'000;   // [us] for the first datagram in the epoch
constexpr unsigned kMostFaults = 100;
constexpr unsigned kLeaves = 3;         // one of them should arrive
constexpr std::uint64_t kHeaders = 28;  // [bytes] of UDP and IPv4

}  // namespace

ServerConnection::ServerConnection(std::uint16_t client, const SessionServerOptions& options) noexcept
    : client_(client),
      silence_(options.silence),
      piece_time_(options.rate == 0 ? 0 : 8'000'000 * (kLargestDatagram + kHeaders) / options.rate),
      bucket_(options.rate) {}

void ServerConnection::open(std::uint64_t peer, const Join& said, const ServedScene& served, std::uint64_t epoch,
                            std::uint64_t now) noexcept {
  state_ = *next_state(server_transitions(), SessionState::closed, SessionEvent::open);
  peer_ = peer;
  join_ = said;
  proven_ = repeats_welcome_ = outdated_ = false;
  left_.reset();
  leaves_ = faults_ = 0;
  welcome_.serial = 0;
  begin_epoch(served, epoch, now);
}

void ServerConnection::begin_epoch(const ServedScene& served, std::uint64_t epoch, std::uint64_t now) noexcept {
  const bool replaces = proven_;
  outdated_ = false;
  state_ = next_state(server_transitions(), state_, SessionEvent::replaced).value_or(state_);
  served_ = served;
  welcome_ = {.nonce = join_.nonce,
              .serial = replaces ? welcome_.serial + 1 : 0,
              .epoch = epoch,
              .client = client_,
              .size = served.declaration->size(),
              .hash = served.hash,
              .start = served.start};
  exchange_.emplace(Direction::down, epoch, now);
  exchange_->pieces.emplace(served.declaration);
  repeats_welcome_ = replaces;
  welcome_at_ = clock_at_ = piece_at_ = now;
  hashes_ = {};
  device_clock_.reset();
  buttons_ = {};
}

bool ServerConnection::leave(SessionEvent event, LeaveReason reason) noexcept {
  const auto next = next_state(server_transitions(), state_, event);
  if (!next) return false;
  state_ = *next;
  leaving_ = reason;
  leaves_ = event != SessionEvent::left && proven_ ? kLeaves : 0;
  if (leaves_ == 0) peer_ = 0;
  return true;
}

bool ServerConnection::is_mine(std::span<const std::uint8_t> datagram) const noexcept {
  return state_ != SessionState::closed && is_of_epoch(datagram, exchange_->epoch(), Direction::up);
}

bool ServerConnection::is_at_fault() const noexcept { return faults_ >= kMostFaults; }

bool ServerConnection::is_silent(std::uint64_t now) const noexcept {
  return state_ != SessionState::closed && now >= exchange_->heard_at() + (proven_ ? silence_ : kUnproven);
}

Result<void> ServerConnection::handle_datagram(std::uint64_t now, std::span<const std::uint8_t> datagram) noexcept {
  auto said = read_datagram(datagram, Direction::up);
  if (said) proven_ = true;
  if (!said) {
    ++faults_;
    return tl::unexpected(said.error());
  }
  if (const auto* leave = std::get_if<Leave>(&*said)) {
    left_ = leave->reason;
    return {};
  }
  const auto* numbered = std::get_if<Numbered>(&*said);
  if (numbered == nullptr) return fail(Errc::invalid, "R-SES-2");  // a join belongs to no epoch
  repeats_welcome_ = false;
  const auto heard = exchange_->handle(now, *numbered, [&](const Part& part, const auto&) { return handle(part, now); });
  if (!heard) {
    if (heard.error().code != Errc::state) ++faults_;
    return tl::unexpected(heard.error());
  }
  if (heard->tick && device_clock_) device_clock_->heard(*heard->tick, now);
  return {};
}

Result<void> ServerConnection::handle(const Part& part, std::uint64_t now) noexcept {
  static_cast<void>(now);
  if (const auto* state = std::get_if<StatePart>(&part)) {
    if (state->live != 0 && exchange_->pieces && exchange_->pieces->is_done()) return go_live();
  } else if (const auto* buttons = std::get_if<ButtonsPart>(&part)) {
    if (buttons->tick >= buttons_.tick) buttons_ = *buttons;
  } else if (const auto* hash = std::get_if<HashPart>(&part)) {
    compare(*hash);
  }
  return {};
}

/// The client holds the declaration: from the next tick on it gets packets, and may send those of its device.
Result<void> ServerConnection::go_live() noexcept {
  const auto next = next_state(server_transitions(), state_, SessionEvent::completed);
  if (!next) return {};
  TACTUS_TRY(exchange_->sender, Sender::create(served_.scene, served_.sender));
  if (join_.role == Role::participant) {
    TACTUS_TRY(exchange_->receiver, Receiver::create(served_.device));
    device_clock_.emplace(served_.scene->tick_rate, PlayoutOptions{.fixed = 0});
  }
  exchange_->pieces.reset();
  state_ = *next;
  return {};
}

void ServerConnection::compare(const HashPart& said) noexcept {
  for (const KnownHash& known : hashes_) {
    if (known.number == 0 || known.substream != said.substream || static_cast<std::uint16_t>(known.number) != said.number)
      continue;
    if (known.hash == said.hash) return;
    ++wrong_states_;
    exchange_->sender->request_key();
    return;
  }
}

Result<void> ServerConnection::submit(std::uint64_t now, std::int64_t tick, const Truth& truth) noexcept {
  if (!bucket_.is_open(now)) {
    exchange_->hold_tick();
    return {};
  }
  TACTUS_TRY(const auto packets, exchange_->submit(now, tick, truth));
  for (const Packet& packet : packets) {
    if (packet.number % kHashEvery != 0 || packet.layer != Layer::all) continue;
    const auto hash = static_cast<std::uint32_t>(exchange_->sender->state_hash(packet.substream));
    hashes_[next_hash_++ % hashes_.size()] = {packet.substream, packet.number, hash};
  }
  return {};
}

bool ServerConnection::wants_piece(std::uint64_t now) const noexcept {
  return proven_ && exchange_->pieces && now >= piece_at_ && exchange_->may_send(now) &&
         exchange_->pieces->next(now, exchange_->patience()).has_value();
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
  const bool piece = wants_piece(now);
  const auto datagram = exchange_->poll(now, piece, [&](DatagramWriter& writer, std::uint64_t number) {
    if (now >= clock_at_ && !writer.empty()) {  // together with an acknowledgement
      writer.add(ClockPart{now});
      clock_at_ = now + kClockEvery;
    }
    if (!piece) return false;
    const std::uint64_t index = *exchange_->pieces->next(now, exchange_->patience());
    if (!writer.add(PiecePart{index, exchange_->pieces->bytes(index)})) return false;
    exchange_->pieces->sent(index, number, now);
    piece_at_ = now + std::max(kPieceEvery, piece_time_);
    return true;
  });
  if (datagram && !piece) bucket_.take(static_cast<std::int64_t>(8 * (datagram->size() + kHeaders)));
  return datagram;
}

std::optional<std::uint64_t> ServerConnection::next_timeout() const noexcept {
  if (state_ == SessionState::closed) return std::nullopt;
  std::uint64_t due = exchange_->heard_at() + (proven_ ? silence_ : kUnproven);
  if (const auto acknowledgement = exchange_->due()) due = std::min(due, *acknowledgement);
  if (repeats_welcome_ && state_ == SessionState::receiving) due = std::min(due, welcome_at_);
  if (proven_ && exchange_->pieces) {
    if (exchange_->pieces->next(piece_at_, exchange_->patience())) due = std::min(due, piece_at_);
    else if (const auto lost = exchange_->pieces->due(exchange_->patience())) due = std::min(due, *lost);
  }
  return due;
}

std::optional<DeviceSample> ServerConnection::device(std::uint64_t now) noexcept {
  if (state_ != SessionState::live || !device_clock_) return std::nullopt;
  const std::int64_t tick = device_clock_->shown(now);
  if (tick < 0) return std::nullopt;
  return device_at(*exchange_->receiver, tick, buttons_.mask);
}

ClientStatus ServerConnection::status() const noexcept {
  ClientStatus out{
      .client = client_, .peer = peer_, .state = state_, .role = join_.role, .round_trip = {}, .loss = 0, .traffic = {}};
  if (!exchange_) return out;
  out.round_trip = exchange_->sent().round_trip();
  out.loss = std::ldexp(exchange_->sent().loss(), -16);
  out.traffic = exchange_->traffic();
  out.traffic.wrong_states = wrong_states_;
  return out;
}

}  // namespace tactus
