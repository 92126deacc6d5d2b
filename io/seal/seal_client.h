// SPDX-License-Identifier: Apache-2.0
/// The client's end of the seal: a function of datagrams and time. spec/70-session.md section 11.
///
/// It knows neither sockets nor clocks. The program calls one of open(), seal() and handle_timeout(), and then
///   while (auto d = client.poll_datagram()) send it;
///   wait for a datagram or client.next_timeout(), whichever comes first.
/// Whatever the network does, an error from open() or handle_timeout() is the end. Times are microseconds of any clock that never steps
/// back.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include <tactus/seal/key.h>

namespace tactus::seal {

/// Threads: one at a time. GnuTLS allocates a little for each record and gives it back.
class Client {
 public:
  /// Begins the handshake.   err  internal R-SEA-6
  static Result<Client> create(Key key, std::uint64_t now, const Limits& limits = {});

  bool is_open() const noexcept;  ///< the handshake is done
  /// Somebody says that the key is wrong: most likely the server, some milliseconds after it heard what was made with the key. Anyone can
  /// say so: tell the user, and go on, as this end does.
  bool is_doubted() const noexcept;
  /// A datagram came.   out  the session's datagram in it, valid until the next call; nothing: it is of the seal itself, or noise
  /// time  some 0.1 ms while the handshake runs, then a few us
  /// err   state R-SEA-3;  limit_exceeded R-SEA-4;  internal R-SEA-6;  state R-SEA-7: the server no longer permits this user
  Result<std::optional<std::span<const std::uint8_t>>> open(std::uint64_t now, std::span<const std::uint8_t> wire) noexcept;
  /// A datagram of the session, sealed: valid until the next call.   pre  is_open()
  /// err   limit_exceeded R-SEA-4: final;  limit_exceeded R-SEA-5: it is empty or too large, or the association was closed
  Result<std::span<const std::uint8_t>> seal(std::span<const std::uint8_t> plain) noexcept;
  /// err   state R-SEA-1: nobody answers;  state R-SEA-2: the other end has another key;  internal R-SEA-6
  Result<void> handle_timeout(std::uint64_t now) noexcept;
  /// Say close_notify; nothing can be sealed any more.
  void close() noexcept;

  std::optional<std::span<const std::uint8_t>> poll_datagram() noexcept;  ///< valid until the next call
  std::optional<std::uint64_t> next_timeout() const noexcept;             ///< [us] nothing: never
  Counters counters() const noexcept;

  Client(Client&&) noexcept;
  Client& operator=(Client&&) noexcept;
  ~Client();

 private:
  struct Impl;
  explicit Client(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tactus::seal
