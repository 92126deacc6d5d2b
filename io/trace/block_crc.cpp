// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/block_crc.h>

#include <array>
#include <cstddef>

#include <tactus/base/bytes.h>

namespace tactus {
namespace {

constexpr std::size_t kSlices = 16;
using Table = std::array<std::uint32_t, 256>;

/// [k][b]: what byte b adds to the value when k bytes follow it.
constexpr std::array<Table, kSlices> make_tables() noexcept {
  std::array<Table, kSlices> tables{detail::kCrcTable};
  for (std::size_t k = 1; k < kSlices; ++k)
    for (std::size_t b = 0; b < 256; ++b) tables[k][b] = (tables[k - 1][b] >> 8) ^ tables[0][tables[k - 1][b] & 0xff];
  return tables;
}
constexpr std::array<Table, kSlices> kTables = make_tables();

}  // namespace

std::uint32_t block_crc(std::span<const std::uint8_t> data, std::uint32_t crc) noexcept {
  const std::size_t whole = data.size() - data.size() % kSlices;
  std::uint32_t value = ~crc;
  const std::uint8_t* at = data.data();
  for (const std::uint8_t* end = at + whole; at != end; at += kSlices) {
    std::uint32_t next = 0;
    for (std::size_t i = 0; i < 4; ++i) next ^= kTables[kSlices - 1 - i][at[i] ^ ((value >> (8 * i)) & 0xff)];
    for (std::size_t i = 4; i < kSlices; ++i) next ^= kTables[kSlices - 1 - i][at[i]];
    value = next;
  }
  return crc32(data.subspan(whole), ~value);
}

}  // namespace tactus
