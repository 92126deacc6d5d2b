// SPDX-License-Identifier: Apache-2.0
/// Sockets and captures.
#include <gtest/gtest.h>

#include <poll.h>
#include <array>
#include <cerrno>
#include <cstdint>
#include <sstream>
#include <string>
#include <vector>

#include <tactus/net/pcap.h>
#include <tactus/net/udp.h>

namespace tactus::net {
namespace {

// ==== pcap ====

const Ipv4Endpoint kClient{{198, 51, 100, 1}, 0xc000}, kServer{{192, 0, 2, 1}, 7447};
constexpr std::size_t kFileHead = 24, kRecordHead = 16, kIpHead = 20, kUdpHead = 8;

using Bytes = std::vector<std::uint8_t>;

Bytes written(std::uint64_t time, const Bytes& datagram) {
  std::ostringstream out;
  PcapWriter writer = PcapWriter::create(out).value();
  EXPECT_TRUE(writer.add(time, kClient, kServer, datagram));
  const std::string text = out.str();
  return {text.begin(), text.end()};
}

Bytes part(const Bytes& bytes, std::size_t at, std::size_t size = SIZE_MAX) {
  const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(at);
  return {begin, size == SIZE_MAX ? bytes.end() : begin + static_cast<std::ptrdiff_t>(size)};
}

std::size_t network(const Bytes& bytes, std::size_t at) { return std::size_t{bytes[at]} << 8 | bytes[at + 1]; }

/// What a receiver computes over words and their checksum: 0 if it holds (RFC 1071).
unsigned remainder_of(Bytes bytes) {
  if (bytes.size() % 2 == 1) bytes.push_back(0);
  unsigned sum = 0;
  for (std::size_t i = 0; i < bytes.size(); i += 2) sum += static_cast<unsigned>(network(bytes, i));
  while (sum > 0xffff) sum = (sum & 0xffff) + (sum >> 16);
  return 0xffff - sum;
}

TEST(Pcap, HeadOfTheFileAndOfARecord) {
  const Bytes file = written(1'500'000'000'123'456, {7});
  const Bytes head{0xd4, 0xc3, 0xb2, 0xa1, 2, 0, 4, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff, 0, 0, 101, 0, 0, 0};
  EXPECT_EQ(part(file, 0, kFileHead), head);
  const Bytes record{0x00, 0x2f, 0x68, 0x59, 0x40, 0xe2, 0x01, 0,
                     29,   0,    0,    0,    29,   0,    0,    0};  // 1500000000 s, 123456 us, 29 bytes twice
  EXPECT_EQ(part(file, kFileHead, kRecordHead), record);
  EXPECT_EQ(file.size(), kFileHead + kRecordHead + 29);
}

TEST(Pcap, PacketsNameTheirEndsAndSizesAndTheirChecksumsHold) {
  Bytes datagram;
  for (std::size_t size = 0; size < 40; ++size, datagram.push_back(static_cast<std::uint8_t>(251 * size))) {
    const Bytes packet = part(written(0, datagram), kFileHead + kRecordHead), udp = part(packet, kIpHead);
    EXPECT_EQ(packet[0], 0x45);
    EXPECT_EQ(packet[9], 17) << "UDP";
    EXPECT_EQ(network(packet, 2), packet.size());
    EXPECT_EQ(part(packet, 12, 8), (Bytes{198, 51, 100, 1, 192, 0, 2, 1}));
    EXPECT_EQ(remainder_of(part(packet, 0, kIpHead)), 0u);
    EXPECT_EQ(network(udp, 0), 0xc000u);
    EXPECT_EQ(network(udp, 2), 7447u);
    EXPECT_EQ(network(udp, 4), kUdpHead + size);
    EXPECT_EQ(part(udp, kUdpHead), datagram);
    Bytes covered = part(packet, 12, 8);  // the pseudo head, then the datagram
    for (const std::size_t byte : {std::size_t{0}, std::size_t{17}, std::size_t{0}, udp.size()})
      covered.push_back(static_cast<std::uint8_t>(byte));
    covered.insert(covered.end(), udp.begin(), udp.end());
    EXPECT_EQ(remainder_of(covered), 0u) << size;
  }
}

TEST(Pcap, AChecksumOfZeroIsWrittenAsOnes) {
  // The two bytes that make the sum of all words 0xffff: the checksum would be 0, which means that there is none.
  const Bytes packet = part(written(0, {0, 0}), kFileHead + kRecordHead);
  const std::size_t checksum = network(packet, kIpHead + 6);
  const Bytes again =
      part(written(0, {static_cast<std::uint8_t>(checksum >> 8), static_cast<std::uint8_t>(checksum)}), kFileHead + kRecordHead);
  EXPECT_EQ(network(again, kIpHead + 6), 0xffffu);
}

TEST(Pcap, PacketsAreCounted) {
  std::ostringstream out;
  PcapWriter writer = PcapWriter::create(out).value();
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(writer.add(0, kClient, kServer, Bytes{1, 2}));
  const std::string text = out.str();
  const Bytes file(text.begin(), text.end());
  const std::size_t size = kRecordHead + kIpHead + kUdpHead + 2;
  ASSERT_EQ(file.size(), kFileHead + 3 * size);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(network(file, kFileHead + i * size + kRecordHead + 4), i);
}

TEST(Pcap, WhatDoesNotFitIsRefusedAndNothingIsWritten) {
  std::ostringstream out;
  PcapWriter writer = PcapWriter::create(out).value();
  EXPECT_STREQ(writer.add(0, kClient, kServer, Bytes(65508)).error().rule, "R-NET-3");
  EXPECT_EQ(writer.add(1'000'000ULL << 32, kClient, kServer, {}).error().code, Errc::invalid_argument);
  EXPECT_EQ(out.str().size(), kFileHead);
  EXPECT_TRUE(writer.add((1'000'000ULL << 32) - 1, kClient, kServer, Bytes(65507)));
}

TEST(Pcap, AFullDiskIsReported) {
  std::ostringstream out;
  PcapWriter writer = PcapWriter::create(out).value();
  out.setstate(std::ios::badbit);
  EXPECT_EQ(writer.add(0, kClient, kServer, {}).error().code, Errc::io);
  EXPECT_EQ(PcapWriter::create(out).error().code, Errc::io);
}

// ==== udp ====

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
  EXPECT_EQ(at("127.0.0.1:4000").port(), 4000);
  EXPECT_EQ(at("[2001:db8::1]:65535").port(), 65535);
  EXPECT_TRUE(at("[::1]:0").is_ipv6());
  EXPECT_FALSE(at("127.0.0.1:0").is_ipv6());
}

TEST(Udp, WhatIsNoAddressIsRefused) {
  for (const char* text : {"", ":", ":4000", "4000", "127.0.0.1", "127.0.0.1:", "127.0.0.1:65536", "127.0.0.1:-1", "127.0.0.1: 1",
                           "127.0.0.1:1x", "::1:4000", "[::1:4000", "[]:4000", "[::1]4000", "256.0.0.1:1", "a b:1"}) {
    const auto address = Address::parse(text);
    ASSERT_FALSE(address) << text;
    EXPECT_STREQ(address.error().rule, "R-NET-1") << text;
  }
}

TEST(Udp, AnUnknownHostHasTheFormOfAnAddress) {
  for (const char* text : {"no-such-host.invalid:1", "256.0.0.1:1", "a b:1"}) EXPECT_TRUE(Address::has_form(text)) << text;
  for (const char* text : {"host", "::1:4000", "host:65536", "host:", "[::1]4000"}) EXPECT_FALSE(Address::has_form(text)) << text;
}

TEST(Udp, WhatFindsNoRoomIsDroppedAndCounted) {
  UdpSocket server = any_port(), client = UdpSocket::connect(server.own()).value();
  EXPECT_GE(server.ask_room(1 << 16), std::size_t{1} << 16);
  const std::vector<std::uint8_t> datagram(1000);
  constexpr std::uint64_t kSent = 1000;
  for (std::uint64_t i = 0; i < kSent; ++i) client.send(datagram);
  std::array<std::uint8_t, 2000> buffer{};
  std::uint64_t received = 0;
  while (server.receive(buffer)) ++received;
  EXPECT_GT(received, 10u);
  EXPECT_EQ(received + server.dropped(), kSent);
  EXPECT_GT(server.dropped(), 0u);
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
  const Address address = server->own();
  server.reset();
  for (int i = 0; i < 10; ++i) static_cast<void>(client.send(bytes_of("x")));
  std::array<std::uint8_t, 10> buffer{};
  EXPECT_FALSE(client.receive(buffer));
  EXPECT_TRUE(client.is_refused());
  UdpSocket again = UdpSocket::bind(address).value();
  while (!client.send(bytes_of("back"))) {
  }
  Address from;
  EXPECT_EQ(wait_for(again, &from), "back");
  again.send(from, bytes_of("here"));
  EXPECT_EQ(wait_for(client), "here");
  EXPECT_FALSE(client.is_refused()) << "somebody listens now";
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
