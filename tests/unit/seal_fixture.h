// SPDX-License-Identifier: Apache-2.0
/// Two ends of the seal in memory, with a network between them that a test can tamper with. Time is virtual.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <tactus/seal/seal_client.h>
#include <tactus/seal/seal_server.h>

namespace tactus::testing {

using Bytes = std::vector<std::uint8_t>;

inline net::Address address(const std::string& text) { return net::Address::parse(text).value(); }
inline Bytes bytes_of(std::string_view text) { return {text.begin(), text.end()}; }
inline Bytes bytes_of(std::span<const std::uint8_t> bytes) { return {bytes.begin(), bytes.end()}; }

/// The key "lab" whose secret repeats one byte.
inline seal::Key key_of(const std::string& name = "lab", const std::string& byte = "5a") {
  std::string text = "tactus key 1\nname " + name + "\nsecret ";
  for (std::size_t i = 0; i < seal::Key::kSecret; ++i) text += byte;
  return seal::Key::parse(text + "\n", "test").value();
}

struct SealPair {
  /// What becomes of a datagram: the copies that arrive, none for a loss.
  using Network = std::function<std::vector<Bytes>(const Bytes&)>;

  explicit SealPair(seal::Key client_key = key_of(), const seal::ServerOptions& options = {}, const seal::Limits& limits = {})
      : server(seal::Server::create(key_of(), now, options).value()),
        client(seal::Client::create(std::move(client_key), now, limits).value()) {}

  /// Everything that is on its way arrives.
  void flow() {
    for (int i = 0; i < 20; ++i) {
      while (const auto datagram = client.poll_datagram()) up(bytes_of(*datagram));
      server.work(now);
      drain();
    }
  }
  void up(const Bytes& datagram) {
    largest_up = std::max(largest_up, datagram.size());
    for (const Bytes& copy : network_up(datagram)) {
      if (const auto opened = server.open(now, at, copy)) {
        peer = opened->peer;
        heard_up.push_back(bytes_of(opened->plain));
      }
      drain();
    }
  }
  void drain() {
    while (const auto datagram = server.poll_datagram()) {
      largest_down = std::max(largest_down, datagram->bytes.size());
      EXPECT_EQ(datagram->to, at);
      for (const Bytes& copy : network_down(bytes_of(datagram->bytes))) down(copy);
    }
  }
  void down(const Bytes& datagram) {
    const auto opened = client.open(now, datagram);
    if (!opened) error = opened.error().rule;
    else if (*opened) heard_down.push_back(bytes_of(**opened));
  }
  /// Let time pass until the client is open, has failed or `most` microseconds are over.
  void run(std::uint64_t most = 20'000'000) {
    for (const std::uint64_t end = now + most; now < end && !client.is_open() && error.empty(); now += 10'000) {
      if (const auto done = client.handle_timeout(now); !done) error = done.error().rule;
      flow();
    }
  }
  bool say_up(std::string_view text) {
    const auto sealed = client.seal(bytes_of(text));
    if (sealed) up(bytes_of(*sealed));
    return sealed.has_value();
  }
  Bytes sealed_up(std::string_view text) { return bytes_of(client.seal(bytes_of(text)).value()); }
  Bytes sealed_down(std::string_view text) { return bytes_of(server.seal(peer, bytes_of(text)).value().bytes); }

  std::uint64_t now = 5'000'000;
  seal::Server server;
  seal::Client client;
  net::Address at = address("192.0.2.7:4000");
  Network network_up = [](const Bytes& datagram) { return std::vector<Bytes>{datagram}; };
  Network network_down = network_up;
  std::vector<Bytes> heard_up, heard_down;
  std::uint64_t peer = 0;
  std::size_t largest_up = 0, largest_down = 0;
  std::string error;
};

}  // namespace tactus::testing
