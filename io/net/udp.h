// SPDX-License-Identifier: Apache-2.0
/// Datagrams over UDP, without blocking. POSIX.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <tactus/base/result.h>

namespace tactus::net {

/// An IPv4 or IPv6 address with its port.
class Address {
 public:
  /// "192.0.2.1:4000", "[::1]:4000", "localhost:4000"; names are looked up, which may take seconds.
  /// err  invalid_argument R-NET-1: not HOST:PORT, no port from 0 to 65535, or no such host
  static Result<Address> parse(std::string_view text);

  /// Whether it reads HOST:PORT, of whatever host: parse() then fails for a host that nobody knows.
  static bool has_form(std::string_view text);

  std::string text() const;  ///< as parse() takes it, in numbers
  std::uint16_t port() const noexcept;
  bool is_ipv6() const noexcept;
  bool is_loopback() const noexcept;
  std::uint64_t key() const noexcept;  ///< equal for equal addresses, else almost certainly different; never 0
  std::span<const std::uint8_t> bytes() const noexcept { return {bytes_, size_}; }  ///< equal for equal addresses only
  /// What names the host, without its port: four bytes of IPv4, also within IPv6, or the first eight of IPv6, which a host has for itself.
  std::span<const std::uint8_t> host() const noexcept;
  friend bool operator==(const Address& a, const Address& b) noexcept;

 private:
  friend class UdpSocket;
  static constexpr std::size_t kLargest = 28;  // sockaddr_in6
  alignas(8) std::uint8_t bytes_[kLargest]{};  // a sockaddr_in or sockaddr_in6
  std::uint32_t size_ = 0;
};

/// A datagram to be sent.
struct Transmit {
  Address to;
  std::span<const std::uint8_t> bytes;
};

/// pre  one thread at a time.   No call after the first two allocates, blocks or throws.
class UdpSocket {
 public:
  /// A socket with this address of its own; port 0: any free one.   err  io R-NET-2, with errno
  static Result<UdpSocket> bind(const Address& own);
  /// A socket that talks to one peer: what others send to it is dropped by the system.   err  io R-NET-2, with errno
  static Result<UdpSocket> connect(const Address& peer);

  UdpSocket(UdpSocket&& other) noexcept;
  UdpSocket& operator=(UdpSocket&& other) noexcept;
  ~UdpSocket();

  Address own() const noexcept;
  int handle() const noexcept { return handle_; }  ///< for poll()

  /// Room for datagrams that wait for receive(): some 700 bytes for a small one.   out  [bytes] that the system gives
  std::size_t ask_room(std::size_t bytes) noexcept;
  std::uint64_t dropped() const noexcept;  ///< datagrams that found no room; 0 where the system does not report it
  /// The peer's machine answered to the last datagram that nobody listens there.   pre  made by connect()
  bool is_refused() const noexcept { return refused_; }

  /// false: the system did not take it (its queue is full, nobody listens there, it is too long). That is a loss like any other.
  bool send(std::span<const std::uint8_t> datagram) noexcept;  ///< pre  made by connect()
  bool send(const Address& to, std::span<const std::uint8_t> datagram) noexcept;

  struct Received {
    std::span<const std::uint8_t> bytes;  ///< in the buffer; what did not fit is cut off
    Address from;
  };
  /// The next datagram that waits, or none.
  std::optional<Received> receive(std::span<std::uint8_t> buffer) noexcept;

 private:
  explicit UdpSocket(int handle) noexcept : handle_(handle) {}
  int handle_ = -1;
  bool refused_ = false;
};

}  // namespace tactus::net
