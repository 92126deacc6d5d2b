// SPDX-License-Identifier: Apache-2.0
#include "cli/live/peers.h"

#include <algorithm>

namespace tactus::cli {

std::uint64_t Peers::name(const net::Address& from) {
  newest_ = from;
  return from.key();
}

void Peers::settle(const HasSession& has_session) {
  if (!has_session(newest_.key()) || std::ranges::find(known_, newest_) != known_.end()) return;
  if (known_.size() == most_) std::erase_if(known_, [&](const net::Address& address) { return !has_session(address.key()); });
  if (known_.size() < most_) known_.push_back(newest_);
}

const net::Address* Peers::find(std::uint64_t peer) const {
  const auto found = std::ranges::find(known_, peer, &net::Address::key);
  if (found != known_.end()) return &*found;
  return newest_.key() == peer ? &newest_ : nullptr;
}

}  // namespace tactus::cli
