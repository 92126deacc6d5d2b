// SPDX-License-Identifier: Apache-2.0
/// How datagrams of a session travel: plain on this machine, sealed beyond it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <tactus/net/rate_limit.h>
#include <tactus/net/udp.h>
#include <tactus/seal/key.h>
#include "cli/report/messages.h"

namespace tactus::cli {

// ==== peers ====

/// Who sent datagrams: a session names addresses by their keys. Only those with a session are remembered, so that strangers push nobody
/// out.
class Peers {
 public:
  using HasSession = std::function<bool(std::uint64_t peer)>;
  /// in   most  sessions at a time;  secret  64 bits that nobody else can guess
  Peers(std::size_t most, std::uint64_t secret) : most_(most), strangers_(secret) {}

  /// A datagram is not too much for its sender, or for all senders without a session. Others are dropped and counted before anything is
  /// done for them.   in  now  [us]   time O(sessions)
  bool permits(std::uint64_t now, const net::Address& from, std::size_t bytes);
  std::uint64_t limited() const noexcept { return limited_; }  ///< datagrams that were too much
  std::uint64_t limited_of(std::uint64_t peer) const;          ///< those of a peer with a session
  /// The sender of the newest datagram.
  std::uint64_t name(const net::Address& from);
  /// Remember the sender of the newest datagram, if it has a session.
  void settle(const HasSession& has_session);
  /// Null: unknown. The sender of the newest datagram is known.
  const net::Address* find(std::uint64_t peer) const;
  std::size_t size() const noexcept { return known_.size(); }

 private:
  struct Known {
    net::Address at;
    net::RateLimit limit{};
  };
  std::size_t most_;
  std::vector<Known> known_;
  net::Address newest_;
  net::StrangersLimit strangers_;
  std::uint64_t limited_ = 0;
};

// ==== wire ====
// How datagrams of sessions travel: as they are, on the loopback, or sealed.

/// What the seal did, for the report.
struct SealUse {
  std::size_t overhead = 0;  ///< [bytes] around each datagram
  seal::Counters counters;
  std::string user{};  ///< of a client: whose key it is
};

/// Who a peer is, by the key that it has.
struct WireUser {
  std::string name;
  bool may_touch = true;
};

/// What a look at the file of the keys brought.
struct KeyNews {
  std::string text;                    ///< for the operator
  bool is_refused = false;             ///< it cannot be used: the keys before stay
  std::vector<std::uint64_t> removed;  ///< peers whose user is not in it any more: they are closed, and were sent the reason
};

/// Of a server. Spans are valid until the next call.
class ServerWire {
 public:
  struct Heard {
    std::uint64_t peer = 0;
    std::span<const std::uint8_t> bytes;
  };
  using HasSession = std::function<bool(std::uint64_t peer)>;

  virtual ~ServerWire() = default;
  /// The next datagram for the sessions, of few that wait; nothing: none, or it is time to do something else.
  virtual std::optional<Heard> receive(std::uint64_t now) = 0;
  /// After each datagram, when the sessions have taken it.
  virtual void settle(const HasSession& has_session) = 0;
  virtual void send(std::uint64_t peer, std::span<const std::uint8_t> bytes) = 0;
  virtual std::string address_of(std::uint64_t peer) const = 0;  ///< HOST:PORT; "nowhere": it is unknown
  /// Nothing: there are no keys, or the peer is gone.
  virtual std::optional<WireUser> user_of(std::uint64_t peer) const = 0;
  /// Look whether the file of the keys is another one: once a second, or `at_once`. Nothing: it is the same, or there is none.
  /// time  a system call each second; 0.5 ms to read a file of 1024 users
  virtual std::optional<KeyNews> look_at_keys(std::uint64_t now, bool at_once) = 0;
  virtual void tick(std::uint64_t now, const HasSession& has_session) = 0;
  /// A peer that is gone, whatever its session believes.
  virtual std::optional<std::uint64_t> poll_closed() = 0;
  virtual void close() = 0;
  virtual std::uint64_t limited() const = 0;  ///< datagrams dropped: their senders sent too much
  virtual std::uint64_t limited_of(std::uint64_t peer) const = 0;
  virtual std::optional<SealUse> seal() const = 0;  ///< nothing: it is not sealed
};

/// Of a client.
class ClientWire {
 public:
  virtual ~ClientWire() = default;
  /// The next datagram for the session, valid until the next call.   err  the wire is gone
  virtual Result<std::optional<std::span<const std::uint8_t>>> receive(std::uint64_t now) = 0;
  virtual Result<void> handle_timeout(std::uint64_t now) = 0;  ///< err  the wire is gone
  virtual void send(std::span<const std::uint8_t> bytes) = 0;
  virtual void renew(std::uint64_t now) = 0;                      ///< nobody answers: the other end may have forgotten this one
  virtual bool is_open() const = 0;                               ///< the session may begin
  virtual bool is_doubted() const = 0;                            ///< somebody says that the key is wrong; anyone can
  virtual std::optional<std::uint64_t> next_timeout() const = 0;  ///< [us] nothing: never
  virtual void close() = 0;
  virtual std::optional<SealUse> seal() const = 0;  ///< nothing: it is not sealed
};

/// pre  the socket outlives the wire
std::unique_ptr<ServerWire> plain_wire_of_server(net::UdpSocket& socket, std::uint32_t clients);
std::unique_ptr<ClientWire> plain_wire_of_client(net::UdpSocket& socket);
/// in   key  path of a key file; of a server also of a key list
/// err  it cannot be read or used; this program was built without the seal
tl::expected<std::unique_ptr<ServerWire>, Failure> sealed_wire_of_server(net::UdpSocket& socket, std::uint32_t clients,
                                                                         const std::string& key);
tl::expected<std::unique_ptr<ClientWire>, Failure> sealed_wire_of_client(net::UdpSocket& socket, const std::string& key);

/// What a user must do for a session that is sealed.
std::string how_to_seal();

}  // namespace tactus::cli
