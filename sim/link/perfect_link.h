// SPDX-License-Identifier: Apache-2.0
/// The network between a client and the server: this one takes no time and loses nothing.
#pragma once

#include <span>

#include <tactus/base/geometry.h>
#include <tactus/packet/packet.h>

namespace tactus::sim {

class PerfectLink {
 public:
  /// Device samples as the server receives them.
  std::span<const DeviceSample> to_server(std::span<const DeviceSample> devices) const noexcept { return devices; }
  /// Packets as the client receives them.
  std::span<const Packet> to_client(std::span<const Packet> packets) const noexcept { return packets; }
};

}  // namespace tactus::sim
