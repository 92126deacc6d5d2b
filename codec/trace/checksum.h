// SPDX-License-Identifier: Apache-2.0
/// CRC-32/ISO-HDLC: reflected polynomial 0xEDB88320, start and final xor 0xFFFFFFFF; "123456789" gives 0xCBF43926.
#pragma once

#include <cstdint>
#include <span>

namespace tactus {

class Crc32 {
 public:
  void update(std::span<const std::uint8_t> bytes) noexcept;
  std::uint32_t value() const noexcept { return ~state_; }

 private:
  std::uint32_t state_ = 0xFFFFFFFFu;
};

std::uint32_t crc32(std::span<const std::uint8_t> bytes) noexcept;

} // namespace tactus
