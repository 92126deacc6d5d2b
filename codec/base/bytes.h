// SPDX-License-Identifier: Apache-2.0
/// Little-endian fields and varints in bytes, and the hashes over them. Internal to the libraries.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tactus {

// ==== bytes ====
// Byte-aligned reading and writing: little-endian integers and variable-length integers. spec/10-conventions.md section 4.

/// Signed integers as unsigned ones: 0, -1, 1, -2, ... are 0, 1, 2, 3, ...
constexpr std::uint64_t zigzag(std::int64_t v) noexcept {
  return static_cast<std::uint64_t>(v) << 1 ^ static_cast<std::uint64_t>(v >> 63);
}
constexpr std::int64_t unzigzag(std::uint64_t v) noexcept { return static_cast<std::int64_t>(v >> 1 ^ (~(v & 1) + 1)); }

/// Reads an untrusted span. After the first fault (end of the span or overlong varint) every read returns 0 and the reader stays
/// failed. A syntax function checks ok() once, at its end.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> bytes, std::size_t origin = 0) noexcept : bytes_(bytes), origin_(origin) {}

  bool ok() const noexcept { return !overrun_ && !overlong_; }
  bool overrun() const noexcept { return overrun_; }
  bool overlong() const noexcept { return overlong_; }  ///< a varint was not the shortest form or exceeds 64 bits
  std::size_t position() const noexcept { return position_; }
  std::size_t remaining() const noexcept { return bytes_.size() - position_; }
  /// Position in the whole input, for error messages.
  std::uint64_t bit_offset() const noexcept { return 8 * static_cast<std::uint64_t>(origin_ + position_); }

  std::uint8_t u8() noexcept { return static_cast<std::uint8_t>(little_endian(1)); }
  std::uint16_t u16() noexcept { return static_cast<std::uint16_t>(little_endian(2)); }
  std::uint32_t u32() noexcept { return static_cast<std::uint32_t>(little_endian(4)); }
  std::uint64_t u64() noexcept { return little_endian(8); }
  std::int32_t i32() noexcept { return static_cast<std::int32_t>(u32()); }

  /// Base-128, least significant group first, at most 10 bytes, shortest form only.
  std::uint64_t varint() noexcept {
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < 64; shift += 7) {
      const std::uint8_t byte = u8();
      if (!ok()) return 0;
      value |= static_cast<std::uint64_t>(byte & 0x7f) << shift;
      if (byte & 0x80) continue;
      overlong_ = (byte == 0 && shift > 0) || (shift == 63 && byte > 1);
      return overlong_ ? 0 : value;
    }
    overlong_ = true;
    return 0;
  }

  std::span<const std::uint8_t> bytes(std::uint64_t count) noexcept {
    if (!ok() || count > remaining()) {
      overrun_ = !overlong_;
      return {};
    }
    const auto out = bytes_.subspan(position_, static_cast<std::size_t>(count));
    position_ += static_cast<std::size_t>(count);
    return out;
  }

  /// A reader for the next `count` bytes only; this reader moves past them.
  ByteReader sub(std::uint64_t count) noexcept {
    const std::size_t start = origin_ + position_;
    return ByteReader(bytes(count), start);
  }

 private:
  std::uint64_t little_endian(std::size_t count) noexcept {
    if (!ok() || count > remaining()) {
      overrun_ = !overlong_;
      return 0;
    }
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < count; ++i) value |= static_cast<std::uint64_t>(bytes_[position_ + i]) << (8 * i);
    position_ += count;
    return value;
  }

  std::span<const std::uint8_t> bytes_;
  std::size_t origin_ = 0;
  std::size_t position_ = 0;
  bool overrun_ = false;
  bool overlong_ = false;
};

/// Appends to a vector. Used at set-up and for files, never on the hot path.
class ByteWriter {
 public:
  explicit ByteWriter(std::vector<std::uint8_t>& out) noexcept : out_(out) {}

  void u8(std::uint8_t value) { out_.push_back(value); }
  void u16(std::uint16_t value) { little_endian(value, 2); }
  void u32(std::uint32_t value) { little_endian(value, 4); }
  void u64(std::uint64_t value) { little_endian(value, 8); }
  void i32(std::int32_t value) { u32(static_cast<std::uint32_t>(value)); }
  void varint(std::uint64_t value) {
    for (; value >= 0x80; value >>= 7) u8(static_cast<std::uint8_t>(value | 0x80));
    u8(static_cast<std::uint8_t>(value));
  }
  void bytes(std::span<const std::uint8_t> data) { out_.insert(out_.end(), data.begin(), data.end()); }

 private:
  void little_endian(std::uint64_t value, unsigned count) {
    for (unsigned i = 0; i < count; ++i) u8(static_cast<std::uint8_t>(value >> (8 * i)));
  }

  std::vector<std::uint8_t>& out_;
};

// ==== hash ====
// FNV-1a (64 bit) for states, CRC-32 (ISO-HDLC, the one of zlib) for files. spec/10-conventions.md section 7.

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
