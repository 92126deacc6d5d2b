// SPDX-License-Identifier: Apache-2.0
/// Any bytes as packets: two bytes of length, then a packet, again and again.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "tests/fuzz/require.h"

namespace tactus {

/// A refused packet says which rule it breaks, and leaves no trace, not even in baselines (but for R-PKT-7).
template <class Decoder>
auto decode_packet(Decoder& decoder, std::span<const std::uint8_t> packet) {
  const std::uint64_t before = decoder.state_hash();
  auto decoded = decoder.decode(packet);
  if (!decoded) {
    require(decoded.error().rule[0] == 'R' && decoded.error().bit_offset <= 8 * packet.size());
    require(decoder.state_hash() == before);
  }
  return decoded;
}

/// Feeds the packets to a decoder; `check(packet)` looks at what an accepted one decoded to.
///   twin  made like `decoder`, sees accepted packets and those that make a decoder forget
template <class Decoder, class Check>
void decode_packets(std::span<const std::uint8_t> data, Decoder& decoder, Decoder& twin, Check check) {
  for (std::size_t at = 0; at + 2 <= data.size();) {
    const std::size_t length = std::min<std::size_t>(data[at] | (data[at + 1] & 3u) << 8, data.size() - at - 2);
    const auto bytes = data.subspan(at + 2, length);
    const std::vector<std::uint8_t> packet(bytes.begin(), bytes.end());  // of its exact size, for the sanitizer
    at += 2 + length;
    const auto decoded = decode_packet(decoder, packet);
    if (!decoded) {
      if (std::string_view(decoded.error().rule) == "R-PKT-7") (void)twin.decode(packet);  // it takes the baselines away
      continue;
    }
    const auto same = twin.decode(packet);
    require(same && same->final_code == decoded->final_code && twin.state_hash() == decoder.state_hash());
    check(*decoded);
  }
}

}  // namespace tactus
