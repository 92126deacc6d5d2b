// SPDX-License-Identifier: Apache-2.0
#include <tactus/net/pcap.h>

#include <cstddef>
#include <ostream>

#include <tactus/base/bytes.h>
#include <tactus/base/rule.h>

namespace tactus::net {
namespace {

// The head of the file and of its records: draft-ietf-opsawg-pcap, sections 4 and 5.
constexpr std::uint32_t kMagic = 0xa1b2c3d4;  // time stamps in microseconds
constexpr std::uint16_t kMajor = 2, kMinor = 4;
constexpr std::uint32_t kSnapLength = 65535, kLinkTypeRaw = 101;
constexpr std::size_t kRecordHead = 16, kIpHead = 20, kUdpHead = 8;
constexpr std::size_t kLargest = 65535 - kIpHead - kUdpHead;
constexpr std::uint64_t kSecond = 1'000'000, kTimeLimit = kSecond << 32;

// RFC 791 and RFC 768.
constexpr std::uint8_t kVersionAndLength = 0x45, kDontFragment = 0x40, kTimeToLive = 64, kUdp = 17;
constexpr std::size_t kIpChecksum = 10, kAddresses = 12, kUdpChecksum = 6;  // where in the packet, in the datagram

void put_network(ByteWriter& to, std::size_t value) {
  to.u8(static_cast<std::uint8_t>(value >> 8));
  to.u8(static_cast<std::uint8_t>(value));
}

/// Sum of 16-bit words in network order; an odd byte at the end is the upper half of one.
std::uint32_t sum_of(std::span<const std::uint8_t> bytes) noexcept {
  std::uint32_t sum = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) sum += i % 2 == 0 ? std::uint32_t{bytes[i]} << 8 : bytes[i];
  return sum;
}

/// RFC 1071.
std::uint16_t checksum_of(std::uint32_t sum) noexcept {
  while (sum >> 16 != 0) sum = (sum & 0xffff) + (sum >> 16);
  return static_cast<std::uint16_t>(~sum);
}

void set_network(std::span<std::uint8_t> at, std::uint16_t value) noexcept {
  at[0] = static_cast<std::uint8_t>(value >> 8);
  at[1] = static_cast<std::uint8_t>(value);
}

void set_checksums(std::span<std::uint8_t> packet) noexcept {
  set_network(packet.subspan(kIpChecksum), checksum_of(sum_of(packet.first(kIpHead))));
  const auto udp = packet.subspan(kIpHead);
  const std::uint32_t pseudo = sum_of(packet.subspan(kAddresses, 8)) + kUdp + static_cast<std::uint32_t>(udp.size());
  const std::uint16_t checksum = checksum_of(pseudo + sum_of(udp));
  set_network(udp.subspan(kUdpChecksum), checksum == 0 ? 0xffff : checksum);  // 0 would mean: none
}

}  // namespace

Result<PcapWriter> PcapWriter::create(std::ostream& out) {
  PcapWriter writer(out);
  ByteWriter w(writer.record_);
  w.u32(kMagic);
  w.u16(kMajor);
  w.u16(kMinor);
  w.u32(0);  // time zone
  w.u32(0);  // accuracy of time stamps: not stated
  w.u32(kSnapLength);
  w.u32(kLinkTypeRaw);
  TACTUS_CHECK(writer.put_record());
  return writer;
}

Result<void> PcapWriter::add(std::uint64_t time, const Ipv4Endpoint& from, const Ipv4Endpoint& to,
                             std::span<const std::uint8_t> datagram) {
  if (time >= kTimeLimit || datagram.size() > kLargest) return fail(Errc::invalid_argument, "R-NET-3");
  const std::size_t udp_size = kUdpHead + datagram.size(), ip_size = kIpHead + udp_size;
  record_.clear();
  ByteWriter w(record_);
  w.u32(static_cast<std::uint32_t>(time / kSecond));
  w.u32(static_cast<std::uint32_t>(time % kSecond));
  w.u32(static_cast<std::uint32_t>(ip_size));  // in the file
  w.u32(static_cast<std::uint32_t>(ip_size));  // on the wire

  w.u8(kVersionAndLength);
  w.u8(0);
  put_network(w, ip_size);
  put_network(w, identification_++);
  w.u8(kDontFragment);
  w.u8(0);
  w.u8(kTimeToLive);
  w.u8(kUdp);
  put_network(w, 0);  // checksum
  w.bytes(from.host);
  w.bytes(to.host);

  put_network(w, from.port);
  put_network(w, to.port);
  put_network(w, udp_size);
  put_network(w, 0);  // checksum
  w.bytes(datagram);
  set_checksums(std::span(record_).subspan(kRecordHead));
  return put_record();
}

Result<void> PcapWriter::put_record() {
  out_->write(reinterpret_cast<const char*>(record_.data()), static_cast<std::streamsize>(record_.size()));
  if (!*out_) return fail(Errc::io, "R-NET-3");
  return {};
}

}  // namespace tactus::net
