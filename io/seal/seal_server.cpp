// SPDX-License-Identifier: Apache-2.0
#include <tactus/seal/seal_server.h>

#include <gnutls/crypto.h>

#include <algorithm>
#include <array>
#include <deque>

#include <tactus/base/rule.h>
#include <tactus/net/rate_limit.h>
#include <tactus/seal/association.h>

namespace tactus::seal {
namespace {

constexpr std::uint64_t kTimeout = 10'000'000;  // [us] for a handshake; then for the session in it; for repeating the last flight
constexpr std::uint64_t kRepeatEvery = 50'000;  // [us] at most, also of alerts
constexpr int kRepetitions = 3;                 // of what ends an association
constexpr std::size_t kInbox = 4;               // datagrams of a handshake that wait
constexpr std::size_t kAmplification = 3;       // to an address that is not validated

using Bytes = std::vector<std::uint8_t>;

/// Of a ClientHello: distinguishes one handshake of an address from the next.
using Random = std::array<std::uint8_t, 32>;

struct Peer {
  net::Address at;
  Random random{};
  gnutls_dtls_prestate_st cookie{};
  std::uint64_t began = 0, spoke_at = 0, alerted_at = 0;  // [us]
  net::RateLimit limit;
  std::unique_ptr<Association> link;  // null until the first step
  std::deque<Bytes> inbox;
  std::uint64_t id = 0;  // of an association
};

auto find(auto& peers, const net::Address& at) {
  return std::ranges::find(peers, at, [](const auto& peer) -> const net::Address& { return peer->at; });
}

auto find(auto& peers, std::uint64_t id) {
  return std::ranges::find(peers, id, [](const auto& peer) { return peer->id; });
}

Random random_of(std::span<const std::uint8_t> hello) {
  Random out{};
  const auto from = hello.subspan(kRecordHead + kMessageHead + 2, out.size());
  std::copy(from.begin(), from.end(), out.begin());
  return out;
}

}  // namespace

struct Server::Impl {
  bool is_too_much(std::uint64_t now, const net::Address& from, std::size_t bytes) noexcept;
  void hear_hello(std::uint64_t now, const net::Address& from, std::span<const std::uint8_t> wire);
  void hear_handshake(std::uint64_t now, const net::Address& from, std::span<const std::uint8_t> wire);
  void take(Peer& peer, std::span<const std::uint8_t> wire);
  std::optional<Opened> hear_record(const RecordHead& head, const net::Address& from, std::span<const std::uint8_t> wire);
  void step(std::uint64_t now, Peer& peer);
  void settle(std::uint64_t now, std::unique_ptr<Peer> peer);
  void forget(std::uint64_t id);
  void speak(std::uint64_t now, Peer& peer) {
    peer.spoke_at = now;
    send(peer.at, peer.link->flight());
  }
  void send(const net::Address& to, std::span<const std::uint8_t> bytes) {
    constexpr std::size_t kMost = 1024;  // of a program that does not poll
    if (!bytes.empty() && out.size() < kMost) out.emplace_back(to, Bytes(bytes.begin(), bytes.end()));
  }

