// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/session_server.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <vector>

#include <tactus/base/bytes.h>
#include <tactus/base/rule.h>
#include <tactus/scene/scene_builder.h>
#include <tactus/scene/scene_syntax.h>
#include <tactus/session/server_connection.h>

namespace tactus {

struct SessionServer::Impl {
  Result<void> serve(SharedScene of, std::uint64_t now);
  Result<void> join(std::uint64_t now, std::uint64_t peer, const Join& message) noexcept;
  void keep_time(std::uint64_t now, std::int64_t tick) noexcept;
  ServerConnection* find(std::uint64_t peer) noexcept;
  ServerConnection* follow(std::uint64_t peer, std::uint64_t token) noexcept;
  void note(ServerEvent event) noexcept {
    if (events.size() < events.capacity()) events.push_back(event);
  }
  void drop(ServerConnection& connection, SessionEvent event, LeaveReason reason) noexcept;
  Result<Welcome> answer(std::uint64_t now, std::uint64_t peer, const Join& message) noexcept;

  SessionServerOptions options;
  ServedScene served;
  std::uint64_t entropy = 0;
  bool leaves_out = false;      // the last tick, as nobody was live
  std::uint64_t pieces_at = 0;  // [us] when the next piece of a declaration may go to anybody
  std::vector<std::unique_ptr<ServerConnection>> connections;
  std::vector<std::uint64_t> peers;   // of each, or that it had: close together, as each datagram looks through them
  std::size_t first = 0, cursor = 0;  // of poll_datagram()
  std::vector<ServerEvent> events;
  std::size_t next_event = 0;
  DatagramWriter writer{Direction::down};
  std::optional<std::pair<std::uint64_t, Datagram>> reply;  // to an address, outside of any epoch
};

constexpr double kQuiet = 1;  // [s] without a packet of the rigid objects
constexpr std::size_t kMostHashed =
    16'384;  // objects of a scene whose states are compared with those of clients: a hash takes 50 ns each
constexpr std::size_t kHashedObjects = 4096;  // in a tick: 0.2 ms

/// SplitMix64: epochs that differ and that strangers cannot guess, if they cannot guess the seed.
static std::uint64_t draw(std::uint64_t& state) noexcept {
  state += 0x9E3779B97F4A7C15u;
  std::uint64_t z = state;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  z ^= z >> 31;
  return z == 0 ? 1 : z;
}

SessionServer::SessionServer(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
SessionServer::SessionServer(SessionServer&&) noexcept = default;
SessionServer& SessionServer::operator=(SessionServer&&) noexcept = default;
SessionServer::~SessionServer() = default;

Result<SessionServer> SessionServer::create(SharedScene scene, const SessionServerOptions& options, std::uint64_t entropy,
                                            std::uint64_t now) try {
  const bool scales = options.max_bound_scale >= 1 && options.max_bound_scale <= 64;  // false for NaN
  if (options.clients == 0 || options.rate > 1'000'000'000'000 || !scales) return fail(Errc::invalid_argument, "R-API-4");
  auto impl = std::make_unique<Impl>();
  impl->options = options;
  impl->options.sender.policy.baseline = Baseline::acknowledged;
  impl->options.sender.policy.key_interval = 0;
  impl->options.sender.triggers.heartbeat = 0;  // who has acknowledged a state need not hear it again
  impl->options.sender.policy.silence = kQuiet;
  impl->entropy = entropy;
  for (std::uint16_t i = 0; i < options.clients; ++i)
    impl->connections.push_back(std::make_unique<ServerConnection>(i, options, impl->pieces_at));
  impl->peers.resize(options.clients);
  impl->events.reserve(8 * std::size_t{options.clients} + 8);
  TACTUS_CHECK(impl->serve(std::move(scene), now));
  return SessionServer(std::move(impl));
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

Result<void> SessionServer::Impl::serve(SharedScene of, std::uint64_t now) {
  TACTUS_TRY(auto truth, SharedTruth::create(of, options.sender));
  TACTUS_CHECK(Sender::create(of, options.sender, truth));  // so that no client meets a scene that cannot be sent
  TACTUS_TRY(auto declaration, write_scene(*of));
  TACTUS_TRY(auto device, device_scene(*of));
  Fnv1a hash;
  for (const std::uint8_t byte : declaration) hash.add_byte(byte);
  served = {.scene = std::move(of),
            .device = std::move(device),
            .truth = std::move(truth),
            .declaration = std::make_shared<const std::vector<std::uint8_t>>(std::move(declaration)),
            .hash = hash.value(),
            .start = now,
            .world = options.world,
            .shift = {},
            .sender = options.sender};
  return {};
}

Result<void> SessionServer::replace_scene(SharedScene scene, std::uint64_t now) try {
  TACTUS_CHECK(impl_->serve(std::move(scene), now));
  for (auto& connection : impl_->connections) {
    if (connection->state() == SessionState::closed) continue;
    if (!impl_->served.fits(connection->join())) impl_->drop(*connection, SessionEvent::close, LeaveReason::limits);
    else if (connection->is_validated()) connection->begin_epoch(impl_->served, draw(impl_->entropy), now);
    else connection->outdate();
  }
  return {};
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

/// The session of this address, or else one that is closed and whose leaves still go there.
ServerConnection* SessionServer::Impl::find(std::uint64_t peer) noexcept {
  ServerConnection* closed = nullptr;
  for (std::size_t i = 0; i < peers.size(); ++i) {
    if (peers[i] != peer || connections[i]->peer() != peer) continue;
    if (connections[i]->state() != SessionState::closed) return connections[i].get();
    if (closed == nullptr) closed = connections[i].get();
  }
  return closed;
}

void SessionServer::Impl::drop(ServerConnection& connection, SessionEvent event, LeaveReason reason) noexcept {
  if (!connection.leave(event, reason)) return;
  note({.kind = ServerEvent::Kind::left, .client = connection.client(), .reason = reason});
}

/// The session of this address, or of this token, which is at this address from now on; null: there is none.
ServerConnection* SessionServer::Impl::follow(std::uint64_t peer, std::uint64_t token) noexcept {
  ServerConnection* const here = find(peer);
  const auto known = std::ranges::find_if(
      connections, [token](const auto& c) { return token != 0 && c->token() == token && c->state() != SessionState::closed; });
  if (known == connections.end() || known->get() == here) return here;
  if (here != nullptr) drop(*here, SessionEvent::left, LeaveReason::bye);
  (*known)->move(peer);
  peers[(*known)->client()] = peer;
  return known->get();
}

/// A slot for the client, or why there is none.
Result<void> SessionServer::Impl::join(std::uint64_t now, std::uint64_t peer, const Join& message) noexcept {
  const auto refuse = [&](LeaveReason reason) {
    reply.emplace(peer, Refusal{message.nonce, reason});
    const bool is_again = !events.empty() && events.back().kind == ServerEvent::Kind::refused && events.back().reason == reason;
    if (!is_again)
      note({.kind = ServerEvent::Kind::refused, .client = options.clients, .reason = reason});  // a flood fills nothing
  };
  if (!message.is_known) {
    refuse(LeaveReason::version);
    return {};
  }
  const bool is_here = find(peer) != nullptr;
  ServerConnection* slot = follow(peer, message.token);
  if (slot != nullptr && slot->state() != SessionState::closed && slot->nonce() == message.nonce) {
    if (!is_here) note({.kind = ServerEvent::Kind::moved, .client = slot->client()});
    reply.emplace(peer, slot->welcome());
    return {};
  }
  if (slot != nullptr) drop(*slot, SessionEvent::left, LeaveReason::bye);  // the client has begun anew
  if (!served.fits(message)) {
    refuse(LeaveReason::limits);
    return {};
  }
  if (slot == nullptr) {
    const auto free = std::ranges::find_if(connections, [](const auto& c) { return c->is_free(); });
    if (free == connections.end()) {
      refuse(LeaveReason::full);
      return {};
    }
    slot = free->get();
  }
  slot->open(peer, message, served, draw(entropy), now);
  peers[slot->client()] = peer;
  reply.emplace(peer, slot->welcome());
  note({.kind = ServerEvent::Kind::joined, .client = slot->client()});
  return {};
}

Result<void> SessionServer::handle_datagram(std::uint64_t now, std::uint64_t peer,
                                            std::span<const std::uint8_t> datagram) noexcept {
  Impl& in = *impl_;
  ServerConnection* connection = in.find(peer);
  if (connection != nullptr && connection->is_mine(datagram)) {
    const SessionState before = connection->state();
    const auto handled = connection->handle_datagram(now, datagram);
    if (before == SessionState::receiving && connection->state() == SessionState::live)
      in.note({.kind = ServerEvent::Kind::live, .client = connection->client()});
    if (connection->has_left()) in.drop(*connection, SessionEvent::left, connection->leave_reason());
    if (connection->is_at_fault()) in.drop(*connection, SessionEvent::close, LeaveReason::protocol);
    if (connection->needs_epoch()) connection->begin_epoch(in.served, draw(in.entropy), now);
    return handled;
  }
  if (!is_before_epochs(datagram) || !is_of_epoch(datagram, 0, Direction::up)) return fail(Errc::checksum, "R-SES-1");
  TACTUS_TRY(const Datagram message, read_datagram(datagram, Direction::up));
  const Join* const join = std::get_if<Join>(&message);
  if (join == nullptr) return fail(Errc::invalid, "R-SES-2");
  return in.join(now, peer, *join);
}

void SessionServer::handle_timeout(std::uint64_t now) noexcept {
  for (auto& connection : impl_->connections)
    if (connection->is_silent(now)) impl_->drop(*connection, SessionEvent::silent, LeaveReason::silence);
}

/// Clients are sent a clock by which tick n is at `start` + n ticks, whenever the program began and however long it paused.
void SessionServer::Impl::keep_time(std::uint64_t now, std::int64_t tick) noexcept {
  constexpr std::int64_t kPause = 100'000;  // [us]: less is unevenness of the ticks
  const std::int64_t rate = served.scene->tick_rate;
  const std::int64_t time = tick / rate * 1'000'000 + tick % rate * 1'000'000 / rate;
  const std::int64_t shift = static_cast<std::int64_t>(now - served.start) - time;
  if (served.shift && std::abs(shift - *served.shift) <= kPause) return;
  served.shift = shift;
  for (auto& connection : connections)
    if (!connection->is_outdated()) connection->shift(shift);
}

std::uint64_t SessionServer::clock(std::uint64_t now) const noexcept {
  return now - static_cast<std::uint64_t>(impl_->served.shift.value_or(0));
}

Result<void> SessionServer::submit(std::uint64_t now, std::int64_t tick, const Truth& truth) noexcept {
  impl_->keep_time(now, tick);
  const auto is_live = [](const auto& connection) { return connection->state() == SessionState::live; };
  if (std::ranges::none_of(impl_->connections, is_live)) {
    impl_->leaves_out = true;
    return {};
  }
  Truth submitted = truth;
  if (impl_->leaves_out) submitted.moved.reset();  // what moved since the last tick that was read is not known
  TACTUS_CHECK(impl_->served.truth->read(tick, submitted));
  impl_->leaves_out = false;
  Result<void> first;
  const std::size_t objects = impl_->served.scene->moving().size();
  std::size_t hashes = objects > kMostHashed ? 0 : std::max(kHashedObjects, objects);
  for (auto& connection : impl_->connections) {
    if (!is_live(connection)) continue;
    const double before = connection->bound_scale();
    if (const auto done = connection->submit(now, tick, truth, hashes); !done && first) first = done;
    if (connection->bound_scale() != before)
      impl_->note(
          {.kind = ServerEvent::Kind::bounds_scaled, .client = connection->client(), .bound_scale = connection->bound_scale()});
  }
  return first;
}

std::span<const HeldPart> SessionServer::held() const noexcept { return impl_->served.truth->held(); }

void SessionServer::seat(std::uint16_t client, std::uint8_t seat) noexcept { impl_->connections[client]->seat(seat); }

void SessionServer::close(std::uint16_t client, LeaveReason reason) noexcept {
  impl_->drop(*impl_->connections[client], SessionEvent::close, reason);
}

void SessionServer::close() noexcept {
  for (auto& connection : impl_->connections) impl_->drop(*connection, SessionEvent::close, LeaveReason::bye);
}

std::optional<SessionServer::Transmit> SessionServer::poll_datagram(std::uint64_t now) noexcept {
  Impl& in = *impl_;
  if (in.reply) {
    const auto [peer, message] = *std::exchange(in.reply, std::nullopt);
    return Transmit{peer, in.writer.write(message)};
  }
  for (; in.cursor < in.connections.size(); ++in.cursor) {
    ServerConnection& connection = *in.connections[(in.first + in.cursor) % in.connections.size()];
    if (const auto datagram = connection.poll(now)) return Transmit{connection.peer(), *datagram};
  }
  in.cursor = 0;
  in.first = (in.first + 1) % in.connections.size();  // so that nobody's pieces take the time of all others
  return std::nullopt;
}

std::optional<ServerEvent> SessionServer::poll_event() noexcept {
  Impl& in = *impl_;
  if (in.next_event < in.events.size()) return in.events[in.next_event++];
  in.events.clear();
  in.next_event = 0;
  return std::nullopt;
}

// Work

struct SessionServer::Work::Impl {
  ClientParts parts;
  std::optional<Sender> old;
  Result<void> made;
};
SessionServer::Work::Work(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
SessionServer::Work::Work(Work&&) noexcept = default;
SessionServer::Work& SessionServer::Work::operator=(Work&&) noexcept = default;
SessionServer::Work::~Work() = default;

void SessionServer::Work::run() noexcept try {
  impl_->old.reset();
  if (impl_->parts.scene) impl_->made = impl_->parts.make();
} catch (const std::bad_alloc&) {
  impl_->made = out_of_memory();
}

std::optional<SessionServer::Work> SessionServer::poll_work() noexcept try {
  for (auto& connection : impl_->connections) {
    auto old = connection->take_old();
    if (!old && !connection->wants_parts()) continue;
    auto work = std::make_unique<Work::Impl>();
    work->old = std::move(old);
    if (connection->wants_parts()) work->parts = connection->ask_parts();
    return Work(std::move(work));
  }
  return std::nullopt;
} catch (const std::bad_alloc&) {
  return std::nullopt;
}

Result<std::optional<SessionServer::Work>> SessionServer::take(std::uint64_t now, Work work) noexcept try {
  ClientParts& parts = work.impl_->parts;
  if (!parts.scene) return std::nullopt;
  ServerConnection& connection = *impl_->connections[parts.client];
  if (!work.impl_->made) {
    if (parts.epoch == connection.welcome().epoch) connection.refuse_parts();
    return tl::unexpected(work.impl_->made.error());
  }
  if (!connection.take(now, parts)) return std::optional(std::move(work));
  impl_->note({.kind = ServerEvent::Kind::live, .client = parts.client});
  return std::nullopt;
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

std::optional<std::uint64_t> SessionServer::next_timeout() const noexcept {
  std::optional<std::uint64_t> out;
  for (const auto& connection : impl_->connections)
    if (const auto due = connection->next_timeout()) out = std::min(out.value_or(*due), *due);
  return out;
}

std::optional<DeviceSample> SessionServer::device(std::uint16_t client, std::uint64_t now) noexcept {
  return impl_->connections[client]->device(now);
}

std::uint64_t SessionServer::device_hash(std::uint16_t client) const noexcept {
  return impl_->connections[client]->device_hash();
}
bool SessionServer::has_peer(std::uint64_t peer) const noexcept { return peer != 0 && impl_->find(peer) != nullptr; }
std::uint16_t SessionServer::clients() const noexcept { return impl_->options.clients; }
ClientStatus SessionServer::status(std::uint16_t client) const noexcept { return impl_->connections[client]->status(); }

std::uint64_t SessionServer::state_hash(std::uint16_t client, std::size_t substream) const noexcept {
  return impl_->connections[client]->state_hash(substream);
}

}  // namespace tactus
