// SPDX-License-Identifier: Apache-2.0
/// A user of the component seal: two ends in one program agree on keys, and a datagram goes through.
#include <tactus/seal/seal_client.h>
#include <tactus/seal/seal_server.h>

#include <cstdio>
#include <string>

int main() {
  const std::string text = "tactus key 1\nname consumer\nsecret " + std::string(64, '5') + "\n";
  const auto here = tactus::net::Address::parse("192.0.2.1:4000");
  auto server = tactus::seal::Server::create(tactus::seal::Key::parse(text, "key").value(), 0);
  auto client = tactus::seal::Client::create(tactus::seal::Key::parse(text, "key").value(), 0);
  if (!here || !server || !client) return 1;
  for (int i = 0; i < 10 && !client->is_open(); ++i) {
    while (const auto message = client->poll_datagram()) server->open(0, *here, *message);
    server->work(0);
    while (const auto message = server->poll_datagram())
      if (!client->open(0, message->bytes)) return 1;
  }
  const std::uint8_t plain[]{1, 2, 3};
  const auto sealed = client->seal(plain);
  const auto opened = sealed ? server->open(0, *here, *sealed) : std::nullopt;
  if (!opened || opened->plain.size() != 3) {
    std::puts("the seal does not open");
    return 1;
  }
  std::printf("%zu bytes of seal\n", sealed->size() - 3);
  return 0;
}
