// SPDX-License-Identifier: Apache-2.0
/// Any bytes as packets: two bytes of length, then a packet, again and again.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

namespace tactus {

/// Feeds the packets to a decoder. Whatever they hold, refused ones must leave no trace, not even in baselines, and say which rule they
/// break; `check(packet)` looks at what an accepted one decoded to.
///   twin  made like `decoder`, sees accepted packets only
template <class Decoder, class Check>
void decode_packets(std::span<const std::uint8_t> data, Decoder& decoder, Decoder& twin, Check check) {
  for (std::size_t at = 0; at + 2 <= data.size();) {
    const std::size_t length = std::min<std::size_t>(data[at] | (data[at + 1] & 3u) << 8, data.size() - at - 2);
    const auto bytes = data.subspan(at + 2, length);
    const std::vector<std::uint8_t> packet(bytes.begin(), bytes.end());  // of its exact size, for the sanitizer
    at += 2 + length;
    const std::uint64_t before = decoder.state_hash();
    const auto decoded = decoder.decode(packet);
    if (!decoded) {
      if (decoded.error().rule[0] != 'R' || decoded.error().bit_offset > 8 * packet.size()) std::abort();
      if (decoder.state_hash() != before) std::abort();
      continue;
    }
    const auto same = twin.decode(packet);
    if (!same || same->final_code != decoded->final_code || twin.state_hash() != decoder.state_hash()) std::abort();
    check(*decoded);
  }
}

}  // namespace tactus
