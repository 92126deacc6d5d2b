// SPDX-License-Identifier: Apache-2.0
/// Datagrams of sessions, made field by field.
#pragma once

#include <cstdint>
#include <string>

#include <tactus/base/hash.h>
#include "conformance/make_vectors/build.h"

namespace tactus::conformance {

inline constexpr std::uint64_t kNonce = 0x1122334455667788, kEpoch = 0xfedcba9876543210;
inline constexpr std::size_t kPieceSize = 1024, kFragmentSize = 1150;

template <class Integer>
Bytes little(Integer value) {
  Bytes out;
  for (std::size_t i = 0; i < sizeof value; ++i) out.push_back(static_cast<std::uint8_t>(std::uint64_t{value} >> (8 * i)));
  return out;
}

inline Bytes with_check(const Bytes& body, std::uint64_t epoch, std::uint8_t direction = 1) {
  return body + little(crc32(little(epoch) + Bytes{direction} + body));
}
inline Bytes head(unsigned form, std::uint64_t value) { return little(static_cast<std::uint16_t>(form + 4 * (value % 16384))); }
inline Bytes part(std::uint8_t type, const Bytes& data) { return Bytes{type} + varint(data.size()) + data; }
inline Bytes acknowledgement(std::uint16_t newest, std::uint64_t missing, std::uint16_t held = 65535) {
  return part(1, little(newest) + little(held) + varint(missing));
}
inline Bytes clock() { return part(2, varint(123456789)); }
inline Bytes packet_part(const Bytes& packet, std::uint64_t back) { return part(8, varint(back) + packet); }
inline Bytes fragment(std::uint64_t back, std::uint64_t index, std::uint64_t count, const Bytes& data,
                      std::uint64_t substream = 0) {
  return part(7, varint(back) + varint(substream) + varint(index) + varint(count) + data);
}

inline std::uint64_t hash_of(const Bytes& bytes) {
  Fnv1a hash;
  for (const std::uint8_t byte : bytes) hash.add_byte(byte);
  return hash.value();
}
/// As it is; as a number of little-endian bytes.
inline std::string hex(const Bytes& bytes, bool number = false) {
  std::string out;
  for (const std::uint8_t byte : bytes) {
    const std::string pair{"0123456789abcdef"[byte >> 4], "0123456789abcdef"[byte & 15]};
    out.insert(number ? 0 : out.size(), pair);
  }
  return out;
}

}  // namespace tactus::conformance
