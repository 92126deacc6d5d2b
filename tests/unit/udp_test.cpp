// SPDX-License-Identifier: Apache-2.0
#include <tactus/net/udp.h>

#include <gtest/gtest.h>
#include <poll.h>

#include <array>
#include <cerrno>
#include <string>
#include <vector>

namespace tactus::net {
namespace {

Address at(const std::string& text) { return Address::parse(text).value(); }
UdpSocket any_port() { return UdpSocket::bind(at("127.0.0.1:0")).value(); }

std::string wait_for(UdpSocket& socket, Address* from = nullptr) {
  std::array<std::uint8_t, 2000> buffer{};
  pollfd handle{socket.handle(), POLLIN, 0};
  EXPECT_EQ(poll(&handle, 1, 10'000), 1);
  const auto received = socket.receive(buffer);
  if (!received) return "nothing";
  if (from != nullptr) *from = received->from;
  return {received->bytes.begin(), received->bytes.end()};
}

std::vector<std::uint8_t> bytes_of(const std::string& text) { return {text.begin(), text.end()}; }

TEST(Udp, AddressesReadBackAsWritten) {
  for (const char* text : {"127.0.0.1:4000", "127.255.0.1:65535", "[::1]:0", "192.0.2.1:53"}) EXPECT_EQ(at(text).text(), text);
  EXPECT_EQ(at("localhost:7").is_loopback(), true);
  EXPECT_TRUE(at("127.255.0.1:1").is_loopback());
  EXPECT_TRUE(at("[::1]:1").is_loopback());
  for (const char* text : {"192.0.2.1:1", "0.0.0.0:1", "[::]:1", "[2001:db8::1]:1"}) EXPECT_FALSE(at(text).is_loopback()) << text;
  EXPECT_EQ(at("127.0.0.1:4000"), at("127.0.0.1:4000"));
  EXPECT_FALSE(at("127.0.0.1:4000") == at("127.0.0.1:4001"));
  EXPECT_EQ(Address().text(), "nowhere");
}

TEST(Udp, WhatIsNoAddressIsRefused) {
  for (const char* text : {"", ":", ":4000", "4000", "127.0.0.1", "127.0.0.1:", "127.0.0.1:65536", "127.0.0.1:-1", "127.0.0.1: 1",
                           "127.0.0.1:1x", "::1:4000", "[::1:4000", "[]:4000", "[::1]4000", "256.0.0.1:1", "a b:1"}) {
    const auto address = Address::parse(text);
    ASSERT_FALSE(address) << text;
    EXPECT_STREQ(address.error().rule, "R-NET-1") << text;
  }
}

TEST(Udp, DatagramsGoThereAndBack) {
  UdpSocket server = any_port(), client = UdpSocket::connect(server.own()).value();
  EXPECT_TRUE(client.send(bytes_of("hello")));
  EXPECT_TRUE(client.send({}));
  Address from;
  EXPECT_EQ(wait_for(server, &from), "hello");
  EXPECT_EQ(from, client.own());
  EXPECT_EQ(wait_for(server), "") << "an empty datagram is one";
  EXPECT_TRUE(server.send(from, bytes_of("yes")));
  EXPECT_EQ(wait_for(client), "yes");
  std::array<std::uint8_t, 10> buffer{};
  EXPECT_FALSE(client.receive(buffer)) << "nothing waits, and nobody waits for it";
}

TEST(Udp, AConnectedSocketHearsItsPeerOnly) {
  UdpSocket server = any_port(), stranger = any_port(), client = UdpSocket::connect(server.own()).value();
  EXPECT_TRUE(stranger.send(client.own(), bytes_of("forged")));
  EXPECT_TRUE(server.send(client.own(), bytes_of("true")));
  EXPECT_EQ(wait_for(client), "true");
}

TEST(Udp, WhereNobodyListensIsALossAndNoEnd) {
  std::optional<UdpSocket> server = any_port();
  UdpSocket client = UdpSocket::connect(server->own()).value();
  const Address place = server->own();
  server.reset();
  for (int i = 0; i < 10; ++i) static_cast<void>(client.send(bytes_of("x")));
  std::array<std::uint8_t, 10> buffer{};
  EXPECT_FALSE(client.receive(buffer));
  UdpSocket again = UdpSocket::bind(place).value();
  while (!client.send(bytes_of("back"))) {
  }
  EXPECT_EQ(wait_for(again), "back");
}

TEST(Udp, APortThatIsTakenIsRefused) {
  const UdpSocket first = any_port();
  const auto second = UdpSocket::bind(first.own());
  ASSERT_FALSE(second);
  EXPECT_STREQ(second.error().rule, "R-NET-2");
  EXPECT_EQ(errno, EADDRINUSE);
}

TEST(Udp, TooLongADatagramIsNotSent) {
  UdpSocket server = any_port(), client = UdpSocket::connect(server.own()).value();
  EXPECT_FALSE(client.send(std::vector<std::uint8_t>(70'000)));
}

}  // namespace
}  // namespace tactus::net
