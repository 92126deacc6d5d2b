// SPDX-License-Identifier: Apache-2.0
#include <tactus/net/pcap.h>

#include <gtest/gtest.h>

#include <cstdint>
#include <sstream>
#include <string>
#include <vector>

namespace tactus::net {
namespace {

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

TEST(Pcap, AFullDiskIsTold) {
  std::ostringstream out;
  PcapWriter writer = PcapWriter::create(out).value();
  out.setstate(std::ios::badbit);
  EXPECT_EQ(writer.add(0, kClient, kServer, {}).error().code, Errc::io);
  EXPECT_EQ(PcapWriter::create(out).error().code, Errc::io);
}

}  // namespace
}  // namespace tactus::net
