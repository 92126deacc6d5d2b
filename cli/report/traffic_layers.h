// SPDX-License-Identifier: Apache-2.0
/// What an end of a session sends, layer by layer.
#pragma once

#include <cstddef>

#include <tactus/session/session_options.h>
#include "cli/report/figures.h"

namespace tactus::cli {

struct TrafficLayers {
  double packets, datagrams;               ///< [1/s]
  double payload, session, seal, headers;  ///< [bit/s]; headers of UDP and IPv4
  double all() const noexcept { return payload + session + seal + headers; }
};

/// in   overhead  of the seal around each datagram [bytes], 0: there is none
inline TrafficLayers sent_layers(const Traffic& traffic, double seconds, std::size_t overhead = 0) {
  const auto rate = [seconds](std::uint64_t amount) { return per(static_cast<double>(amount), seconds); };
  return {.packets = rate(traffic.packets_sent),
          .datagrams = rate(traffic.datagrams_sent),
          .payload = 8 * rate(traffic.payload_sent),
          .session = 8 * rate(traffic.bytes_sent - traffic.payload_sent),
          .seal = 8 * rate(overhead * traffic.datagrams_sent),
          .headers = 8 * rate(kUdpHeader * traffic.datagrams_sent)};
}

}  // namespace tactus::cli
