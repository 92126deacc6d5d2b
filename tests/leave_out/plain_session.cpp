// SPDX-License-Identifier: Apache-2.0
/// What a program needs for sessions over UDP; with SEALED also what seals them. It is linked and looked at, and not run.
#include <tactus/net/udp.h>
#include <tactus/session/session_client.h>

#ifdef SEALED
#include <tactus/seal/seal_client.h>
#endif

int main(int argc, char** argv) {
  const auto address = tactus::net::Address::parse(argc > 1 ? argv[1] : "");
  if (!address) return 1;
  auto socket = tactus::net::UdpSocket::connect(*address);
  auto session = tactus::SessionClient::create({});
  if (!socket || !session) return 1;
  session->open(0, 1);
  const auto datagram = session->poll_datagram(0);
  if (!datagram) return 1;
#ifdef SEALED
  auto key = tactus::seal::Key::generate("test");
  auto seal = tactus::seal::Client::create(std::move(*key), 0);
  return seal && seal->is_open() && socket->send(seal->seal(*datagram).value()) ? 0 : 1;
#else
  return socket->send(*datagram) ? 0 : 1;
#endif
}
