// SPDX-License-Identifier: Apache-2.0
#include <tactus/net/udp.h>

#include <arpa/inet.h>
#ifdef __linux__
#include <linux/sock_diag.h>
#endif
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstddef>
#include <cstring>
#include <memory>
#include <utility>

#include <tactus/base/bytes.h>
#include <tactus/base/rule.h>

namespace tactus::net {
namespace {

static_assert(sizeof(sockaddr_in6) == 28 && sizeof(sockaddr_in) <= sizeof(sockaddr_in6));

const sockaddr* as_sockaddr(const std::uint8_t* bytes) noexcept { return reinterpret_cast<const sockaddr*>(bytes); }

/// Host and port; an IPv6 address stands in brackets.
std::optional<std::pair<std::string, std::string>> split(std::string_view text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos || colon == 0) return std::nullopt;
  std::string_view host = text.substr(0, colon);
  const std::string_view port = text.substr(colon + 1);
  if (host.front() == '[') {
    if (host.size() < 3 || host.back() != ']') return std::nullopt;
    host = host.substr(1, host.size() - 2);
  } else if (host.find(':') != std::string_view::npos) {
    return std::nullopt;
  }
  std::uint16_t number = 0;
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), number);
  if (error != std::errc() || end != port.data() + port.size()) return std::nullopt;
  return std::pair(std::string(host), std::string(port));
}

Result<int> open_socket(int family) {
  const int handle = ::socket(family, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (handle < 0) return fail(Errc::io, "R-NET-2");
  return handle;
}

}  // namespace

bool Address::has_form(std::string_view text) { return split(text).has_value(); }

Result<Address> Address::parse(std::string_view text) {
  const auto parts = split(text);
  if (!parts) return fail(Errc::invalid_argument, "R-NET-1");
  addrinfo wanted{};
  wanted.ai_family = AF_UNSPEC;
  wanted.ai_socktype = SOCK_DGRAM;
  wanted.ai_flags = AI_NUMERICSERV;
  addrinfo* found = nullptr;
  if (getaddrinfo(parts->first.c_str(), parts->second.c_str(), &wanted, &found) != 0)
    return fail(Errc::invalid_argument, "R-NET-1");
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> owned(found, freeaddrinfo);
  Address out;
  out.size_ = found->ai_addrlen;
  std::memcpy(out.bytes_, found->ai_addr, found->ai_addrlen);
  return out;
}

std::string Address::text() const {
  char host[INET6_ADDRSTRLEN]{};
  char port[8]{};
  if (size_ == 0 ||
      getnameinfo(as_sockaddr(bytes_), size_, host, sizeof host, port, sizeof port, NI_NUMERICHOST | NI_NUMERICSERV) != 0)
    return "nowhere";
  return (is_ipv6() ? '[' + std::string(host) + ']' : std::string(host)) + ':' + port;
}

bool Address::is_ipv6() const noexcept { return size_ > 0 && as_sockaddr(bytes_)->sa_family == AF_INET6; }

/// It is in the same place for both families.
std::uint16_t Address::port() const noexcept {
  static_assert(offsetof(sockaddr_in, sin_port) == offsetof(sockaddr_in6, sin6_port));
  std::uint16_t port = 0;
  std::memcpy(&port, bytes_ + offsetof(sockaddr_in, sin_port), sizeof port);
  return ntohs(port);
}

std::uint64_t Address::key() const noexcept {
  Fnv1a hash;
  for (std::size_t i = 0; i < size_; ++i) hash.add_byte(bytes_[i]);
  return hash.value() == 0 ? 1 : hash.value();
}

bool Address::is_loopback() const noexcept {
  if (size_ == 0) return false;
  if (is_ipv6()) {
    sockaddr_in6 address{};
    std::memcpy(&address, bytes_, sizeof address);
    return IN6_IS_ADDR_LOOPBACK(&address.sin6_addr);
  }
  sockaddr_in address{};
  std::memcpy(&address, bytes_, sizeof address);
  return ntohl(address.sin_addr.s_addr) >> 24 == 127;
}

std::span<const std::uint8_t> Address::host() const noexcept {
  constexpr std::size_t kMapped = 12, kIpv4 = 4, kNetwork = 8;  // [bytes]
  if (size_ == 0) return {};
  const auto all = bytes();
  if (as_sockaddr(bytes_)->sa_family != AF_INET6) return all.subspan(offsetof(sockaddr_in, sin_addr), kIpv4);
  const auto host = all.subspan(offsetof(sockaddr_in6, sin6_addr), sizeof(in6_addr));
  constexpr std::array<std::uint8_t, kMapped> kPrefix{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xFF, 0xFF};
  return std::ranges::equal(host.first(kMapped), kPrefix) ? host.subspan(kMapped) : host.first(kNetwork);
}

