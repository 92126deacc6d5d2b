// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include <tactus/net/udp.h>

namespace tactus::cli {

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

}  // namespace tactus::cli
