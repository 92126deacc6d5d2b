// SPDX-License-Identifier: Apache-2.0
/// What senders of datagrams may make a server do, before it looks into what they send: functions of time. spec/70-session.md section 11.6.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <tactus/net/udp.h>

namespace tactus::net {

/// Datagrams and bytes per second. Each may be saved up for one second.
struct Rate {
  std::uint32_t datagrams = 0, bytes = 0;
};

// The server's own. A device at 1 kHz sends at most 2000 datagrams per second; a network that stands still for a second hands them over
// at once. Handling one costs 0.3 to 5 us, so a client can take some 2 % of a core, and all strangers together as much. Dropping one costs
// 0.02 us.
inline constexpr Rate kClientRate{5000, 4'000'000};
inline constexpr Rate kHandshakeRate{200, 100'000};     ///< of an address whose handshake goes on: it takes ten
inline constexpr Rate kHostRate{1000, 400'000};         ///< of a host without a client
inline constexpr Rate kStrangersRate{5000, 2'000'000};  ///< of all hosts without a client

/// Two buckets that fill with time: one for datagrams, one for bytes. 24 bytes, some ns.
class RateLimit {
 public:
  /// Take a datagram, or only count it.   in  now  [us]
  bool take(std::uint64_t now, std::size_t bytes, const Rate& rate) noexcept;
  std::uint64_t dropped() const noexcept { return dropped_; }

 private:
  std::uint64_t dropped_ = 0;
  std::uint64_t datagrams_paid_ = 0, bytes_paid_ = 0;  // [us] until when what was taken is paid
};

/// All senders without a client: a limit for each host, one for them all. Hosts whose secret hashes are the same share theirs, so a host
/// that floods keeps out one in 256 others. 6 kB, whoever sends; some 10 ns.
class StrangersLimit {
 public:
  /// in   secret  64 bits from the system, that nobody else can guess: else hosts could be chosen that share the limit of another one
  explicit StrangersLimit(std::uint64_t secret) : secret_(secret), hosts_(kHosts) {}
  /// in   now  [us]
  bool take(std::uint64_t now, const Address& from, std::size_t bytes) noexcept;

 private:
  static constexpr std::size_t kHosts = 256;
  std::uint64_t secret_;
  std::vector<RateLimit> hosts_;
  RateLimit all_;
};

}  // namespace tactus::net