  std::unique_ptr<Context> context;
  ServerOptions options;
  std::optional<Cookies> cookies;
  std::optional<net::StrangersLimit> strangers;
  std::vector<std::unique_ptr<Peer>> peers, shaking;  // with an association; with a handshake, in the order of their beginning
  std::size_t next = 0;                               // of shaking
  std::uint64_t last_id = 0;
  std::array<std::uint8_t, kLargestSealed> opened{}, sealed{};
  std::optional<net::Transmit> answer;  // a cookie
  std::deque<std::pair<net::Address, Bytes>> out;
  Bytes polled;
  std::deque<std::uint64_t> closed;
  Counters counters;
};

Server::Server(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
Server::Server(Server&&) noexcept = default;
Server& Server::operator=(Server&&) noexcept = default;
Server::~Server() = default;

Result<Server> Server::create(KeyList keys, std::uint64_t now, const ServerOptions& options) try {
  auto impl = std::make_unique<Impl>();
  impl->options = options;
  TACTUS_TRY(impl->context, Context::create(std::move(keys), options.limits));
  std::uint64_t secret = 0;
  if (gnutls_rnd(GNUTLS_RND_KEY, &secret, sizeof secret) != 0) return fail(Errc::internal, "R-SEA-6");
  impl->strangers.emplace(secret);
  TACTUS_TRY(impl->cookies, Cookies::create(now));
  return Server(std::move(impl));
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

std::optional<Server::Opened> Server::open(std::uint64_t now, const net::Address& from,
                                           std::span<const std::uint8_t> wire) noexcept try {
  Impl& in = *impl_;
  if (in.is_too_much(now, from, wire.size())) {
    ++in.counters.limited;
    return std::nullopt;
  }
  const auto head = read_head(wire);
  if (!head || wire.size() > kLargestSealed) {
    ++in.counters.strangers;
    return std::nullopt;
  }
  if (head->content == Content::handshake && head->epoch == 0 && message_type(wire) == kClientHello) {
    in.hear_hello(now, from, wire);
    return std::nullopt;
  }
  if (head->content == Content::handshake || head->content == Content::change_cipher_spec) {
    in.hear_handshake(now, from, wire);
    return std::nullopt;
  }
  return in.hear_record(*head, from, wire);
} catch (const std::bad_alloc&) {
  return std::nullopt;  // a datagram lost
}

bool Server::Impl::is_too_much(std::uint64_t now, const net::Address& from, std::size_t bytes) noexcept {
  if (const auto open = find(peers, from); open != peers.end()) return !(*open)->limit.take(now, bytes, net::kClientRate);
  if (const auto shakes = find(shaking, from); shakes != shaking.end())
    return !(*shakes)->limit.take(now, bytes, net::kHandshakeRate);
  return !strangers->take(now, from, bytes);
}

void Server::Impl::hear_hello(std::uint64_t now, const net::Address& from, std::span<const std::uint8_t> wire) {
  const Cookies::Look look = cookies->look(now, from.bytes(), wire);
  if (look.verdict == Cookies::Verdict::no_hello) {
    ++counters.strangers;
    return;
  }
  if (look.verdict == Cookies::Verdict::unvalidated) {
    const auto reply = cookies->answer(from.bytes());
    if (reply.empty() || reply.size() > kAmplification * wire.size()) return;
    ++counters.cookies;
    answer = net::Transmit{from, reply};
    return;
  }
  const Random random = random_of(wire);
  const auto open = find(peers, from);
  if (open != peers.end() && (*open)->random == random) return;  // a late copy
  if (const auto old = find(shaking, from); old != shaking.end()) {
    if ((*old)->random == random) return take(**old, wire);
    shaking.erase(old);
  }
  if (shaking.size() == std::max<std::size_t>(options.handshakes, 1)) shaking.erase(shaking.begin());
  auto peer = std::make_unique<Peer>();
  peer->at = from;
  peer->random = random;
  peer->cookie = look.state;
  peer->began = now;
  take(*peer, wire);
  shaking.push_back(std::move(peer));
}

void Server::Impl::take(Peer& peer, std::span<const std::uint8_t> wire) {
  if (peer.inbox.size() < kInbox) peer.inbox.emplace_back(wire.begin(), wire.end());
}

void Server::Impl::hear_handshake(std::uint64_t now, const net::Address& from, std::span<const std::uint8_t> wire) {
  if (const auto shakes = find(shaking, from); shakes != shaking.end()) return take(**shakes, wire);
  const auto open = find(peers, from);
  if (open == peers.end()) {
    ++counters.strangers;
    return;
  }
  Peer& peer = **open;  // it may have missed our last flight
  if (now < peer.began + kTimeout && now >= peer.spoke_at + kRepeatEvery) speak(now, peer);
}

std::optional<Server::Opened> Server::Impl::hear_record(const RecordHead& head, const net::Address& from,
                                                        std::span<const std::uint8_t> wire) {
  const auto found = find(peers, from);
  if (found == peers.end() || head.epoch != 1 || !head.is_alone) {
    ++counters.strangers;
    return std::nullopt;
  }
  Peer& peer = **found;
  const auto inside = peer.link->open(head, wire, opened);
  switch (inside.what) {
    case Association::Opened::plain:
      ++counters.opened;
      return Opened{peer.id, inside.plain};
    case Association::Opened::replayed:
      ++counters.replayed;
      break;
    case Association::Opened::unauthentic:
      ++counters.unauthentic;
      break;
    case Association::Opened::nothing:
      break;
    case Association::Opened::closed:
    case Association::Opened::denied:
    case Association::Opened::used_up:
      forget(peer.id);
      break;
  }
  return std::nullopt;
}

bool Server::has_work() const noexcept {
  return std::ranges::any_of(impl_->shaking, [](const auto& peer) { return !peer->inbox.empty(); });
}

void Server::work(std::uint64_t now) noexcept try {
  Impl& in = *impl_;
  std::erase_if(in.shaking, [now](const auto& peer) { return now >= peer->began + kTimeout; });
  for (std::size_t i = 0; i < in.shaking.size(); ++i) {
    const std::size_t at = (in.next + i) % in.shaking.size();
    if (in.shaking[at]->inbox.empty()) continue;
    in.step(now, *in.shaking[at]);
    in.next = at + 1;
    if (in.shaking[at]->link && in.shaking[at]->link->stage() == Association::Stage::handshake) return;
    auto done = std::move(in.shaking[at]);
    in.shaking.erase(in.shaking.begin() + static_cast<std::ptrdiff_t>(at));
    in.next = at;
    if (done->link && done->link->stage() == Association::Stage::open) in.settle(now, std::move(done));
    return;
  }
} catch (const std::bad_alloc&) {
  impl_->shaking.clear();  // their clients begin anew
}

void Server::Impl::step(std::uint64_t now, Peer& peer) {
  const Bytes wire = std::move(peer.inbox.front());
  peer.inbox.pop_front();
  if (!peer.link) {
    auto link = Association::server(*context, peer.cookie);
    if (!link) return;
    peer.link = std::move(*link);
  }
  const auto stage = peer.link->advance(wire);
  if (stage == Association::Stage::broken) return;
  if (peer.link->is_key_wrong() && now >= peer.alerted_at + kRepeatEvery) {
    peer.alerted_at = now;
    return send(peer.at, peer.link->alert(kDecryptError, sealed));
  }
  if (peer.link->has_spoken() || (!peer.link->flight().empty() && now >= peer.spoke_at + kRepeatEvery)) speak(now, peer);
}

/// The handshake is done.
void Server::Impl::settle(std::uint64_t now, std::unique_ptr<Peer> peer) {
  if (const auto old = find(peers, peer->at); old != peers.end()) peers.erase(old);  // its session may go on, by another name
  if (peers.size() >= options.peers) {
    send(peer->at, peer->link->close());
    return;
  }
  ++counters.handshakes;
  peer->id = ++last_id;
  peer->began = now;
  peer->inbox.clear();
  peers.push_back(std::move(peer));
}

void Server::Impl::forget(std::uint64_t id) {
  const auto found = find(peers, id);
  if (found == peers.end()) return;
  closed.push_back(id);
  peers.erase(found);
}

std::vector<std::uint64_t> Server::replace(KeyList keys) {
  Impl& in = *impl_;
  const auto is_gone = [&keys](const auto& peer) { return peer->link && peer->link->key() && !keys.holds(*peer->link->key()); };
  std::vector<std::uint64_t> out;
  for (const auto& peer : in.peers)
    if (is_gone(peer)) out.push_back(peer->id);
  for (int i = 0; i < kRepetitions; ++i)
    for (const auto& peer : in.peers)
      if (is_gone(peer)) in.send(peer->at, peer->link->alert(kAccessDenied, in.sealed));
  std::erase_if(in.peers, is_gone);
  std::erase_if(in.shaking, is_gone);
  in.context->replace(std::move(keys));
  return out;
}

const KeyList::User* Server::user_of(std::uint64_t peer) const noexcept {
  const auto found = find(impl_->peers, peer);
  return found == impl_->peers.end() ? nullptr : impl_->context->keys().find((*found)->link->key()->name());
}

Result<net::Transmit> Server::seal(std::uint64_t peer, std::span<const std::uint8_t> plain) noexcept try {
  Impl& in = *impl_;
  const auto found = find(in.peers, peer);
  if (found == in.peers.end()) return fail(Errc::limit_exceeded, "R-SEA-5");
  const net::Address to = (*found)->at;
  const auto out = (*found)->link->seal(plain, in.sealed);
  if ((*found)->link->stage() != Association::Stage::open) in.forget(peer);
  if (!out) return tl::unexpected(out.error());
  ++in.counters.sealed;
  return net::Transmit{to, *out};
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

void Server::keep_only(std::uint64_t now, const std::function<bool(std::uint64_t peer)>& is_needed) {
  Impl& in = *impl_;
  for (std::size_t i = in.peers.size(); i-- > 0;) {
    Peer& peer = *in.peers[i];
    if (now < peer.began + kTimeout || is_needed(peer.id)) continue;
    in.send(peer.at, peer.link->close());
    in.forget(peer.id);
  }
}

void Server::close() noexcept try {
  Impl& in = *impl_;
  for (const auto& peer : in.peers) {
    in.send(peer->at, peer->link->close());
    in.closed.push_back(peer->id);
  }
  in.peers.clear();
  in.shaking.clear();
} catch (const std::bad_alloc&) {
  impl_->peers.clear();
}

std::optional<net::Transmit> Server::poll_datagram() noexcept {
  Impl& in = *impl_;
  if (in.answer) return std::exchange(in.answer, std::nullopt);
  if (in.out.empty()) return std::nullopt;
  const net::Address to = in.out.front().first;
  in.polled = std::move(in.out.front().second);
  in.out.pop_front();
  return net::Transmit{to, in.polled};
}

std::optional<std::uint64_t> Server::poll_closed() noexcept {
  Impl& in = *impl_;
  if (in.closed.empty()) return std::nullopt;
  const std::uint64_t id = in.closed.front();
  in.closed.pop_front();
  return id;
}

net::Address Server::address_of(std::uint64_t peer) const noexcept {
  const auto found = find(impl_->peers, peer);
  return found == impl_->peers.end() ? net::Address() : (*found)->at;
}

std::uint64_t Server::limited_of(std::uint64_t peer) const noexcept {
  const auto found = find(impl_->peers, peer);
  return found == impl_->peers.end() ? 0 : (*found)->limit.dropped();
}

std::size_t Server::peers() const noexcept { return impl_->peers.size(); }
std::size_t Server::handshakes() const noexcept { return impl_->shaking.size(); }
Counters Server::counters() const noexcept { return impl_->counters; }

}  // namespace tactus::seal
