// SPDX-License-Identifier: Apache-2.0
#include <tactus/net/rate_limit.h>

#include <algorithm>

namespace tactus::net {
namespace {

constexpr std::uint64_t kSaved = 1'000'000;  // [us] for which a rate may be saved up

}  // namespace

bool RateLimit::take(std::uint64_t now, std::size_t bytes, const Rate& rate) noexcept {
  const auto until = [now](std::uint64_t paid, std::uint64_t cost) { return std::max(paid, now) + cost; };
  const std::uint64_t datagrams = until(datagrams_paid_, 1'000'000 / rate.datagrams),
                      all_bytes = until(bytes_paid_, 1'000'000 * bytes / rate.bytes);
  if (std::max(datagrams, all_bytes) > now + kSaved) {
    ++dropped_;
    return false;
  }
  datagrams_paid_ = datagrams;
  bytes_paid_ = all_bytes;
  return true;
}

bool StrangersLimit::take(std::uint64_t now, const Address& from, std::size_t bytes) noexcept {
  std::uint64_t hash = secret_;
  for (const std::uint8_t byte : from.host()) {  // of splitmix64, a step for each byte
    hash = (hash + byte + 0x9E3779B97F4A7C15) * 0xBF58476D1CE4E5B9;
    hash ^= hash >> 29;
  }
  RateLimit& host = hosts_[(hash ^ secret_ >> 32) % kHosts];
  RateLimit after = host;  // what is left out for the sake of all costs the host nothing
  if (!after.take(now, bytes, kHostRate) || !all_.take(now, bytes, kStrangersRate)) return false;
  host = after;
  return true;
}

}  // namespace tactus::net
