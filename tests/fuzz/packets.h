// SPDX-License-Identifier: Apache-2.0
/// Any bytes as packets: two bytes of length, then a packet, again and again.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <tactus/base/bytes.h>
#include <tactus/packet/substream.h>
#include <tactus/receiver.h>
#include "tests/fuzz/require.h"

namespace tactus {

/// What is held of a substream, and shown of the rigid objects.
inline std::uint64_t held(Receiver& receiver, std::size_t substream) {
  Fnv1a hash;
  hash.add64(receiver.state_hash(substream));
  hash.add64(receiver.replica().pose_hash(receiver.tick(0)));
  return hash.value();
}

/// A refused packet says which rule it breaks, and leaves no trace, not even in baselines (but for R-PKT-7).
inline Result<DecodedPacket> push_packet(Receiver& receiver, std::span<const std::uint8_t> packet,
                                         std::optional<std::int64_t> now = {}) {
  const auto part = split_substream(*receiver.scene(), packet);
  const std::size_t substream = part ? part->substream : 0;
  const std::uint64_t before = held(receiver, substream);
  const auto decoded = receiver.push(packet, now);
  if (decoded) {
    require(part && decoded->substream == substream);
    require(decoded->tick <= receiver.tick(substream));  // it may be reordered
  } else {
    require(decoded.error().rule[0] == 'R' && decoded.error().bit_offset <= 8 * packet.size());
    require(held(receiver, substream) == before);
  }
  return decoded;
}

/// Feeds the packets to a receiver; `check(packet)` looks at what an accepted one decoded to.
///   twin  made like `receiver`, sees accepted packets and those that make a receiver forget
template <class Check>
void push_packets(std::span<const std::uint8_t> data, Receiver& receiver, Receiver& twin, Check check) {
  for (std::size_t at = 0; at + 2 <= data.size();) {
    const std::size_t length = std::min<std::size_t>(data[at] | (data[at + 1] & 3u) << 8, data.size() - at - 2);
    const auto bytes = data.subspan(at + 2, length);
    const std::vector<std::uint8_t> packet(bytes.begin(), bytes.end());  // of its exact size, for the sanitizer
    at += 2 + length;
    const auto decoded = push_packet(receiver, packet);
    if (!decoded) {
      if (std::string_view(decoded.error().rule) == "R-PKT-7") (void)twin.push(packet);  // it takes the baselines away
      continue;
    }
    const auto same = twin.push(packet);
    require(same && same->final_code == decoded->final_code);
    require(held(twin, decoded->substream) == held(receiver, decoded->substream));
    check(*decoded);
  }
}

}  // namespace tactus
