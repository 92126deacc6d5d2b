// SPDX-License-Identifier: Apache-2.0
/// Capture files that Wireshark, tcpdump and their like open: classic pcap, version 2.4, little-endian, with time stamps in microseconds.
/// Each record is an IPv4 packet (link type 101, raw IP) with one UDP datagram and both checksums.
#pragma once

#include <array>
#include <cstdint>
#include <iosfwd>
#include <span>
#include <vector>

#include <tactus/base/result.h>

namespace tactus::net {

/// An end of UDP over IPv4, for a capture that no socket took part in.
struct Ipv4Endpoint {
  std::array<std::uint8_t, 4> host{};
  std::uint16_t port = 0;
};

class PcapWriter {
 public:
  /// Write the head of the file.   in  out  must outlive the writer;   err  io R-NET-3
  static Result<PcapWriter> create(std::ostream& out);

  /// One datagram. Its IP packet is not fragmented; records keep the order of the calls.
  /// in   time  [us] below 2^32 s, since 1970 for those who show dates
  /// err  io R-NET-3; invalid_argument R-NET-3: a time that does not fit, more than 65507 bytes
  Result<void> add(std::uint64_t time, const Ipv4Endpoint& from, const Ipv4Endpoint& to, std::span<const std::uint8_t> datagram);

 private:
  explicit PcapWriter(std::ostream& out) : out_(&out) {}
  Result<void> put_record();

  std::ostream* out_;
  std::vector<std::uint8_t> record_;
  std::uint16_t identification_ = 0;  // of IP packets: counts them
};

}  // namespace tactus::net
