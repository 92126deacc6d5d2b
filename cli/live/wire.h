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
  /// in   most  sessions at a time
  explicit Peers(std::size_t most) : most_(most) {}

  /// The sender of the newest datagram.
  std::uint64_t name(const net::Address& from);
  /// Remember the sender of the newest datagram, if it has a session.
  void settle(const HasSession& has_session);
  /// Null: unknown. The sender of the newest datagram is known.
  const net::Address* find(std::uint64_t peer) const;
  std::size_t size() const noexcept { return known_.size(); }

 private:
  std::size_t most_;
  std::vector<net::Address> known_;
  net::Address newest_;
};

// ==== wire ====
// How datagrams of sessions travel: as they are, on the loopback, or sealed.

/// What the seal did, for the report.
struct SealUse {
  std::size_t overhead = 0;  ///< [bytes] around each datagram
  seal::Counters counters;
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
  virtual void tick(std::uint64_t now, const HasSession& has_session) = 0;
  /// A peer that is gone, whatever its session believes.
  virtual std::optional<std::uint64_t> poll_closed() = 0;
  virtual void close() = 0;
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
  virtual std::optional<std::uint64_t> next_timeout() const = 0;  ///< [us] nothing: never
  virtual void close() = 0;
  virtual std::optional<SealUse> seal() const = 0;  ///< nothing: it is not sealed
};

/// pre  the socket outlives the wire
std::unique_ptr<ServerWire> plain_wire_of_server(net::UdpSocket& socket, std::uint32_t clients);
std::unique_ptr<ClientWire> plain_wire_of_client(net::UdpSocket& socket);
/// in   key  path of a key file
/// err  it cannot be read or used; this program was built without the seal
tl::expected<std::unique_ptr<ServerWire>, Failure> sealed_wire_of_server(net::UdpSocket& socket, std::uint32_t clients,
                                                                         const std::string& key);
tl::expected<std::unique_ptr<ClientWire>, Failure> sealed_wire_of_client(net::UdpSocket& socket, const std::string& key);

/// What a user must do for a session that is sealed.
std::string how_to_seal();

}  // namespace tactus::cli
