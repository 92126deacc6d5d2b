// SPDX-License-Identifier: Apache-2.0
/// FNV-1a (64 bit) for states, CRC-32 (ISO-HDLC, the one of zlib) for files. spec/10-conventions.md section 7.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace tactus {

class Fnv1a {
 public:
  constexpr void add_byte(std::uint8_t byte) noexcept { hash_ = (hash_ ^ byte) * 0x100000001b3u; }
  /// Least significant byte first.
  constexpr void add32(std::uint32_t value) noexcept {
    for (int i = 0; i < 4; ++i) add_byte(static_cast<std::uint8_t>(value >> (8 * i)));
  }
  constexpr void add32(std::int32_t value) noexcept { add32(static_cast<std::uint32_t>(value)); }
  constexpr void add64(std::uint64_t value) noexcept {
    add32(static_cast<std::uint32_t>(value));
    add32(static_cast<std::uint32_t>(value >> 32));
  }
  constexpr std::uint64_t value() const noexcept { return hash_; }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325u;
};

namespace detail {
constexpr std::array<std::uint32_t, 256> make_crc_table() noexcept {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t i = 0; i < 256; ++i) {
    std::uint32_t c = i;
    for (int k = 0; k < 8; ++k) c = (c >> 1) ^ ((c & 1) ? 0xedb88320u : 0u);
    table[i] = c;
  }
  return table;
}
inline constexpr std::array<std::uint32_t, 256> kCrcTable = make_crc_table();
}  // namespace detail

/// CRC-32 of `data`; pass the previous result as `crc` to continue.
constexpr std::uint32_t crc32(std::span<const std::uint8_t> data, std::uint32_t crc = 0) noexcept {
  crc = ~crc;
  for (const std::uint8_t byte : data) crc = (crc >> 8) ^ detail::kCrcTable[(crc ^ byte) & 0xffu];
  return ~crc;
}

}  // namespace tactus
