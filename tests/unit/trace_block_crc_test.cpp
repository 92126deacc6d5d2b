// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/block_crc.h>

#include <gtest/gtest.h>

#include <vector>

#include <tactus/base/bytes.h>

namespace tactus {
namespace {

TEST(TraceBlockCrc, IsThatOfByteAfterByte) {
  std::vector<std::uint8_t> bytes(300);
  std::uint32_t state = 1;
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>((state = state * 1664525 + 1013904223) >> 24);
  const std::span<const std::uint8_t> all(bytes);
  for (const std::size_t start : {0U, 1U, 7U})
    for (std::size_t size = 0; size <= 80; ++size) {
      const auto part = all.subspan(start, size);
      EXPECT_EQ(block_crc(part), crc32(part)) << start << ' ' << size;
    }
  for (std::size_t cut = 0; cut <= all.size(); cut += 13)
    EXPECT_EQ(block_crc(all.subspan(cut), block_crc(all.first(cut))), crc32(all)) << cut;
}

}  // namespace
}  // namespace tactus
