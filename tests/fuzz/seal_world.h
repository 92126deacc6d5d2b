// SPDX-License-Identifier: Apache-2.0
/// A client and a server of the seal in memory, and what must hold whatever is sent to them.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include <tactus/seal/seal_client.h>
#include <tactus/seal/seal_server.h>
#include "tests/fuzz/require.h"

namespace tactus::testing {

using Bytes = std::vector<std::uint8_t>;

inline seal::Key key() {
  static const std::string text = "tactus key 1\nname lab\nsecret " + std::string(64, '7') + "\n";
  return seal::Key::parse(text, "").value();
}

struct World {
  std::uint64_t now = 1'000'000;
  seal::Server server = seal::Server::create(key(), now).value();
  seal::Client client = seal::Client::create(key(), now).value();
  const net::Address home = net::Address::parse("192.0.2.1:1").value(), elsewhere = net::Address::parse("192.0.2.2:2").value();
  Bytes up, down;  // the newest datagrams

  /// Everything arrives.
  void flow() {
    for (int i = 0; i < 6; ++i) {
      while (const auto message = client.poll_datagram()) {
        up.assign(message->begin(), message->end());
        static_cast<void>(server.open(now, home, up));
      }
      server.work(now);
      while (const auto message = server.poll_datagram()) {
        down.assign(message->bytes.begin(), message->bytes.end());
        if (message->to == home) require(client.open(now, down).has_value());
      }
    }
  }
  void hostile_up(const net::Address& from, const Bytes& datagram) {
    require(!server.open(now, from, datagram) || datagram == up);
    std::size_t answered = 0;
    while (const auto message = server.poll_datagram()) answered += message->bytes.size();
    require(answered <= 3 * datagram.size());
  }
  void hostile_down(const Bytes& datagram) {
    const auto opened = client.open(now, datagram);
    require(opened.has_value() && (!*opened || datagram == down));
  }
};

}  // namespace tactus::testing
