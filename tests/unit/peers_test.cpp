// SPDX-License-Identifier: Apache-2.0
#include "cli/live/wire.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace tactus::cli {
namespace {

net::Address at(unsigned port) { return net::Address::parse("127.0.0.1:" + std::to_string(port)).value(); }

struct Sessions {
  std::set<std::uint64_t> peers;
  Peers::HasSession known() {
    return [this](std::uint64_t peer) { return peers.contains(peer); };
  }
};

TEST(Peers, ThoseWithASessionAreFound) {
  Sessions sessions;
  Peers peers(2);
  const std::uint64_t name = peers.name(at(1));
  ASSERT_NE(peers.find(name), nullptr) << "of the newest datagram";
  EXPECT_EQ(*peers.find(name), at(1));
  sessions.peers.insert(name);
  peers.settle(sessions.known());
  static_cast<void>(peers.name(at(2)));
  peers.settle(sessions.known());
  ASSERT_NE(peers.find(name), nullptr);
  EXPECT_EQ(*peers.find(name), at(1));
  static_cast<void>(peers.name(at(3)));
  EXPECT_EQ(peers.find(at(2).key()), nullptr) << "it has none, and another has spoken since";
}

/// Strangers whose joins are answered, but with a refusal.
TEST(Peers, StrangersPushNobodyOut) {
  Sessions sessions;
  Peers peers(2);
  for (const unsigned port : {1u, 2u}) {
    sessions.peers.insert(peers.name(at(port)));
    peers.settle(sessions.known());
  }
  for (unsigned port = 10; port < 1000; ++port) {
    static_cast<void>(peers.name(at(port)));
    peers.settle(sessions.known());
  }
  EXPECT_EQ(peers.size(), 2u);
  for (const unsigned port : {1u, 2u}) {
    ASSERT_NE(peers.find(at(port).key()), nullptr) << port;
    EXPECT_EQ(*peers.find(at(port).key()), at(port));
  }
}

TEST(Peers, WhoLeftMakesRoom) {
  Sessions sessions;
  Peers peers(2);
  for (unsigned port = 1; port < 100; ++port) {
    sessions.peers.insert(peers.name(at(port)));
    peers.settle(sessions.known());
    peers.settle(sessions.known());
    EXPECT_LE(peers.size(), 2u);
    EXPECT_NE(peers.find(at(port).key()), nullptr);
    if (port > 1) sessions.peers.erase(at(port - 1).key());
  }
}

}  // namespace
}  // namespace tactus::cli
