// SPDX-License-Identifier: Apache-2.0
/// The server's end of the seal, with many clients: a function of datagrams and time. spec/70-session.md section 11.
///
/// It knows neither sockets nor clocks. The program calls
///   server.open() with each datagram, and hands on what comes out. What goes beyond the rates of rate_limit.h is dropped before anything
///   is done for it, and counted: honest clients never are. Who can forge a client's address can use up that client's rate;
///   server.work() once per tick: handshakes are its expensive part, and one step of one handshake is done at a time;
///   and after each call: while (auto d = server.poll_datagram()) send it;  while (auto p = server.poll_closed()) end its session.
/// Times are microseconds of any clock that never steps back.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <tactus/net/udp.h>
#include <tactus/seal/key_list.h>

namespace tactus::seal {

struct ServerOptions {
  std::size_t peers = 16;       ///< most associations; further ones are closed when their handshake is done
  std::size_t handshakes = 32;  ///< most at a time; a further one takes the place of the oldest
  Limits limits{};
};

/// Threads: one at a time. Of an address that is not validated nothing is kept, not even in part.
class Server {
 public:
  /// in   keys  of the users; a key alone is a list, too   err  internal R-SEA-6
  static Result<Server> create(KeyList keys, std::uint64_t now, const ServerOptions& options = {});

  struct Opened {
    std::uint64_t peer = 0;               ///< an association: above 0, never used again
    std::span<const std::uint8_t> plain;  ///< the session's datagram, valid until the next call
  };
  /// A datagram came. Nothing: it is of the seal itself, noise, or too much.   time  a few us; less than one if it is too much
  std::optional<Opened> open(std::uint64_t now, const net::Address& from, std::span<const std::uint8_t> wire) noexcept;
  /// One step of the handshake that waits longest, if any does; handshakes older than 10 s are forgotten.   time  some 0.1 ms
  void work(std::uint64_t now) noexcept;
  bool has_work() const noexcept;
  /// A datagram of the session, sealed.   out  valid until the next call
  /// err   limit_exceeded R-SEA-4: the association is closed now;  limit_exceeded R-SEA-5: empty, too large, or there is no such peer
  Result<net::Transmit> seal(std::uint64_t peer, std::span<const std::uint8_t> plain) noexcept;

  /// Close the associations that nobody needs and that are older than 10 s.
  void keep_only(std::uint64_t now, const std::function<bool(std::uint64_t peer)>& is_needed);
  void close() noexcept;  ///< all
  /// Other users from now on.   out  peers whose user is gone or has another key: they were sent an alert, and are closed
  std::vector<std::uint64_t> replace(KeyList keys);
  /// Whose association it is, valid until replace(); null: unknown.   time O(peers)
  const KeyList::User* user_of(std::uint64_t peer) const noexcept;

  std::optional<net::Transmit> poll_datagram() noexcept;        ///< valid until the next call
  std::optional<std::uint64_t> poll_closed() noexcept;          ///< a peer that closed its association
  net::Address address_of(std::uint64_t peer) const noexcept;   ///< none: unknown
  std::uint64_t limited_of(std::uint64_t peer) const noexcept;  ///< datagrams from there that were too much
  std::size_t peers() const noexcept;
  std::size_t handshakes() const noexcept;  ///< that go on
  Counters counters() const noexcept;

  Server(Server&&) noexcept;
  Server& operator=(Server&&) noexcept;
  ~Server();

 private:
  struct Impl;
  explicit Server(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tactus::seal
