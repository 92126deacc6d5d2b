// SPDX-License-Identifier: Apache-2.0
/// Data rates of a stream.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <tactus/packet/packet.h>

namespace tactus {

/// Packets of the rigid objects.
struct RateMetrics {
  std::array<std::uint64_t, 4> packets{};  ///< by strongest reason; index: Reason
  std::uint64_t updates = 0;
  std::uint64_t bytes = 0;  ///< of packets, without any header below them
  std::uint64_t keys = 0;

  void add(Reason reason, std::uint64_t update_count, std::uint64_t byte_count, bool key) noexcept;
  std::uint64_t all_packets() const noexcept { return packets[0] + packets[1] + packets[2] + packets[3]; }
};

/// Strongest reason among the updates of a packet.
Reason strongest_reason(const DecodedPacket& packet) noexcept;

/// Packets of loads.
struct LoadRates {
  std::uint64_t packets = 0, updates = 0, bytes = 0;  ///< updates: objects named; bytes as above

  void add(std::size_t packet_bytes, std::uint64_t objects) noexcept {
    ++packets;
    updates += objects;
    bytes += packet_bytes;
  }
};

/// Packets of one deformable object.
struct DeformableRates {
  std::uint64_t frames = 0;          ///< shapes evaluated; 0: unknown
  std::uint64_t updates = 0;         ///< vertices with a residual of their own
  std::uint64_t keys = 0;            ///< key packets
  std::uint64_t bytes = 0;           ///< of packets, with their substreams' numbers, without any header below them
  std::vector<std::uint32_t> sizes;  ///< of every packet [bytes]
  struct OfLayer {
    std::uint64_t packets = 0, bytes = 0;
  };
  std::array<OfLayer, 2> layers{};  ///< index: Layer; of packets known to be of one

  void add(std::size_t packet_bytes, std::uint64_t update_count, bool key, Layer layer);
  std::uint32_t quantile(double fraction) const;  ///< of the packets' sizes [bytes]; 1: the largest, 0 without packets
};

}  // namespace tactus
