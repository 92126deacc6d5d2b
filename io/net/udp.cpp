// SPDX-License-Identifier: Apache-2.0
#include <tactus/net/udp.h>

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
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
  const bool is_ipv6 = as_sockaddr(bytes_)->sa_family == AF_INET6;
  return (is_ipv6 ? '[' + std::string(host) + ']' : std::string(host)) + ':' + port;
}

std::uint64_t Address::key() const noexcept {
  Fnv1a hash;
  for (std::size_t i = 0; i < size_; ++i) hash.add_byte(bytes_[i]);
  return hash.value() == 0 ? 1 : hash.value();
}

bool Address::is_loopback() const noexcept {
  if (size_ == 0) return false;
  if (as_sockaddr(bytes_)->sa_family == AF_INET6) {
    sockaddr_in6 address{};
    std::memcpy(&address, bytes_, sizeof address);
    return IN6_IS_ADDR_LOOPBACK(&address.sin6_addr);
  }
  sockaddr_in address{};
  std::memcpy(&address, bytes_, sizeof address);
  return ntohl(address.sin_addr.s_addr) >> 24 == 127;
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

UdpSocket::UdpSocket(UdpSocket&& other) noexcept : handle_(std::exchange(other.handle_, -1)) {}

UdpSocket& UdpSocket::operator=(UdpSocket&& other) noexcept {
  std::swap(handle_, other.handle_);
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

bool UdpSocket::send(std::span<const std::uint8_t> datagram) noexcept {
  return ::send(handle_, datagram.data(), datagram.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(datagram.size());
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
      out.from.size_ = size;
      out.bytes = buffer.first(static_cast<std::size_t>(got));
      return out;
    }
    if (errno == EAGAIN || errno == EWOULDBLOCK) return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace tactus::net
