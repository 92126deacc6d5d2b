// SPDX-License-Identifier: Apache-2.0
/// The network between a client and the server: this one takes no time and loses nothing.
#pragma once

#include <span>

#include <tactus/base/device_sample.h>
#include <tactus/packet/packet.h>

namespace tactus::sim {

class PerfectLink {
 public:
  /// What the devices reported, as the server gets to know it.
  std::span<const DeviceSample> to_server(std::span<const DeviceSample> devices) const noexcept { return devices; }
  /// What the server sent, as the client receives it.
  std::span<const Packet> to_client(std::span<const Packet> packets) const noexcept { return packets; }
};

}  // namespace tactus::sim
