// SPDX-License-Identifier: Apache-2.0
/// Any bytes as packets: two bytes of length, then so many: two of the packet's number, and the packet. Again and again.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
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

/// A refused packet says which rule it breaks, and leaves no trace, not even in baselines.
inline Result<DecodedPacket> push_packet(Receiver& receiver, std::uint64_t number, std::span<const std::uint8_t> packet,
                                         std::optional<std::int64_t> now = {}) {
  const auto part = split_substream(*receiver.scene(), packet);
  const std::size_t substream = part ? part->substream : 0;
  const std::uint64_t before = held(receiver, substream);
  const auto decoded = receiver.push(number, packet, now);
  if (decoded) {
    require(part && decoded->substream == substream && decoded->number == number);
    require(decoded->tick <= receiver.tick(substream));  // it may be reordered
  } else {
    require(decoded.error().rule[0] == 'R' && decoded.error().bit_offset <= 8 * packet.size());
    require(held(receiver, substream) == before);
  }
  return decoded;
}

/// The highest 64 values are powers of 2: numbers far ahead, and two that are none.
constexpr std::uint64_t number_of(std::uint64_t value) { return value < 0xffc0 ? value : std::uint64_t{1} << (value & 63); }

/// Feeds the packets to a receiver; `check(packet)` looks at what an accepted one decoded to.
///   twin  made like `receiver`, sees accepted packets alone
template <class Check>
void push_packets(std::span<const std::uint8_t> data, Receiver& receiver, Receiver& twin, Check check) {
  for (std::size_t at = 0; at + 4 <= data.size();) {
    const std::size_t length = std::clamp<std::size_t>(data[at] | (data[at + 1] & 3u) << 8, 2, data.size() - at - 2);
    const std::uint64_t number = number_of(data[at + 2] | std::uint64_t{data[at + 3]} << 8);
    const auto bytes = data.subspan(at + 4, length - 2);
    const std::vector<std::uint8_t> packet(bytes.begin(), bytes.end());  // of its exact size, for the sanitizer
    at += 2 + length;
    const auto decoded = push_packet(receiver, number, packet);
    if (!decoded) continue;
    const auto same = twin.push(number, packet);
    require(same && same->final_code == decoded->final_code);
    require(held(twin, decoded->substream) == held(receiver, decoded->substream));
    check(*decoded);
  }
}

}  // namespace tactus
