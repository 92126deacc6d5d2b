// SPDX-License-Identifier: Apache-2.0
#include "codec/trace/checksum.h"

#include <array>

namespace tactus {
namespace {

using Table = std::array<std::uint32_t, 256>;

// kTables[k][b]: what byte b contributes once k more zero bytes have passed, so that eight bytes cost eight independent look-ups.
constexpr std::array<Table, 8> make_tables() {
  std::array<Table, 8> tables{};
  for (std::uint32_t b = 0; b < 256; ++b) {
    std::uint32_t c = b;
    for (int bit = 0; bit < 8; ++bit) c = (c >> 1) ^ ((c & 1) != 0 ? 0xEDB88320u : 0u);
    tables[0][b] = c;
  }
  for (std::size_t k = 1; k < tables.size(); ++k)
    for (std::size_t b = 0; b < 256; ++b) tables[k][b] = (tables[k - 1][b] >> 8) ^ tables[0][tables[k - 1][b] & 0xFF];
  return tables;
}
constexpr auto kTables = make_tables();

} // namespace

void Crc32::update(std::span<const std::uint8_t> bytes) noexcept {
  std::uint32_t c = state_;
  while (bytes.size() >= 8) {
    std::uint32_t next = 0;
    for (std::size_t i = 0; i < 8; ++i) {
      const std::uint32_t carried = i < 4 ? (c >> (8 * i)) & 0xFF : 0;
      next ^= kTables[7 - i][bytes[i] ^ carried];
    }
    c = next;
    bytes = bytes.subspan(8);
  }
  for (const std::uint8_t b : bytes) c = (c >> 8) ^ kTables[0][(c ^ b) & 0xFF];
  state_ = c;
}

std::uint32_t crc32(std::span<const std::uint8_t> bytes) noexcept {
  Crc32 crc;
  crc.update(bytes);
  return crc.value();
}

} // namespace tactus