bool operator==(const Address& a, const Address& b) noexcept {
  return a.size_ == b.size_ && std::equal(a.bytes_, a.bytes_ + a.size_, b.bytes_);
}

Result<UdpSocket> UdpSocket::bind(const Address& own) {
  TACTUS_TRY(const int handle, open_socket(as_sockaddr(own.bytes_)->sa_family));
  UdpSocket socket(handle);
  if (::bind(handle, as_sockaddr(own.bytes_), own.size_) != 0) return fail(Errc::io, "R-NET-2");
  return socket;
}

Result<UdpSocket> UdpSocket::connect(const Address& peer) {
  TACTUS_TRY(const int handle, open_socket(as_sockaddr(peer.bytes_)->sa_family));
  UdpSocket socket(handle);
  if (::connect(handle, as_sockaddr(peer.bytes_), peer.size_) != 0) return fail(Errc::io, "R-NET-2");
  return socket;
}

UdpSocket::UdpSocket(UdpSocket&& other) noexcept : handle_(std::exchange(other.handle_, -1)), refused_(other.refused_) {}

UdpSocket& UdpSocket::operator=(UdpSocket&& other) noexcept {
  std::swap(handle_, other.handle_);
  std::swap(refused_, other.refused_);
  return *this;
}

UdpSocket::~UdpSocket() {
  const int cause = errno;  // of the error that may be on its way to the caller
  if (handle_ >= 0) ::close(handle_);
  errno = cause;
}

Address UdpSocket::own() const noexcept {
  Address out;
  socklen_t size = sizeof out.bytes_;
  if (::getsockname(handle_, reinterpret_cast<sockaddr*>(out.bytes_), &size) == 0) out.size_ = size;
  return out;
}

std::size_t UdpSocket::ask_room(std::size_t bytes) noexcept {
  const int wanted = static_cast<int>(std::min<std::size_t>(bytes, 1U << 30));
  bool is_given = false;
#ifdef SO_RCVBUFFORCE
  is_given = ::setsockopt(handle_, SOL_SOCKET, SO_RCVBUFFORCE, &wanted, sizeof wanted) == 0;  // of administrators: without limit
#endif
  if (!is_given) ::setsockopt(handle_, SOL_SOCKET, SO_RCVBUF, &wanted, sizeof wanted);
  int given = 0;
  socklen_t size = sizeof given;
  if (::getsockopt(handle_, SOL_SOCKET, SO_RCVBUF, &given, &size) != 0) return 0;
#ifdef __linux__
  given /= 2;  // it doubles what it was asked for, for its own books
#endif
  return static_cast<std::size_t>(given);
}

std::uint64_t UdpSocket::dropped() const noexcept {
#ifdef __linux__
  std::uint32_t memory[SK_MEMINFO_VARS]{};
  socklen_t size = sizeof memory;
  if (::getsockopt(handle_, SOL_SOCKET, SO_MEMINFO, memory, &size) == 0) return memory[SK_MEMINFO_DROPS];
#endif
  return 0;
}

bool UdpSocket::send(std::span<const std::uint8_t> datagram) noexcept {
  if (::send(handle_, datagram.data(), datagram.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(datagram.size())) return true;
  refused_ = refused_ || errno == ECONNREFUSED;
  return false;
}

bool UdpSocket::send(const Address& to, std::span<const std::uint8_t> datagram) noexcept {
  return ::sendto(handle_, datagram.data(), datagram.size(), MSG_NOSIGNAL, as_sockaddr(to.bytes_), to.size_) ==
         static_cast<ssize_t>(datagram.size());
}

std::optional<UdpSocket::Received> UdpSocket::receive(std::span<std::uint8_t> buffer) noexcept {
  constexpr int kErrors = 64;  // that earlier datagrams met ("nobody listens there") come before what waits
  for (int i = 0; i < kErrors; ++i) {
    Received out;
    socklen_t size = sizeof out.from.bytes_;
    const ssize_t got = ::recvfrom(handle_, buffer.data(), buffer.size(), 0, reinterpret_cast<sockaddr*>(out.from.bytes_), &size);
    if (got >= 0) {
      refused_ = false;
      out.from.size_ = size;
      out.bytes = buffer.first(static_cast<std::size_t>(got));
      return out;
    }
    if (errno == EAGAIN || errno == EWOULDBLOCK) return std::nullopt;
    refused_ = refused_ || errno == ECONNREFUSED;
  }
  return std::nullopt;
}

}  // namespace tactus::net
